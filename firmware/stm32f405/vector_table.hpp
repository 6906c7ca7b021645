#pragma once

// The vector table of a program, and the start of a program by its vector table.

#include <array>
#include <cstdint>

#include "firmware/stm32f405/registers/core.hpp"

extern "C" {

// The functions in the vector table.

[[noreturn]] void reset_handler();  ///< defined in start.cpp
void fault_handler();               ///< defined in faults.cpp
void can1_tx_handler();             ///< defined in hardware.cpp, as are the interrupts below
void can1_rx0_handler();
void can1_sce_handler();
void tim5_handler();
void pvd_handler();
void usart2_handler();
void dma1_stream5_handler();
void dma1_stream6_handler();

/// The program at the lowest priority, which interrupts request, and the start. Each program (main.cpp, the tests of
/// the drivers) defines both.
void pend_sv_handler();
[[noreturn]] void run_program();

extern const std::uint32_t stack_top[];  ///< the linker script defines it

}  // extern "C"

namespace proleg::stm32f405 {

/// Must be the last statement of each handler: a store that ends at the return may make the processor take the handler
/// of a wrong interrupt (ARM, erratum 838869 of Cortex-M4 r0p1).
[[gnu::always_inline]] inline void end_handler() { asm volatile("dsb" : : : "memory"); }

/// The vector table (PM0214, table 17, and RM0090, table 61) up to the last interrupt that a program enables. All
/// handlers that are not set are fault handlers.
template <unsigned interrupt_count>
struct VectorTable {
  using Handler = void (*)();

  /// A word that ARM reserves.
  union Reserved {
    Handler handler;
    std::uint32_t number;
  };

  constexpr VectorTable() {
    faults.fill(fault_handler);
    exceptions.fill(fault_handler);
    interrupts.fill(fault_handler);
  }
  constexpr void set(Interrupt interrupt, Handler handler) { interrupts[static_cast<unsigned>(interrupt)] = handler; }

  const std::uint32_t* initial_stack = stack_top;
  Handler reset = reset_handler;
  std::array<Handler, 5> faults{};      ///< handlers of NMI, exception 2, to usage fault, 6
  Reserved reserved{fault_handler};     ///< exception 7; a bootloader names its board here (board_names.hpp)
  std::array<Handler, 8> exceptions{};  ///< handlers from exception 8 on
  std::array<Handler, interrupt_count> interrupts{};
};
static_assert(sizeof(VectorTable<5>) == sizeof(VectorTable<5>::Handler) * (16 + 5));

/// Starts the program whose vector table is at this address, with its stack.
[[noreturn, gnu::always_inline]] inline void jump_to(std::uint32_t vector_table) {
  const std::uint32_t stack = Register(vector_table).read();
  const std::uint32_t entry = Register(vector_table + 4).read();
  scb::vtor.write(vector_table);
  asm volatile("dsb\n\tisb\n\tmsr msp, %0\n\tbx %1" : : "r"(stack), "r"(entry) : "memory");
  __builtin_unreachable();
}

}  // namespace proleg::stm32f405
