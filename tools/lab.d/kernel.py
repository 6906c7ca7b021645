"""The kernel that the lab boots: a Debian package that apt offers, unpacked into a cache folder and never installed.

    CACHE/linux-image-6.12.117+deb12-amd64_6.12.117-1~deb12u1_.../   kernel (its name and version), vmlinux, lib/modules
    CACHE/current                                                    link to the folder in use
    CACHE/lock                                                       held while a kernel is unpacked

CACHE is $PROLEG_LAB_CACHE, or proleg/lab below $XDG_CACHE_HOME or ~/.cache. All checkouts share it. It may be deleted.
"""

import fcntl
import hashlib
import lzma
import os
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import time
from pathlib import Path

# Wanted series, the best first.
SERIES = (r"linux-image-6\.12\.([0-9]+)\+deb12-amd64", r"linux-image-6\.1\.0-([0-9]+)-amd64")
KNOWN_BAD = {
    "linux-image-6.1.0-47-amd64": "a Bluetooth Wiimote makes it hang",
    "linux-image-6.1.0-53-amd64": "a Bluetooth Wiimote makes it hang",
    "linux-image-6.1.0-54-amd64": "a Bluetooth Wiimote makes it hang",
    "linux-image-6.1.0-55-amd64": "it panics when RFCOMM connects to an absent address",
    "linux-image-6.1.0-56-amd64": "it panics when RFCOMM connects to an absent address",
}
EXPECTED = ("found no package linux-image-6.12.*+deb12-amd64, expected one; "
            "add `deb http://deb.debian.org/debian-security bookworm-security main` to the apt sources")

# Folders of modules that tests of this project can need. They are unpacked uncompressed, which saves time at each boot.
MODULES = ("net/", "crypto/", "lib/", "arch/x86/crypto/", "fs/9p/", "fs/configfs/", "fs/fscache/", "fs/fuse/", "fs/netfs/", "fs/overlayfs/",
           "drivers/bluetooth/", "drivers/hid/", "drivers/input/", "drivers/net/can/", "drivers/tty/", "drivers/usb/",
           "drivers/virtio/", "drivers/block/virtio", "drivers/char/virtio")
CONTENT = hashlib.sha256(repr(MODULES).encode()).hexdigest()[:8]  # two lists make two folders
LOCK_TIMEOUT_S = 600


class Failure(Exception):
    """What the lab could not do, as one line for the user."""


class Kernel:
    """An unpacked kernel."""

    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        self.name = (self.folder / "kernel").read_text().strip()
        self.release = self.name.split()[0].removeprefix("linux-image-")
        self.vmlinux = self.folder / "vmlinux"

    def modules(self, names):
        """Files of the modules `names` and of all that they need, in the order in which they must be loaded."""
        files = []
        for name in names:
            listing = run([sbin("modprobe"), "-d", self.folder, "-S", self.release, "--show-depends", name])
            # Lines are "insmod FILE" or "builtin NAME".
            files += [line.split()[1] for line in listing.splitlines() if line.startswith("insmod ")]
        return list(dict.fromkeys(files))


def sbin(program):
    """Path of a program of the administrator; the PATH of ordinary users does not have its folder."""
    return shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin") or program


def run(command, **options):
    """Standard output of a command; Failure if it fails."""
    try:
        finished = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                  check=False, env={**os.environ, "LC_ALL": "C"}, **options)
    except OSError as error:
        raise Failure(f"{command[0]} could not be started: {error.strerror}; tools/check installs the packages of the lab") from None
    if finished.returncode != 0:
        reason = (finished.stderr.strip().splitlines() or [f"status {finished.returncode}"])[-1]
        raise Failure(f"`{' '.join(str(word) for word in command)}` failed: {reason}")
    return finished.stdout


def cache_folder():
    if os.environ.get("PROLEG_LAB_CACHE"):
        return Path(os.environ["PROLEG_LAB_CACHE"])
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "proleg" / "lab"


class Apt:
    """apt with the machine's sources. It needs no root, since it downloads only. With `lists`, a folder, it fetches
    lists of packages of its own, for machines whose lists are missing or older than what the archive holds."""

    def __init__(self, lists=None):
        self.options = ["-o", "APT::Sandbox::User=root"]  # the user _apt cannot write to the cache
        if lists:
            for folder in ("state/lists/partial", "cache/archives/partial"):
                (lists / folder).mkdir(parents=True, exist_ok=True)
            for name, folder in (("State", "state"), ("State::Lists", "state/lists"), ("Cache", "cache")):
                self.options += ["-o", f"Dir::{name}={lists / folder}"]
            # The status of update covers all sources; one that fails is of no interest if the kernel is in another.
            subprocess.run(["apt-get", *self.options, "update", "-qq"], stdin=subprocess.DEVNULL, capture_output=True,
                           check=False)

    def offered(self, series):
        """Names of the packages of a series, the newest first."""
        listing = run(["apt-cache", *self.options, "search", "--names-only", f"^{series}$"])
        names = [line.split()[0] for line in listing.splitlines()]
        return sorted(names, key=lambda name: int(re.fullmatch(series, name)[1]), reverse=True)

    def file_name(self, name):
        """Name of the package's file, which has its version: linux-image-NAME_VERSION_amd64.deb."""
        return run(["apt-get", *self.options, "download", "--print-uris", name]).split()[1]

    def download(self, name, folder):
        run(["apt-get", *self.options, "download", "-qq", name], cwd=folder)
        return next(Path(folder).glob("*.deb"))


def choose(apt):
    """The best package that is offered, and why it is not the wanted one ("" if it is); None if none is offered."""
    newest = apt.offered(SERIES[0])
    if newest:
        return newest[0], ""
    others = apt.offered(SERIES[1])
    good = [name for name in others if name not in KNOWN_BAD]
    missing = f"{EXPECTED} and run apt-get update"
    if good:
        return good[0], missing
    return (others[0], f"{missing}; known of the kernel in use: {KNOWN_BAD[others[0]]}") if others else None


def unpack(package, release, folder):
    """Puts vmlinux and the wanted modules of a package's file into a folder."""
    modules = f"lib/modules/{release}/"
    with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE) as archive:
        with tarfile.open(fileobj=archive.stdout, mode="r|") as members:
            for member in members:
                name = member.name.removeprefix("./").removeprefix("usr/")
                # Directly in the folder of the modules: lists that depmod reads.
                wanted = (name.startswith(tuple(modules + "kernel/" + path for path in MODULES))
                          or str(Path(name).parent) + "/" == modules or name == f"boot/vmlinuz-{release}")
                if not member.isfile() or not wanted:
                    continue
                content = members.extractfile(member).read()
                if name.endswith(".ko.xz"):
                    name, content = name.removesuffix(".xz"), lzma.decompress(content)
                elif name.startswith("boot/"):
                    name, content = "vmlinux", vmlinux_of(content)
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes(content)
    if archive.returncode != 0 or not (folder / "vmlinux").exists():
        raise Failure(f"{Path(package).name}: found no kernel in the package, expected boot/vmlinuz-{release}")
    run([sbin("depmod"), "-b", folder, release])


def vmlinux_of(image):
    """The ELF file inside a bzImage: booting it saves the time in which the guest would decompress it. Layout: the
    Linux/x86 boot protocol, Documentation/arch/x86/boot.rst. The payload's last four bytes are the size of the ELF file."""
    sectors = image[0x1F1] or 4
    offset, length = struct.unpack_from("<II", image, 0x248)
    start = (sectors + 1) * 512 + offset
    payload, size = image[start:start + length - 4], struct.unpack_from("<I", image, start + length - 4)[0]
    programs = {b"\x28\xb5\x2f\xfd": "zstd", b"\xfd7zXZ\x00": "xz"}
    program = next((program for magic, program in programs.items() if payload.startswith(magic)), None)
    if program is None:
        raise Failure(f"vmlinuz: found a payload that begins with {payload[:6].hex(' ')}, expected zstd or xz")
    content = subprocess.run([program, "-dc"], input=payload, capture_output=True, check=False).stdout
    if len(content) != size or not content.startswith(b"\x7fELF"):
        raise Failure(f"vmlinuz: found a kernel of {len(content)} bytes, expected an ELF file of {size}")
    return content


def fetch(apt, name, cache):
    """The folder of a kernel in the cache, downloaded if it is not there."""
    version = apt.file_name(name).split("_")[1].replace("%3a", ":")
    folder = cache / f"{name}_{version}_{CONTENT}"
    if not (folder / "kernel").exists():
        print(f"lab: downloading {name} {version} to {cache}", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory(dir=cache, prefix="new-") as new:
            new = Path(new)
            package = apt.download(name, new)
            unpack(package, name.removeprefix("linux-image-"), new / "kernel")
            (new / "kernel" / "kernel").write_text(f"{name} {version}\n")
            (new / "kernel").replace(folder)
    return folder


def renew(cache):
    """Makes the best kernel that is offered the current one, and removes all others but the last."""
    current = cache / "current"
    try:
        apt = Apt()
        try:
            choice = choose(apt)
            folder = fetch(apt, choice[0], cache) if choice else None
        except Failure:
            folder = None
        if folder is None:
            with tempfile.TemporaryDirectory(dir=cache, prefix="lists-") as lists:
                apt = Apt(Path(lists))
                choice = choose(apt)
                if choice is None:
                    raise Failure(f"{EXPECTED}, or connect this computer to the network")
                folder = fetch(apt, choice[0], cache)
    except Failure as failure:
        if not (current / "kernel").exists():
            raise
        print(f"lab: {failure}; the kernel of before is used", file=sys.stderr)
        return
    if choice[1]:
        print(f"lab: {choice[1]}; {choice[0]} is used", file=sys.stderr)
    os.utime(folder)
    link = cache / f"current.{os.getpid()}"
    link.symlink_to(folder.name)
    link.replace(current)
    kernels = [path.parent for path in cache.glob("linux-image-*/kernel")]
    kernels.sort(key=lambda path: path.stat().st_mtime)
    for old in kernels[:-2]:
        shutil.rmtree(old, ignore_errors=True)


def locked(cache):
    """The lock of the cache, as an open file. It ends with the file, or with the process."""
    try:
        cache.mkdir(parents=True, exist_ok=True)
        lock = open(cache / "lock", "w", encoding="utf-8")
    except OSError as error:
        raise Failure(f"{cache}: {error.strerror}; set PROLEG_LAB_CACHE to a folder that can be written") from None
    deadline = time.monotonic() + LOCK_TIMEOUT_S
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return lock
        except BlockingIOError:
            if time.monotonic() > deadline:
                lock.close()
                raise Failure(f"{cache}/lock: another process holds it for more than {LOCK_TIMEOUT_S} s") from None
            time.sleep(0.2)


def current_kernel(newest=False):
    """The kernel of the cache; the newest that apt offers if there is none, or if `newest`."""
    if os.uname().machine != "x86_64":
        raise Failure(f"found a computer of the kind {os.uname().machine}, expected x86_64: the guest runs its programs")
    cache = cache_folder()
    current = cache / "current"

    def is_missing():
        return not (current / "kernel").exists() or not current.resolve().name.endswith(CONTENT)

    if newest or is_missing():
        with locked(cache):
            if newest or is_missing():
                renew(cache)
    return Kernel(current)
