// The vector table of the bootloader, with which the chip starts.

#include <cstddef>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"
#include "shared/image/board_names.hpp"

namespace proleg::stm32f405 {
namespace {

using Table = VectorTable<static_cast<unsigned>(Interrupt::timer_5) + 1>;

constexpr Table make_vectors() {
  Table table;
  static_assert(offsetof(Table, reserved) == image::bootloader_board_at);
  table.reserved.number = image::bootloader_board_mark | board::id;
  table.set(Interrupt::pvd, pvd_handler);
  table.set(Interrupt::can1_tx, can1_tx_handler);
  table.set(Interrupt::can1_rx0, can1_rx0_handler);
  table.set(Interrupt::can1_sce, can1_sce_handler);
  table.set(Interrupt::timer_5, tim5_handler);
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constinit const Table vectors = make_vectors();

}  // namespace
}  // namespace proleg::stm32f405

extern "C" {

/// A fault resets the chip. A record of the fault would have no reader.
void fault_handler() { proleg::stm32f405::reset_chip(); }

/// The compiler's tables contain this function in place of a virtual function that is not overridden.
[[noreturn]] void __cxa_pure_virtual() { proleg::stm32f405::reset_chip(); }

}  // extern "C"
