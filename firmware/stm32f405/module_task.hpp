#pragma once

// How the module's program runs, and why nothing in it needs to be locked:
//
//   priority 0    CAN1_TX, CAN1_RX0             record the event with its time; request PendSV
//                 CAN1_SCE, PVD                 request PendSV, which reads the state of controller and supply
//   priority 8    USART2                        sends the console's next byte; of a gateway: idle line and errors
//   priority 15   DMA1 streams 5, 6             of a gateway: its line has characters, or has sent them; request PendSV
//                 PendSV, TIM5                  everything else: ModuleTask::run()
//   thread        the start; afterwards the CPU sleeps whenever no interrupt runs (sleep on exit)
//
// An interrupt runs as a whole between two instructions of a lower priority, and never while one of the same priority
// runs. So all code of firmware/module runs at one priority, one event after the other, as in the simulator. Data
// passes from one priority to another in a ring, each of whose ends belongs to one priority (EventRing), or as a single
// word (in Can) that one side writes at a time. A register that two priorities write is written as a whole or has bits
// that only set or clear. The exceptions are flash.hpp and servo.cpp, which disable all interrupts.
//
// ModuleTask feeds the watchdog after it has polled the module. So the watchdog resets the chip if PendSV stops coming
// (TIM5 or the interrupts fail), if the program does not return, or if a higher priority takes all the time. No event
// is lost between two runs: if PendSV is requested while it runs, it runs again.

#include <optional>

#include "firmware/module/module.hpp"
#include "firmware/stm32f405/hardware.hpp"

namespace proleg::stm32f405 {

/// Passes the events of the hardware to the module, in their order, and polls it at its deadlines.
class ModuleTask {
 public:
  /// Starts the module. Must be called before the interrupts are enabled; without it the task only feeds the watchdog.
  /// The record of each tick is copied to last_tick, with the present state of the drive, so that its address is known
  /// before the program runs.
  void start(const firmware::ModuleIdentity& identity, firmware::TickRecord& last_tick);

  /// Must be called by PendSV and TIM5.
  void run();

 private:
  void take_events();
  void follow_bus(Microseconds now);
  void follow_supply(Microseconds now);
  void serve_line(Microseconds now);
  void handle(const Can::Event& event, Microseconds time);
  void publish_tick();
  void poll(Microseconds now);
  /// `time`, or the last time that the module received if that is later: an interrupt may record an event while the
  /// module works on a deadline.
  [[nodiscard]] Microseconds in_order(Microseconds time);

  std::optional<firmware::Module> module_;
  firmware::TickRecord* last_tick_ = nullptr;  ///< null: there is no module
  Microseconds last_time_ = 0;                 ///< last time that the module received
  Microseconds due_ = 0;                       ///< time of the next poll
  Microseconds poll_by_ = 0;                   ///< the latest time to poll, and to feed the watchdog
};

}  // namespace proleg::stm32f405
