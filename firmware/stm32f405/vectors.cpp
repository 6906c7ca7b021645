// The vector table of the module's program. The code that starts the program sets VTOR and the stack pointer.

#include "firmware/stm32f405/vector_table.hpp"

namespace proleg::stm32f405 {
namespace {

using Table = VectorTable<interrupt_count>;

constexpr Table make_vectors() {
  Table table;
  constexpr unsigned first_exception = 8;
  constexpr unsigned pend_sv = 14;
  table.exceptions[pend_sv - first_exception] = pend_sv_handler;
  table.set(Interrupt::pvd, pvd_handler);
  table.set(Interrupt::can1_tx, can1_tx_handler);
  table.set(Interrupt::can1_rx0, can1_rx0_handler);
  table.set(Interrupt::can1_sce, can1_sce_handler);
  table.set(Interrupt::timer_5, tim5_handler);
  table.set(Interrupt::usart2, usart2_handler);
  table.set(Interrupt::dma1_stream_5, dma1_stream5_handler);
  table.set(Interrupt::dma1_stream_6, dma1_stream6_handler);
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const Table vectors = make_vectors();

}  // namespace
}  // namespace proleg::stm32f405
