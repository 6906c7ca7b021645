# Names of the Debian packages, and functions that install the missing ones. tools/demo, tools/check, tools/page,
# tools/docs, tools/release, tools/arm64 and CMake (tools/cmake/configuration.cmake) read it.

# The libraries of the programs.
library_packages=(
  libode-dev libeigen3-dev libtinyxml2-dev libsqlite3-dev libsodium-dev zlib1g-dev libcli11-dev nlohmann-json3-dev
  libunicorn-dev libdw-dev
  libpagmo-dev libga-dev  # the optimiser
  libassimp-dev libqhull-dev  # meshes of links and worlds
  libboost-dev  # Boost.Asio: serial lines, sockets
  libevdev-dev  # gamepads
  libssl-dev    # TLS of the page; SHA-256
)
# The package for Python (tools/python).
python_packages=(pybind11-dev python3-dev python3-numpy)
# What its examples use, and pip, in their slow tests.
python_example_packages=(python3-scipy python3-optuna python3-deap python3-pandas python3-pip python3-venv python3-setuptools python3-wheel)
# What CMake needs for the programs for this computer.
build_packages=(g++ cmake ninja-build pkg-config "${library_packages[@]}")
# The programs, and what goes with them: quick builds, version and npm's downloads; sqlite3 shows the contents of recordings.
host_packages=("${build_packages[@]}" ccache git ca-certificates sqlite3)

# The image that is flashed into modules.
firmware_packages=(gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib binutils-arm-none-eabi python3 dwz)

# The programs for arm64: the compiler, and what runs the programs here.
aarch64_packages=(g++-aarch64-linux-gnu qemu-user)
# And what makes the folder of its libraries.
arm64_packages=("${aarch64_packages[@]}" mmdebstrap)
# These libraries, for arm64, are in that folder and not installed: some -dev packages exclude those of another processor.
arm64_libraries=("${library_packages[@]}" libmujoco-dev libopenmpi-dev libboost-mpi-dev pybind11-dev libpython3-dev)

# Additional packages for the tests: a second compiler with its sanitizers, independent programs.
test_packages=(
  "${python_packages[@]}"
  clang libclang-rt-14-dev clang-format clang-tidy libgtest-dev
  lld               # links the programs of the sanitizers
  llvm              # names of functions in reports of the sanitizers, which their suppressions need
  can-utils tshark  # independent readers of bus logs
  python3-can python3-serial  # an independent program that uses slcan adapters
  gdb-multiarch     # a debugger for the virtual module
  openocd dfu-util stm32flash libusb-1.0-0-dev  # flash an empty chip: the tests run them on one that is a program
  openssl           # certificates
  strace            # shows what a test reads
  qemu-system-arm   # another model of the CPU, to compare with
  "${aarch64_packages[@]}"  # another processor, which must compute the same
  libmujoco-dev     # the engine MuJoCo
  liburdfdom-tools  # check_urdf, which reads an exported robot
  libbenchmark-dev  # benchmarks
  libopenmpi-dev libboost-mpi-dev openmpi-bin          # the optimiser on a cluster
)

# The virtual machine of tools/lab. Its kernel is a package too, but not installed (tools/lab.d/kernel.py).
lab_packages=(
  qemu-system-x86 busybox-static  # the machine, and its first programs
  kmod xz-utils zstd              # unpack and load the kernel and its modules
  iproute2 can-utils              # CAN interfaces; programs that use them
  bluez bluez-test-tools          # Bluetooth; btvirt, which makes virtual controllers
  udev                            # reads the shipped rules in a check
  python3
)

# The slow test of the board's schematic: KiCad 6 with its libraries, and a screen for its windows.
kicad_packages=(kicad kicad-symbols kicad-footprints xvfb xdotool)

# The web page: tools/page. Only where there is no other node and npm.
page_packages=(nodejs npm)
browser_packages=(chromium)  # its tests
film_packages=(webp)         # tools/film, which needs the browser, too

# Debian packages of Proleg: tools/release. What is optional in a build is in them. Their slow tests make an empty Debian, and run the
# programs for arm64 in a folder with what they depend on.
release_packages=(dpkg-dev file lintian libmujoco-dev libopenmpi-dev libboost-mpi-dev "${python_packages[@]}")
release_test_packages=(debootstrap mmdebstrap proot)

# The documentation as a site: tools/docs.
docs_packages=(mkdocs mkdocs-material doxygen python3)
# What reads the manual pages and completions of tools/docs --shell, in its slow test.
shell_packages=(zsh fish man-db mandoc)

# missing_packages NAME...: prints those that are not installed, each on a line.
missing_packages() {
  local name
  for name in "$@"; do
    dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || echo "$name"
  done
}

# show_progress SED_PROGRAM: reads what a long command prints, and shows on a terminal, in one line that changes, what
# sed makes of it.
show_progress() {
  if [ ! -t 1 ]; then
    cat >/dev/null
    return
  fi
  local line
  sed -un "$1" | while IFS= read -r line; do
    printf '\r\033[K%.79s' "$line"
  done
  printf '\r\033[K'
}

# install_packages NAME...: installs the packages that are missing, and prints their names. A user who is not root needs sudo;
# without it the function prints the command for root and fails.
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  if [ ${#missing[@]} -eq 0 ]; then
    return 0
  fi
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}" | fold -s -w 80
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
    if ! command -v sudo >/dev/null || ! sudo -v; then
      printf 'Cannot become root with sudo. As root, run this command, then this script again:\n\n' >&2
      printf '    apt-get update && apt-get install -y --no-install-recommends %s\n\n' "${missing[*]}" >&2
      return 1
    fi
  fi
  "${as_root[@]}" apt-get update -qq
  # "dlstatus:N:PERCENT:TEXT" while packages come, then "pmstatus:NAME:PERCENT:TEXT". (sudo closes other descriptors.)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o APT::Status-Fd=1 \
    "${missing[@]}" 2> >(grep -v '^debconf: delaying' >&2) |
    show_progress 's/^dlstatus:[^:]*:\([0-9]*\).*/  downloading: \1 %/p; s/^pmstatus:[^:]*:\([0-9]*\).*/  installing: \1 %/p'
}
