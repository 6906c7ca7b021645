#!/usr/bin/env python3
"""Writes the bill of materials of a release (SPDX 2.3, JSON): what is in the packages and images, and what they load.

usage: sbom.py SOURCE_FOLDER VERSION COMMIT DEB... >FILE

Versions of Debian packages are those that the build has used: those that are installed here, and for another architecture those of
build/ARCHITECTURE_sysroot (tools/arm64). The time is SOURCE_DATE_EPOCH, and the order is fixed, so that one commit and the same
packages give the same bytes.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path

# Debian packages whose code is in the programs or images: headers, and the libraries of the compiler for modules.
IN_PROGRAMS = ["libboost-dev", "libcli11-dev", "libeigen3-dev", "nlohmann-json3-dev"]
IN_IMAGES = ["gcc-arm-none-eabi", "libnewlib-arm-none-eabi", "libstdc++-arm-none-eabi-newlib"]
IN_PYTHON = ["pybind11-dev"]
# What loads the modules of Python. The build for another architecture does not use them: their versions are those of this computer.
OF_PYTHON = ["python3", "python3-numpy"]
IN_DOCUMENTS = ["mkdocs-material"]
NONE = "NOASSERTION"


class Failure(Exception):
    pass


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def architecture_here():
    return output_of("dpkg", "--print-architecture").strip()


class Debian:
    """The Debian packages of one architecture."""

    def __init__(self, source, architecture):
        if architecture == architecture_here():
            self.place = "installed here"
            text = output_of("dpkg-query", "--show", "--showformat=${db:Status-Status} ${Package} ${Version} ${Architecture}\n")
            lines = [line.removeprefix("installed ") for line in text.splitlines() if line.startswith("installed ")]
        else:
            file = source / f"build/{architecture}_sysroot/DEBIAN/versions"
            self.place = f"in {file}"
            lines = file.read_text().splitlines()
        found = (line.split() for line in lines)
        self.versions = {name: (version, kind) for name, version, kind in found if kind in (architecture, "all")}

    def package(self, name):
        if name not in self.versions:
            raise Failure(f"found no package {name} {self.place}, expected it: the release contains or loads it")
        version, kind = self.versions[name]
        return package(f"{name}-{kind}", name, version, f"pkg:deb/debian/{name}@{version}?arch={kind}&distro=bookworm")


def dependencies(deb):
    """Names of the packages that a package needs, of alternatives the first; without those of this release."""
    field = output_of("dpkg-deb", "--field", deb, "Depends")
    names = [re.split(r"[ (|:]", word.strip())[0] for word in field.split(",") if word.strip()]
    return sorted(name for name in names if not name.startswith("proleg"))


def by_architecture(debs):
    found = {}
    for deb in debs:
        found.setdefault(output_of("dpkg-deb", "--field", deb, "Architecture").strip(), []).append(deb)
    return found


def spdx_id(*words):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", "-".join(words)).strip("-")


def package(key, name, version, reference, licence=NONE):
    return {"SPDXID": spdx_id(reference.split("/")[0].removeprefix("pkg:"), key), "name": name, "versionInfo": version,
            "downloadLocation": NONE, "filesAnalyzed": False, "licenseConcluded": NONE, "licenseDeclared": licence, "copyrightText": NONE,
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": reference}]}


def npm_packages(lock):
    """What the page contains: the packages of the lock file that are not for development."""
    for path, entry in sorted(json.loads(lock.read_text())["packages"].items()):
        if path and not entry.get("dev"):
            name = path.rsplit("node_modules/", 1)[-1]
            reference = f"pkg:npm/{name.replace('@', '%40')}@{entry['version']}"
            yield package(name, name, entry["version"], reference, entry.get("license", NONE))


def bill(source, version, commit, debs):
    root = {"SPDXID": "SPDXRef-proleg", "name": "proleg", "versionInfo": version, "downloadLocation": NONE, "filesAnalyzed": False,
            "sourceInfo": f"commit {commit}", "licenseConcluded": "BSD-3-Clause", "licenseDeclared": "BSD-3-Clause", "copyrightText": NONE}
    packages, relations = {root["SPDXID"]: root}, [("SPDXRef-DOCUMENT", "DESCRIBES", root["SPDXID"])]

    def add(found, relation):
        if found["SPDXID"] not in packages:  # one for all architectures
            packages[found["SPDXID"]] = found
            relations.append((root["SPDXID"], relation, found["SPDXID"]))

    here = Debian(source, architecture_here())
    for architecture, own in sorted(by_architecture(debs).items()):
        if architecture == "all":
            continue  # no programs
        debian = Debian(source, architecture)
        for name in sorted(set().union(*map(dependencies, own))):
            add((here if name in OF_PYTHON else debian).package(name), "DYNAMIC_LINK")
        for name in IN_PROGRAMS + (IN_IMAGES + IN_PYTHON if architecture == architecture_here() else []):
            add(debian.package(name), "STATIC_LINK")
    for name in IN_DOCUMENTS:
        add(here.package(name), "CONTAINS")
    for found in npm_packages(source / "host/page/package-lock.json"):
        add(found, "CONTAINS")
    created = datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    content = hashlib.sha256(json.dumps(packages, sort_keys=True).encode()).hexdigest()
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"proleg-{version}",
            "documentNamespace": f"https://spdx.org/spdxdocs/proleg-{version}-{content[:32]}",
            "creationInfo": {"created": created, "creators": ["Tool: tools/release"]}, "packages": list(packages.values()),
            "relationships": [{"spdxElementId": one, "relationshipType": relation, "relatedSpdxElement": other}
                              for one, relation, other in relations]}


def main():
    if len(sys.argv) < 5:
        print(__doc__, file=sys.stderr)
        return 2
    source, version, commit, *debs = sys.argv[1:]
    try:
        json.dump(bill(Path(source), version, commit, debs), sys.stdout, indent=1)
        print()
    except (Failure, OSError, subprocess.CalledProcessError) as error:
        print(f"sbom.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
