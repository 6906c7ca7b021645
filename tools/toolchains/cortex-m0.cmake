# Any Cortex-M0: no 64-bit multiplication, no division.
set(cpu cortex-m0)
set(PROLEG_TARGET cortex-m0)
include(${CMAKE_CURRENT_LIST_DIR}/arm_none_eabi.cmake)
