#pragma once

#include <array>
#include <cstdint>

#include "firmware/stm32f405/handlers.hpp"
#include "firmware/stm32f405/registers/core.hpp"

extern "C" {

extern const std::uint32_t stack_top[];  ///< the linker script defines it

}  // extern "C"

namespace proleg::stm32f405 {

/// The vector table (PM0214, table 17, and RM0090, table 61) up to the last interrupt that a program enables. All
/// handlers that are not set are fault handlers.
template <unsigned interrupt_count>
struct VectorTable {
  using Handler = void (*)();

  constexpr VectorTable() {
    exceptions.fill(fault_handler);
    interrupts.fill(fault_handler);
  }
  constexpr void set(Interrupt interrupt, Handler handler) { interrupts[static_cast<unsigned>(interrupt)] = handler; }

  const std::uint32_t* initial_stack = stack_top;
  Handler reset = reset_handler;
  std::array<Handler, 14> exceptions{};  ///< handlers from NMI, exception 2, on
  std::array<Handler, interrupt_count> interrupts{};
};
static_assert(sizeof(VectorTable<5>) == sizeof(VectorTable<5>::Handler) * (16 + 5));

}  // namespace proleg::stm32f405
