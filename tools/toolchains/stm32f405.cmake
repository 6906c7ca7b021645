# STM32F405: Cortex-M4, its FPU unused. There is an image for it: firmware/stm32f405.
set(cpu cortex-m4)
set(PROLEG_TARGET stm32f405)
include(${CMAKE_CURRENT_LIST_DIR}/arm_none_eabi.cmake)
