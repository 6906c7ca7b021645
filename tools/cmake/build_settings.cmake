# Compiler settings that hold for the whole tree. Warnings are errors everywhere.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # ccache requires this sloppiness to store objects that were compiled with a precompiled header. It takes the list of
  # included files from the compiler instead of running the preprocessor first.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1
    CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE_PROGRAM})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_compile_options(
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wundef
  $<$<COMPILE_LANGUAGE:CXX>:-Wredundant-decls>
  $<$<COMPILE_LANGUAGE:CXX>:-Wzero-as-null-pointer-constant>
  # A multiplication and an addition are never one operation: results are the same on processors that have it.
  -ffp-contract=off
  # Binaries contain no paths of the build computer.
  -ffile-prefix-map=${CMAKE_SOURCE_DIR}/=)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  # Eigen asks for this macro before it calls that operation by its name. Char has the sign that it has on x86-64.
  add_compile_options(-U__ARM_FEATURE_FMA -fsigned-char)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Notes about objects of older compilers, of which there are none; and warnings of memcpy in a std::string, which is right.
    add_compile_options(-Wno-psabi -Wno-array-bounds -Wno-stringop-overflow -Wno-restrict)
  endif()
endif()

# The linker leaves out what a program does not use of the sources of a room: a program contains less of the code that is in
# all of them.
if(NOT PROLEG_TARGET AND NOT PROLEG_SANITIZE)
  add_compile_options(-ffunction-sections -fdata-sections)
  add_link_options(LINKER:--gc-sections)
endif()

if(NOT PROLEG_TARGET)
  # A room may become a part of a library that a program loads (tools/python), whose functions no other library replaces.
  add_compile_options(-fPIC -fno-semantic-interposition)
endif()

# tools/check makes unity builds: CMake compiles each target as one source, so templates that several of its sources use are
# compiled once. The build after a change of one file takes longer.
if(CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 0)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes sources that are included for headers, whose anonymous namespaces would be in several sources.
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
endif()

# The core and the firmware are built without exceptions and run-time type information.
set(PROLEG_CORE_OPTIONS -fno-exceptions -fno-rtti)

option(PROLEG_SANITIZE "Build with AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
if(PROLEG_SANITIZE)
  # The check of virtual calls (vptr) needs run-time type information, which the core does not have.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all
                      -fno-omit-frame-pointer)
  # lld links the programs of the sanitizers about six times as fast as the GNU linker, which most of them wait for.
  add_link_options(-fsanitize=address,undefined -fuse-ld=lld)
endif()

# proleg_computer_code()
#   The sources of this folder and of those below it run on computers only. Under the sanitizers they are not checked for
#   what a Cortex-M0 does not forgive (alignment), and for bad pointers by AddressSanitizer alone: these checks of
#   UndefinedBehaviorSanitizer take up to half of the compile time.
macro(proleg_computer_code)
  if(PROLEG_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    add_compile_options(-fno-sanitize=alignment,null,object-size,pointer-overflow,nonnull-attribute,returns-nonnull-attribute,function)
  endif()
endmacro()
