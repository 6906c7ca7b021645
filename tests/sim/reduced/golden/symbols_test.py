"""symbols_test.py NM FILE...: nothing that kernel_avx2 and kernel_avx512 define can reach code for other processors.

FILE: an object file, or a library with them. Each kernel may define one symbol for the linker, its ChainKernel. If it
defined a function that the linker merges with others of its name, all code could get the one with instructions that a
processor does not have.
"""

import re
import subprocess
import sys


def symbols(nm, file):
    """Those that the linker sees, by the object file that defines them."""
    member = file
    found = {}
    listing = subprocess.run([nm, "--extern-only", "--defined-only", "--demangle", file], capture_output=True, text=True, check=False)
    if listing.returncode != 0:
        sys.exit(listing.stderr)
    for line in listing.stdout.splitlines():
        if line.endswith(".o:"):
            member = line[:-1]
        elif line:
            found.setdefault(member, []).append(line.split(maxsplit=2)[2])
    return found


def main():
    nm, *files = sys.argv[1:]
    errors = 0
    for file in files:
        kernels = {member: names for member, names in symbols(nm, file).items() if re.search(r"kernel_avx\w+(\.cpp)?\.o$", member)}
        if not kernels or (file.endswith(".a") and len(kernels) != 2):
            print(f"{file}: found {sorted(kernels)}, expected kernel_avx2 and kernel_avx512")
            errors += 1
        for member, names in kernels.items():
            kernel = re.search(r"kernel_(avx\w+?)(\.cpp)?\.o$", member).group(1)
            expected = [f"proleg::sim::reduced::{kernel}_kernel"]
            if names != expected:
                print(f"{file}: {member}: found {names}, expected {expected}: see chain_step.hpp")
                errors += 1
    return 1 if errors or not files else 0


if __name__ == "__main__":
    sys.exit(main())
