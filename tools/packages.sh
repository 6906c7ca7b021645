# Names of the Debian packages, and a function that installs the missing ones. tools/demo, tools/check and tools/page read it.

# Programs for this computer.
host_packages=(
  g++ cmake ninja-build pkg-config ccache git ca-certificates
  libode-dev libeigen3-dev libtinyxml2-dev libsqlite3-dev libsodium-dev zlib1g-dev libcli11-dev nlohmann-json3-dev
  libunicorn-dev libdw-dev
  libpagmo-dev libga-dev  # the optimiser
  libassimp-dev libqhull-dev  # meshes of links and worlds
  libboost-dev  # Boost.Asio: serial lines, sockets
  libevdev-dev  # gamepads
  libssl-dev    # TLS of the page; SHA-256
  sqlite3  # not for the build: shows the contents of recordings
)

# The image that is flashed into modules.
firmware_packages=(gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib binutils-arm-none-eabi python3)

# Additional packages for the tests: a second compiler with its sanitizers, independent programs.
test_packages=(
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
  g++-aarch64-linux-gnu qemu-user  # another processor, which must compute the same
  libmujoco-dev     # the engine MuJoCo
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

# The web page: tools/page. Only where there is no other node and npm.
page_packages=(nodejs npm)
browser_packages=(chromium)  # its tests

# install_packages NAME...: installs the packages that are missing, and prints their names.
install_packages() {
  local missing=() name
  for name in "$@"; do
    if ! dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q 'ok installed'; then
      missing+=("$name")
    fi
  done
  if [ ${#missing[@]} -eq 0 ]; then
    return 0
  fi
  echo "Installing Debian packages: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}
