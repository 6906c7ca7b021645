#pragma once

#include "firmware/stm32f405/registers/core.hpp"

namespace proleg::stm32f405 {

/// Starts the program whose vector table is at this address, with its stack.
[[noreturn, gnu::always_inline]] inline void jump_to(std::uint32_t vector_table) {
  const std::uint32_t stack = Register(vector_table).read();
  const std::uint32_t entry = Register(vector_table + 4).read();
  scb::vtor.write(vector_table);
  asm volatile("dsb\n\tisb\n\tmsr msp, %0\n\tbx %1" : : "r"(stack), "r"(entry) : "memory");
  __builtin_unreachable();
}

}  // namespace proleg::stm32f405
