// The image's vector table, and the start, which fills the RAM. The start stub, later the bootloader, sets VTOR and the
// stack pointer before it jumps here.

#include <array>
#include <cstdint>

#include "firmware/stm32f405/handlers.hpp"
#include "firmware/stm32f405/registers/core.hpp"

extern "C" {

// Places in flash and RAM, from the linker script.
extern const std::uint32_t ram_code_load[];
extern std::uint32_t ram_code_start[];
extern std::uint32_t ram_code_end[];
extern const std::uint32_t data_load[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];
extern const std::uint32_t stack_top[];

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

using Handler = void (*)();

/// PM0214, table 17, and RM0090, table 61.
struct VectorTable {
  const std::uint32_t* initial_stack = stack_top;
  Handler reset = reset_handler;
  std::array<Handler, 14> exceptions{};
  std::array<Handler, interrupt_count> interrupts{};
};

constexpr VectorTable make_vectors() {
  VectorTable table;
  constexpr unsigned first_exception = 2;
  constexpr unsigned pend_sv = 14;
  table.exceptions.fill(fault_handler);
  table.exceptions[pend_sv - first_exception] = pend_sv_handler;
  table.interrupts.fill(fault_handler);
  const auto set = [&](Interrupt interrupt, Handler handler) {
    table.interrupts[static_cast<unsigned>(interrupt)] = handler;
  };
  set(Interrupt::pvd, pvd_handler);
  set(Interrupt::can1_tx, can1_tx_handler);
  set(Interrupt::can1_rx0, can1_rx0_handler);
  set(Interrupt::can1_sce, can1_sce_handler);
  set(Interrupt::timer_5, tim5_handler);
  set(Interrupt::usart2, usart2_handler);
  set(Interrupt::dma1_stream_5, dma1_stream5_handler);
  set(Interrupt::dma1_stream_6, dma1_stream6_handler);
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = make_vectors();
static_assert(sizeof(VectorTable) == 4 * (16 + interrupt_count));

void copy(const std::uint32_t* source, std::uint32_t* target, const std::uint32_t* end) {
  while (target != end) {
    *target++ = *source++;
  }
}

}  // namespace
}  // namespace proleg::stm32f405

extern "C" {

// No constructors run: the linker script checks that there are none (all static objects are constinit).
void reset_handler() {
  proleg::stm32f405::copy(ram_code_load, ram_code_start, ram_code_end);
  proleg::stm32f405::copy(data_load, data_start, data_end);
  for (std::uint32_t* word = bss_start; word != bss_end; ++word) {
    *word = 0;
  }
  run_program();
}

}  // extern "C"
