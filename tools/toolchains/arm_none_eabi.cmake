# Common part of the Cortex-M toolchains: Debian's gcc-arm-none-eabi. The including file sets `cpu`, and
# PROLEG_TARGET, which is the name of its preset.

find_program(PROLEG_ARM_COMPILER arm-none-eabi-g++)
if(NOT PROLEG_ARM_COMPILER)
  # CMake does not break a line that begins with a blank.
  message(FATAL_ERROR " found no arm-none-eabi-g++, expected it in a folder of PATH: "
    "sudo apt install gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib")
endif()
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)

# The FPU is unused (the core computes in integers), so interrupts need not save its registers.
set(cpu_flags "-mcpu=${cpu} -mthumb -mfloat-abi=soft")
set(CMAKE_ASM_FLAGS_INIT "${cpu_flags}")
set(CMAKE_C_FLAGS_INIT "${cpu_flags} -ffreestanding -ffunction-sections -fdata-sections")
# The .ci files beside the objects hold the call graph and the stack of each function, for tools/stack_bound.
set(CMAKE_CXX_FLAGS_INIT "${CMAKE_C_FLAGS_INIT} -fno-threadsafe-statics -fcallgraph-info=su")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles -Wl,--fatal-warnings")

# ccache 4.7 does not store the .ci files, so a cached object would have none.
set(CCACHE_PROGRAM "" CACHE STRING "ccache, unused here")
