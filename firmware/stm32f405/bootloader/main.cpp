// The bootloader, in flash sector 0, from which the chip starts. It starts the module's program, or stays on the bus to
// receive another one (docs/flashing.md).
//
// A confirmed image is started at once: after its checksum, with the chip as it is after a reset. Everything else, a
// start on trial or the return to the backup, needs clocks and flash operations. It ends with a reset of the chip,
// after which the program is started in the same way.

#include "firmware/stm32f405/bootloader/bus.hpp"
#include "firmware/stm32f405/bootloader/program_start.hpp"
#include "firmware/stm32f405/bootloader/slot_memory.hpp"
#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/gpio.hpp"
#include "firmware/stm32f405/handover.hpp"
#include "firmware/stm32f405/microsecond_clock.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"
#include "firmware/stm32f405/watchdog.hpp"

namespace proleg::stm32f405 {
namespace {

/// Time of the watchdog. SHA-256 and checksums of an image take a tenth of a second between two feeds. The program sets
/// its own time.
constexpr std::uint32_t watchdog_ms = 1'000;

using bootloader::Handover;
using bootloader::HandoverAction;
using bootloader::NextStep;
using bootloader::Slots;
using bootloader::StartResult;

/// Waits in a loop, so that no peripheral is changed before the program starts.
void wait(std::uint32_t milliseconds) {
  constexpr std::uint32_t cycles_of_a_round = 4;  // a round takes three or four
  for (std::uint32_t round = milliseconds * (board::internal_oscillator / 1'000 / cycles_of_a_round); round != 0;
       --round) {
    asm volatile("" : "+r"(round));
  }
}

/// Whether the pin has reset the chip twice within half a second: a person wants the bootloader.
bool is_second_press(const Handover& left) {
  if (left.action == HandoverAction::pin_seen) {
    return true;
  }
  constexpr std::uint32_t bounce_ms = 50;
  constexpr std::uint32_t press_ms = 500;
  wait(bounce_ms);
  leave_handover({HandoverAction::pin_seen, 0});
  wait(press_ms);
  leave_handover({});
  return false;
}

/// Prepares the program that may run: it runs after a reset of the chip. Returns if there is none.
void prepare_program(Slots& slots) {
  switch (slots.prepare_start()) {
    case StartResult::run:
    case StartResult::run_on_trial:
      leave_handover({HandoverAction::start, 0});
      reset_chip();
    case StartResult::nothing:
    case StartResult::flash_failed:
      break;
  }
}

}  // namespace
}  // namespace proleg::stm32f405

using namespace proleg::stm32f405;
using proleg::firmware::ResetCause;

extern "C" {

void run_program() {
  Handover left = take_handover();
  if (reset_cause_of(rcc::csr.read()) == ResetCause::pin) {
    left = {is_second_press(left) ? HandoverAction::stay : HandoverAction::none, 0};
  }
  SlotMemory memory;
  Slots slots(memory, image_place());
  const NextStep step = next_step(slots, left);
  if (step == NextStep::start_program) {
    leave_handover(started_after(left));
    // The watchdog is started now and not before, because the checksum of the image takes long at the clock after a
    // reset.
    static_cast<void>(start_watchdog(watchdog_ms));
    start_program();
  }
  static_cast<void>(start_watchdog(watchdog_ms));  // if it fails, the watchdog has 512 ms, which is enough
  start_pins();
  if (start_clocks() != ClockResult::ok) {
    // There is no CAN without the crystal, and no program would start. The watchdog resets the chip: the crystal may
    // start then.
    for (;;) {
      asm volatile("wfi");
    }
  }
  MicrosecondClock().start();
  if (step == NextStep::prepare) {
    prepare_program(slots);
  }
  serve_bus(left);
}

}  // extern "C"
