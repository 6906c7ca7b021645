#pragma once

// How the module's program runs, and why nothing in it needs to be locked:
//
//   priority 0    CAN1_TX, CAN1_RX0, CAN1_SCE   note what happened, with its time; ask for PendSV
//   priority 8    USART2                        sends the console's next byte
//   priority 15   PendSV, TIM5                  everything else: ModuleTask::run()
//   thread        the start; afterwards the CPU sleeps whenever no interrupt runs (sleep on exit)
//
// An interrupt runs as a whole between two instructions of a lower priority, and never while one of its own priority
// runs. So all code of firmware/module runs in one priority, one event after the other, as in the simulator. What
// crosses from one priority to another is a ring, each of whose ends belongs to one priority (EventRing); or a single
// word (in Can), written by one side at a time. A register that two priorities write is written as a whole or has bits
// that only set or clear. The one exception is flash.hpp, which holds all interrupts up.
//
// The watchdog is fed here, after the module was polled: so it bites if PendSV does not come any more (TIM5 or the
// interrupts are broken), if the program does not return, or if something above it takes all the time. An event cannot
// be lost between two runs: asking for PendSV while it runs makes it run again.

#include <optional>

#include "firmware/module/module.hpp"
#include "firmware/stm32f405/hardware.hpp"

namespace proleg::stm32f405 {

/// Hands the events of the hardware to the module, in their order, and polls it at its deadlines.
class ModuleTask {
 public:
  /// Before the interrupts are enabled. Without it the task feeds the watchdog, and that is all. The record of each
  /// tick is copied to last_tick, so that it has a place that is known without the program running.
  void start(const firmware::ModuleIdentity& board, firmware::TickRecord& last_tick);

  /// What PendSV and TIM5 do.
  void run();

 private:
  void take_events();
  void handle(const Can::Event& event, Microseconds time);
  void publish_tick();
  void poll(Microseconds now);
  /// A time that is not before the one that the module was told last: an event may be noted while a deadline is worked
  /// on.
  [[nodiscard]] Microseconds in_order(Microseconds time);

  std::optional<firmware::Module> module_;
  firmware::TickRecord* last_tick_ = nullptr;  ///< null: there is no module
  Microseconds told_ = 0;
  Microseconds due_ = 0;      ///< when to poll next
  Microseconds poll_by_ = 0;  ///< and to feed the watchdog, at the latest
};

}  // namespace proleg::stm32f405
