#include "firmware/stm32f405/module_task.hpp"

#include <cstring>
#include <type_traits>

#include "firmware/stm32f405/faults.hpp"
#include "firmware/stm32f405/led.hpp"
#include "firmware/stm32f405/reset.hpp"

namespace proleg::stm32f405 {
namespace {

/// Longest time between two runs, a quarter of the watchdog's time: with its fastest clock it expires after almost
/// three of these.
constexpr Microseconds max_pause_us = 50'000;
/// Time between two looks at the controller at bus-off: its end raises no interrupt. It takes 1.4 ms at least.
constexpr Microseconds recovery_poll_us = 1'000;

/// Ends the program before its clock is wrong, or because it is.
[[noreturn, gnu::noinline]] void stop(FaultRecord::Reason reason) {
  hardware.servo.finish_last_pulse();
  record_fault(reason);
  reset_chip();
}

LedPattern pattern_of(const firmware::Module& module) {
  if (module.power() == canopen::PowerState::fault) {
    return LedPattern::fault;
  }
  switch (module.state()) {
    case canopen::NmtState::operational:
      return LedPattern::operational;
    case canopen::NmtState::stopped:
      return LedPattern::stopped;
    default:
      return LedPattern::pre_operational;
  }
}

static_assert(std::is_trivially_destructible_v<firmware::Module>,
              "the program has no end at which it would be destroyed");

}  // namespace

void ModuleTask::start(const firmware::ModuleIdentity& identity, firmware::TickRecord& last_tick) {
  last_tick_ = &last_tick;
  module_.emplace(identity, firmware::Ports{hardware.can, hardware.servo, hardware.contacts, hardware.sensors,
                                            hardware.board_records, &hardware.line, &hardware.program});
  last_time_ = hardware.clock.now();
  module_->power_on(last_time_);
}

void ModuleTask::run() {
  take_events();
  const Microseconds now = hardware.clock.now();
  if (module_) {
    follow_bus(now);
    follow_supply(now);
  }
  if (now >= due_) {
    poll(now);
  }
  serve_line(now);
  Microseconds next = poll_by_;
  if (module_) {
    publish_tick();
    const Microseconds deadline = module_->next_deadline();
    next = deadline < next ? deadline : next;
  }
  if (hardware.can.recovering()) {
    next = now + recovery_poll_us < next ? now + recovery_poll_us : next;
  }
  if (module_ && module_->is_supply_low()) {
    next = now + Supply::look_every_us < next ? now + Supply::look_every_us : next;
  }
  // If the deadline is unchanged, and still to come, TIM5 is set already.
  if (next != due_ || next <= now) {
    due_ = next;
    if (!MicrosecondClock::wake_at(due_)) {
      request_pend_sv();
    }
  }
}

Microseconds ModuleTask::in_order(Microseconds time) {
  last_time_ = time > last_time_ ? time : last_time_;
  return last_time_;
}

/// Takes some events at a time, so that deadlines and the watchdog are served even if frames come as fast as the
/// program takes them.
void ModuleTask::take_events() {
  constexpr unsigned events_in_a_row = 16;
  for (unsigned i = 0; i < events_in_a_row; ++i) {
    const Can::Event* const event = hardware.can.next_event();
    if (event == nullptr) {
      return;
    }
    const Microseconds time = in_order(hardware.clock.at(event->stamp));
    if (module_) {
      handle(*event, time);
    }
    hardware.can.drop_event();
  }
  request_pend_sv();
}

/// Passes the state of controller and supply to the module. If a change happened twice, or was not noticed, the module
/// still has the present state.
void ModuleTask::follow_bus(Microseconds now) {
  const bool is_off = hardware.can.is_bus_off();
  if (is_off && !module_->is_bus_off()) {
    module_->bus_off(in_order(now));
  } else if (!is_off && module_->is_bus_off()) {
    module_->bus_back(in_order(now));
  }
  if (const std::uint32_t lost = hardware.can.lost_frames(); lost != module_->lost_frames()) {
    module_->frames_lost(in_order(now), lost);
  }
}

void ModuleTask::follow_supply(Microseconds now) {
  if (hardware.supply.take_drop()) {
    module_->supply_low(in_order(now));
  }
  if (!module_->is_supply_low()) {
    return;
  }
  switch (hardware.supply.look(MicrosecondClock::stamp())) {
    case Supply::Level::good:
      module_->supply_good(in_order(now));
      break;
    case Supply::Level::low:
      break;
    case Supply::Level::none:
      stop(FaultRecord::Reason::supply_failed);
  }
}

/// Serves the line after everything else, and a few characters at a time: the events of the bus come first.
void ModuleTask::serve_line(Microseconds now) {
  hardware.line.follow_console();
  if (module_ && module_->serve_line(in_order(now))) {
    request_pend_sv();
  }
}

void ModuleTask::handle(const Can::Event& event, Microseconds time) {
  switch (event.kind) {
    case Can::EventKind::received:
      module_->receive(time, event.frame);
      break;
    case Can::EventKind::transmitted:
      module_->transmitted(time, event.frame);
      break;
  }
}

void ModuleTask::publish_tick() {
  if (const firmware::TickRecord& record = module_->last_tick(); record.tick != last_tick_->tick) {
    std::memcpy(last_tick_, &record, record.used_bytes());
  }
  last_tick_->power = static_cast<std::uint8_t>(module_->power());
}

/// Comes before each pulse that the program requests.
void ModuleTask::poll(Microseconds now) {
  if (!is_pll_locked()) {
    stop(FaultRecord::Reason::pll_unlocked);
  }
  if (module_) {
    module_->poll(in_order(now));
    show(pattern_of(*module_), now);
  }
  feed_watchdog();
  poll_by_ = now + max_pause_us;
}

}  // namespace proleg::stm32f405
