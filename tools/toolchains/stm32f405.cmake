# STM32F405: Cortex-M4, its FPU unused.
set(cpu cortex-m4)
include(${CMAKE_CURRENT_LIST_DIR}/arm_none_eabi.cmake)
