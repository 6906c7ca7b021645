// The bootloader, in flash sectors 0 and 1, from which the chip starts. It starts the module's program, or stays on the
// bus to receive another one (docs/flashing.md).
//
// A confirmed image is started at once: after its checksum, with the chip as it is after a reset but for the servo's
// pin. Everything else needs clocks: the window after power on, a start on trial, the return to the backup. It ends
// with a reset of the chip, after which the program is started in the same way.

#include <algorithm>
#include <optional>

#include "firmware/bootloader/bootloader.hpp"
#include "firmware/module/board_record.hpp"
#include "firmware/module/module_identity.hpp"
#include "firmware/stm32f405/bootloader/program_slots.hpp"
#include "firmware/stm32f405/can.hpp"
#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/factory_data.hpp"
#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/handover.hpp"
#include "firmware/stm32f405/led.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/supply.hpp"
#include "firmware/stm32f405/vector_table.hpp"

extern "C" {

/// RAM for an image; the linker script defines it.
extern std::uint8_t image_buffer_start[];
extern std::uint8_t image_buffer_end[];

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

/// Time of the watchdog. SHA-256 and checksums of an image take a tenth of a second between two feeds. The program sets
/// its own time.
constexpr std::uint32_t watchdog_ms = 1'000;

using bootloader::FlashSlot;
using bootloader::Handover;
using bootloader::HandoverAction;
using bootloader::NextStep;
using bootloader::Slots;
using bootloader::StartResult;
using bootloader::WindowEnd;

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

/// Resets the chip if a program may run, which then starts. Returns only if no program may run or the flash failed.
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

/// Keeps the node id that LSS gives.
class Settings final : public canopen::LssStorage {
 public:
  [[nodiscard]] Result store_node(std::uint8_t node) override {
    return {firmware::append_node(flash_, node) == firmware::AppendResult::ok ? canopen::lss::ok
                                                                              : canopen::lss::storage_failed};
  }
  /// The stored node id; 0: none.
  [[nodiscard]] std::uint8_t node() const { return firmware::newest_node(flash_.contents(0), flash_.contents(1)); }

 private:
  BoardRecordFlash flash_;
};

// The drivers are static, so that the interrupts find them, and the stack stays small.
constinit std::optional<Can> the_can;  // it is in .bss, which needs no flash
constinit MicrosecondClock the_clock;
constinit SlotMemory the_slot_memory;
constinit Settings the_settings;
constinit std::optional<bootloader::Bootloader> the_bootloader;

/// Time after which a controller that was bus-off comes back.
constexpr Microseconds bus_off_pause_us = 100'000;

constexpr Microseconds recovery_poll_us = 1'000;
/// Longest time between two runs, a quarter of the watchdog's time: with its fastest clock it expires after almost
/// three of these.
constexpr Microseconds max_pause_us = 50'000;

/// Lets the controller recover from bus-off, whose end raises no interrupt.
class BusRecovery {
 public:
  void follow(Microseconds now) {
    const bool is_off = the_can->is_bus_off();
    if (is_off && !was_off_) {
      the_bootloader->bus_was_lost();
      recover_at_ = now + bus_off_pause_us;
    }
    if (is_off && now >= recover_at_) {
      the_can->recover();
      recover_at_ = never;
    }
    was_off_ = is_off;
  }
  /// Time of the next look at the controller: the end of a recovery raises no interrupt.
  [[nodiscard]] Microseconds next_deadline() const {
    return the_can->recovering() ? the_clock.now() + recovery_poll_us : recover_at_;
  }

 private:
  bool was_off_ = false;
  Microseconds recover_at_ = never;
};

/// Takes some events at a time, so that the watchdog is fed.
void take_events() {
  for (unsigned left = 16; left != 0; --left) {
    const Can::Event* const event = the_can->next_event();
    if (event == nullptr) {
      return;
    }
    const Microseconds time = the_clock.at(event->stamp);
    if (event->kind == Can::EventKind::received) {
      the_bootloader->receive(time, event->frame);
    } else {
      the_bootloader->transmitted(time, event->frame);
    }
    the_can->drop_event();
  }
}

/// Sleeps until an event of the bus or the deadline. Interrupts are masked, so that none comes between the look at the
/// events and the sleep: a masked one wakes the CPU, too (PM0214, section 2.5.1).
void sleep_until(Microseconds deadline) {
  asm volatile("cpsid i" : : : "memory");
  if (the_can->next_event() == nullptr && deadline > the_clock.now() && MicrosecondClock::wake_at(deadline)) {
    asm volatile("dsb\n\twfi");
  }
  asm volatile("cpsie i" : : : "memory");
}

/// The serial number of this module.
std::uint32_t own_serial() {
  firmware::ModuleIdentity identity;
  identity.unique_id = factory::unique_id();
  return serial_number(identity);
}

/// Takes part in the bus. The clocks and TIM5 run. False if the chip must be reset.
bool join_bus() {
  the_can.emplace();
  if (!is_pll_locked() || !the_can->start()) {
    return false;
  }
  enable_detector_interrupt();
  for (const Interrupt interrupt :
       {Interrupt::pvd, Interrupt::can1_tx, Interrupt::can1_rx0, Interrupt::can1_sce, Interrupt::timer_5}) {
    nvic::enable(interrupt);
  }
  return true;
}

/// Whether a host asks for the bootloader before a time. The controller acknowledges frames and sends none: without
/// acknowledgement a host that is alone on the bus would repeat its first frame.
bool is_wanted_until(Microseconds end) {
  const std::uint32_t serial = own_serial();
  for (Microseconds now = the_clock.now(); now < end; now = the_clock.now()) {
    feed_watchdog();
    if (const Can::Event* const event = the_can->next_event()) {
      const bool is_request = broadcast::is_enter_request(event->frame, serial);
      the_can->drop_event();
      if (is_request) {
        return true;
      }
    }
    sleep_until(end);
  }
  return false;
}

/// Serves the bus until the chip must be reset. The module has joined the bus. left: by the start before.
[[noreturn]] void serve_bus(const Handover& left) {
  the_bootloader.emplace(
      image_place(), own_serial(),
      bootloader::Ports{*the_can, the_slot_memory, the_settings, {image_buffer_start, image_buffer_end}});
  constexpr std::array broadcast{broadcast::host_identifier};
  the_can->listen(broadcast);
  the_bootloader->power_on(the_clock.now(), the_settings.node(), left);
  BusRecovery recovery;
  for (;;) {
    feed_watchdog();
    take_events();
    const Microseconds now = the_clock.now();
    show(LedPattern::bootloader, now);
    recovery.follow(now);
    if (now >= the_bootloader->next_deadline()) {
      the_bootloader->poll(now);
    }
    if (the_bootloader->wants_restart()) {
      reset_chip();
    }
    sleep_until(std::min({the_bootloader->next_deadline(), recovery.next_deadline(), now + max_pause_us}));
  }
}

/// Starts what the bootloader needs itself, not the program. False: there is no CAN.
bool start_hardware() {
  static_cast<void>(start_watchdog(watchdog_ms));  // if it fails, the watchdog has 512 ms, which is enough
  start_pins();
  if (start_clocks() != ClockResult::ok) {
    return false;
  }
  MicrosecondClock().start();
  return true;
}

/// After power on: listens if there is a confirmed program, and serves the bus if a host asks for it. Then it resets
/// the chip, and the program starts; if none may run, it serves the bus. Without CAN there is no window.
[[noreturn]] void listen_first(Slots& slots, const Handover& left) {
  bool starts_program = false;
  if (start_hardware() && join_bus()) {
    const Microseconds end = the_clock.now() + broadcast::start_window_us;
    const NextStep step = next_step(slots, left);  // its checksum takes a part of the window
    const bool listens = step != NextStep::serve_bus && slots.is_confirmed(FlashSlot::a);
    if (listens && is_wanted_until(end)) {
      serve_bus({HandoverAction::stay, 0});
    }
    if (step == NextStep::prepare) {
      prepare_program(slots);
    }
    if (step != NextStep::start_program) {
      serve_bus(left);
    }
    starts_program = true;
  }
  leave_handover(left_by_window(left, starts_program));
  reset_chip();
}

}  // namespace
}  // namespace proleg::stm32f405

using namespace proleg::stm32f405;
using proleg::firmware::ResetCause;

extern "C" {

void run_program() {
  const std::uint32_t csr = rcc::csr.read();
  Handover left = take_handover();
  if (reset_cause_of(csr) == ResetCause::pin) {
    left = {is_second_press(left) ? HandoverAction::stay : HandoverAction::none, 0};
  }
  // Not after a reset by software: it would end nothing if the button is stuck. The bootloader resets the chip so when
  // no host has asked for anything.
  const bool is_by_software = (csr & rcc::csr_sftrstf) != 0;
  if (!is_by_software && is_recover_button_held()) {
    left = {HandoverAction::stay, 0};
  }
  SlotMemory memory;
  Slots slots(memory, image_place());
  if (has_just_got_power(csr) && left.action != HandoverAction::stay) {
    listen_first(slots, left);
  }
  bool starts_program = false;
  if (left.action == HandoverAction::window_over) {
    starts_program = WindowEnd::of(left.argument).starts_program;
    left = left_before_window(left);
  }
  const NextStep step = starts_program ? NextStep::start_program : next_step(slots, left);
  if (step == NextStep::start_program) {
    leave_handover(started_after(left));
    // The watchdog is started now and not before, because the checksum of the image takes long at the clock after a
    // reset.
    static_cast<void>(start_watchdog(watchdog_ms));
    start_program();
  }
  if (!start_hardware()) {
    // There is no CAN without the crystal, and no program would start. The watchdog resets the chip: crystal and supply
    // may be good then.
    for (;;) {
      asm volatile("wfi");
    }
  }
  if (step == NextStep::prepare) {
    prepare_program(slots);
  }
  if (!join_bus()) {
    reset_chip();
  }
  serve_bus(left);
}

void can1_tx_handler() {
  the_can->on_transmit_interrupt(MicrosecondClock::stamp());
  end_handler();
}

void can1_rx0_handler() {
  the_can->on_receive_interrupt(MicrosecondClock::stamp());
  end_handler();
}

void can1_sce_handler() {
  the_can->on_status_interrupt();
  end_handler();
}

/// The supply is too low for the clocks: the next start waits for it.
void pvd_handler() { reset_chip(); }

void tim5_handler() {
  MicrosecondClock::on_interrupt();
  end_handler();
}

}  // extern "C"
