#include "firmware/stm32f405/bootloader/bus.hpp"

#include <algorithm>
#include <optional>

#include "firmware/bootloader/bootloader.hpp"
#include "firmware/module/board_record.hpp"
#include "firmware/module/module_identity.hpp"
#include "firmware/stm32f405/bootloader/program_start.hpp"
#include "firmware/stm32f405/bootloader/slot_memory.hpp"
#include "firmware/stm32f405/can.hpp"
#include "firmware/stm32f405/factory_data.hpp"
#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/microsecond_clock.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"
#include "firmware/stm32f405/watchdog.hpp"

extern "C" {

/// RAM for an image; the linker script defines it.
extern std::uint8_t image_buffer_start[];
extern std::uint8_t image_buffer_end[];

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

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

}  // namespace

void serve_bus(const bootloader::Handover& left) {
  the_can.emplace();
  if (!the_can->start()) {
    reset_chip();
  }
  firmware::ModuleIdentity identity;
  identity.unique_id = factory::unique_id();
  the_bootloader.emplace(
      image_place(), serial_number(identity),
      bootloader::Ports{*the_can, the_slot_memory, the_settings, {image_buffer_start, image_buffer_end}});
  constexpr std::array broadcast{broadcast::host_identifier};
  the_can->listen(broadcast);
  the_bootloader->power_on(the_clock.now(), the_settings.node(), left);
  for (const Interrupt interrupt : {Interrupt::can1_tx, Interrupt::can1_rx0, Interrupt::can1_sce, Interrupt::timer_5}) {
    nvic::enable(interrupt);
  }
  BusRecovery recovery;
  for (;;) {
    feed_watchdog();
    take_events();
    const Microseconds now = the_clock.now();
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

}  // namespace proleg::stm32f405

using namespace proleg::stm32f405;

extern "C" {

void can1_tx_handler() { the_can->on_transmit_interrupt(MicrosecondClock::stamp()); }

void can1_rx0_handler() { the_can->on_receive_interrupt(MicrosecondClock::stamp()); }

void can1_sce_handler() { the_can->on_status_interrupt(); }

void tim5_handler() { MicrosecondClock::on_interrupt(); }

}  // extern "C"
