# Debian packages, by CPack: `tools/release --debs FOLDER` makes them. The install() rules say what is in them; what only Debian
# wants is added by complete_debian_packages.cmake.
#   proleg      component runtime: the programs, and all that they need
#   proleg-dev  component dev: what users' algorithms, plug-ins and images for modules are built from
#   proleg-mpi  component mpi: the optimiser on a cluster, apart for its libraries. If MPI was found.
#   python3-proleg  component python: the package for Python. If it is built.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR Proleg)
set(CPACK_PACKAGE_CONTACT "The Proleg authors <maintainers@proleg.example>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_COMPONENTS_ALL runtime)
if(NOT CMAKE_CROSSCOMPILING)
  list(APPEND CPACK_COMPONENTS_ALL dev)  # one for all kinds of computers
endif()
if(TARGET proleg-optimise-mpi)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(TARGET proleg_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
  # dpkg-shlibdeps takes the folder of the libraries for a package that is being built, because it has a folder DEBIAN (tools/arm64).
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${PROLEG_DEBIAN_ARCHITECTURE})
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_SYSROOT}/lib/${CMAKE_LIBRARY_ARCHITECTURE} ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()
set(CPACK_STRIP_FILES ON)
# Of any umask.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME proleg)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS xdg-utils)  # `proleg ui` opens the browser by it
# What `proleg flash --bare` starts; a debugger for virtual chips; a reader of recordings.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "can-utils, dfu-util, gdb-multiarch, openocd, proleg-mpi (= ${PROJECT_VERSION}), sqlite3, stm32flash")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "simulator and tools for modular robots that crawl
Proleg is for robots that crawl like caterpillars and snakes and consist of
identical joint modules. One fixed-point core computes the joint angles; the
simulation and the processor of a module run it and give the same bits.

The package has the command proleg: a page in the browser on which a robot
crawls and every parameter can be changed, simulation, search for gaits, and
what finds, flashes and drives the modules of a robot on a CAN bus. It brings
robots and worlds to begin with, and the images that are flashed into modules.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME proleg-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "proleg (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_MPI_DESCRIPTION "search for gaits of modular robots on a cluster
Proleg is for robots that crawl like caterpillars and snakes and consist of
identical joint modules.

The package has the program by which 'proleg optimise' computes on many
computers at once, through MPI.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME proleg-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION devel)
set(CPACK_DEBIAN_DEV_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "proleg (= ${PROJECT_VERSION}), cmake (>= 3.25), g++, ninja-build, python3")
# The compiler for modules.
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "ccache, clang")
set(CPACK_COMPONENT_DEV_DESCRIPTION "algorithms and plug-ins for modular robots that crawl
Proleg is for robots that crawl like caterpillars and snakes and consist of
identical joint modules.

The package has the sources of the core and of the program of a module, with
a CMake package. Algorithms of users are built from them, for this computer
and for modules, and the command 'proleg verify' proves that both compute the
same bits. It also has the header of plug-ins for robots without modules.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-proleg)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
# It is made for one version of Python.
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "proleg (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-scipy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/tools/release.d/python3-proleg/postinst
  ${CMAKE_SOURCE_DIR}/tools/release.d/python3-proleg/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "simulation of modular robots that crawl, for Python
Proleg is for robots that crawl like caterpillars and snakes and consist of
identical joint modules.

The package has the simulator as a module of Python: it rates many gaits at
once, gives arrays of numpy, and has the results of the programs to the last
bit. Examples use the optimisers of SciPy, Optuna and DEAP.")

set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/tools/cmake/complete_debian_packages.cmake)
set(CPACK_PROLEG_COPYRIGHT ${CMAKE_BINARY_DIR}/packages/copyright)
set(CPACK_PROLEG_OVERRIDES ${CMAKE_SOURCE_DIR}/tools/release.d)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
# tools/release builds what is installed; without this CPack would build everything.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
include(CPack)
