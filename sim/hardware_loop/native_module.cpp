#include "sim/hardware_loop/native_module.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::sim {
namespace {

// Thresholds of the chip's voltage detector (firmware/stm32f405/supply.hpp): below the first one no program runs; below
// the others, when the voltage falls and when it rises, the servo has no pulses.
constexpr std::uint32_t runs_from_mv = 2'600;
constexpr std::uint32_t low_below_mv = 2'930;
constexpr std::uint32_t good_from_mv = 3'030;

constexpr BusTime ns_per_us = 1'000;
/// A program that is deaf does nothing for this time, again and again.
constexpr Microseconds deaf_time_us = 1'000'000;

}  // namespace

bool NativeModule::Flash::erase(unsigned sector) {
  std::ranges::fill(sectors_.at(sector), erased);
  return true;
}

bool NativeModule::Flash::program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    sectors_.at(sector).at(offset++) &= byte;  // programming only clears bits
  }
  return true;
}

bool NativeModule::Port::send(const CanFrame& frame) {
  const std::size_t usable = frame.identifier < end_of_urgent_identifiers ? frames_.size() : frames_.size() - 1;
  std::size_t free = frames_.size();
  for (std::size_t mailbox = frames_.size(); mailbox-- > 0;) {
    if (controller_.is_empty(mailbox)) {
      free = mailbox < usable ? mailbox : free;
    } else if (frames_.at(mailbox).identifier == frame.identifier) {
      return false;
    }
  }
  if (free == frames_.size() || !controller_.send(free, frame)) {
    return false;
  }
  frames_.at(free) = frame;
  return true;
}

CanStatus NativeModule::Port::status() {
  constexpr unsigned warning_limit = 96;
  CanStatus status;
  status.receive_errors = static_cast<std::uint16_t>(controller_.receive_errors());
  status.transmit_errors = static_cast<std::uint16_t>(controller_.transmit_errors());
  if (controller_.error_state() == ErrorState::bus_off) {
    status.state = CanState::bus_off;
  } else if (controller_.error_state() == ErrorState::passive) {
    status.state = CanState::error_passive;
  } else if (std::max(controller_.receive_errors(), controller_.transmit_errors()) >= warning_limit) {
    status.state = CanState::error_warning;
  }
  return status;
}

void NativeModule::Port::note_error() {
  switch (controller_.last_error()) {
    case CanError::none:
      break;
    case CanError::stuff:
      errors_.add(CanErrorKind::stuff);
      break;
    case CanError::form:
      errors_.add(CanErrorKind::form);
      break;
    case CanError::acknowledgement:
      errors_.add(CanErrorKind::acknowledgement);
      break;
    case CanError::bit_recessive:
      errors_.add(CanErrorKind::bit_recessive);
      break;
    case CanError::bit_dominant:
      errors_.add(CanErrorKind::bit_dominant);
      break;
    case CanError::crc:
      errors_.add(CanErrorKind::crc);
      break;
  }
}

NativeModule::NativeModule(Bus& bus, const firmware::ModuleIdentity& identity, Crystal crystal, Sensors sensors,
                           Readings readings, bool is_gateway)
    : bus_(bus),
      crystal_(crystal),
      sensors_(std::move(sensors)),
      meters_(std::move(readings)),
      controller_(bus.attach(*this)),
      program_(port_, flash_, identity),
      module_(identity, {port_, *this, *this, meters_, flash_, &line_, &program_}) {
  if (identity.node == 0) {
    return;  // factory-fresh
  }
  firmware::BoardRecord board;
  board.node = identity.node;
  board.has_feedback = (identity.capabilities & canopen::measures_angle) != 0;
  board.feedback_at_minus_90 = Potentiometer::at_minus_90;
  board.feedback_at_plus_90 = Potentiometer::at_plus_90;
  board.is_gateway = is_gateway;
  if (firmware::append(flash_, board) != firmware::AppendResult::ok) {
    throw std::invalid_argument("node id: found " + std::to_string(identity.node) + ", expected at most " +
                                std::to_string(firmware::BoardRecord::max_node));
  }
  controller_.switch_off();
}

void NativeModule::write_settings(std::uint8_t schema) {
  constexpr std::uint32_t sequence = 1;
  constexpr std::size_t schema_at = 4;
  constexpr std::size_t crc_at = firmware::BoardRecord::size - 4;
  firmware::BoardRecord record;
  record.node = firmware::newest_node(flash_.contents(0), flash_.contents(1));
  std::array<std::uint8_t, firmware::BoardRecord::size> bytes = firmware::encode(record, sequence);
  bytes.at(schema_at) = schema;
  write_little_endian(bytes, crc_at, 4, crc32(std::span(bytes).first(crc_at)));
  static_cast<void>(flash_.erase(0));
  static_cast<void>(flash_.erase(1));
  static_cast<void>(flash_.program(0, 0, bytes));
}

void NativeModule::power_on(BusTime now) {
  controller_.switch_off();
  pulse_.reset();
  line_.reset();
  next_event_ = never_on_bus;
  pause_end_ = 0;
  window_end_ = 0;
  after_pause_ = AfterPause::goes_on;
  program_.lose_ram();
  if (has_power_) {
    program_.reset();
    const Microseconds time = start_time_us_ + program_.take_flash_time();
    if (time == 0) {
      start(now);
    } else {
      pause(now, time, AfterPause::starts);
      open_window(now);
    }
  }
}

/// The bootloader acknowledges frames in the window, and sends none.
void NativeModule::open_window(BusTime now) {
  if (start_time_us_ >= broadcast::start_window_us && program_.bootloader() == nullptr) {
    window_end_ = now + broadcast::start_window_us * ns_per_us;
    controller_.switch_on();
  }
}

/// Program or bootloader, whichever the reset has chosen.
void NativeModule::start(BusTime now) {
  if (std::exchange(window_end_, 0) != 0) {
    controller_.switch_off();
  }
  if (program_.bootloader() != nullptr) {
    controller_.switch_on();
    program_.start_bootloader(crystal_.at(now));
  } else if (const ProgramHealth health = program_.health(); health == ProgramHealth::deaf) {
    pause(now, deaf_time_us, AfterPause::stays_deaf);
    return;
  } else if (health != ProgramHealth::good) {
    constexpr Microseconds watchdog_us = 1'000'000;
    constexpr Microseconds fault_us = 1'000;
    pause(now, health == ProgramHealth::hangs ? watchdog_us : fault_us, AfterPause::resets);
    return;
  } else {
    controller_.switch_on();
    meters_.has_converted = meters_.converts;
    module_.power_on(crystal_.at(now));
    if (is_supply_low_) {
      module_.supply_low(crystal_.at(now));
    }
  }
  update_deadline();
}

/// A reset by software or by the watchdog: RAM keeps its contents.
void NativeModule::reset(BusTime now) {
  controller_.switch_off();
  pulse_.reset();
  line_.reset();
  program_.reset();
  pause(now, NativeProgram::start_time_us + program_.take_flash_time(), AfterPause::starts);
}

void NativeModule::pause(BusTime now, Microseconds time, AfterPause after) {
  after_pause_ = after;
  pause_end_ = now + time * ns_per_us;
  next_event_ = pause_end_;
}

void NativeModule::end_pause(BusTime now) {
  pause_end_ = 0;
  switch (std::exchange(after_pause_, AfterPause::goes_on)) {
    case AfterPause::goes_on:
      finish_event(now);
      break;
    case AfterPause::starts:
      start(now);
      break;
    case AfterPause::resets:
      reset(now);
      break;
    case AfterPause::stays_deaf:
      pause(now, deaf_time_us, AfterPause::stays_deaf);
      break;
  }
}

void NativeModule::set_supply(BusTime now, std::uint32_t mv) {
  const bool had_power = has_power_;
  const bool was_low = is_supply_low_;
  has_power_ = mv >= runs_from_mv;
  is_supply_low_ = mv < (was_low ? good_from_mv : low_below_mv);
  if (has_power_ != had_power) {
    power_on(now);
  } else if (has_power_ && is_supply_low_ != was_low && runs_program()) {
    is_supply_low_ ? module_.supply_low(crystal_.at(now)) : module_.supply_good(crystal_.at(now));
    update_deadline();
  }
}

void NativeModule::pulse(std::int32_t width, std::uint32_t /*period_us*/) {
  const bool follows_pulses = pulse_.has_value();
  pulse_ = width;
  if (command_watch_) {
    command_watch_(bus_.now(), width);
  }
  if (pulse_watch_) {
    pulse_watch_({bus_.now(), width, module_.power(), follows_pulses, true});
  }
}

void NativeModule::advance_to(BusTime now, BusTime /*quiet_until*/) {
  if (pause_end_ != 0) {
    if (now >= pause_end_) {
      end_pause(now);
    }
    return;
  }
  if (bootloader::Bootloader* const bootloader = program_.bootloader()) {
    bootloader->poll(crystal_.at(now));
  } else {
    module_.poll(crystal_.at(now));
  }
  finish_event(now);
}

void NativeModule::finish_event(BusTime now) {
  line_.advance_to(now);
  if (runs_program()) {
    while (module_.serve_line(crystal_.at(now))) {
    }
  }
  if (program_.take_reset_request()) {
    reset(now);
  } else if (const Microseconds flash_time = program_.take_flash_time(); program_.bootloader() && flash_time != 0) {
    pause(now, flash_time, AfterPause::goes_on);
  } else {
    update_deadline();
  }
}

void NativeModule::update_deadline() {
  // Most frames leave the deadline as it was, and the crystal's division is slow.
  const bootloader::Bootloader* const bootloader = program_.bootloader();
  if (const Microseconds deadline = bootloader ? bootloader->next_deadline() : module_.next_deadline();
      deadline != deadline_) {
    deadline_ = deadline;
    deadline_time_ = crystal_.when(deadline);
  }
  next_event_ = std::min(deadline_time_, line_.next_event());
}

void NativeModule::received(BusTime time, const CanFrame& frame) {
  if (pause_end_ != 0) {
    if (time <= window_end_ && program_.is_held_by(frame)) {
      pause(time, 1, AfterPause::starts);
    }
    return;
  }
  if (bootloader::Bootloader* const bootloader = program_.bootloader()) {
    bootloader->receive(crystal_.at(time), frame);
  } else if (tamper_) {
    tamper_(frame, [&](const CanFrame& given) { module_.receive(crystal_.at(time), given); });
  } else {
    module_.receive(crystal_.at(time), frame);
  }
  finish_event(time);
}

void NativeModule::transmitted(BusTime time, const CanFrame& frame) {
  if (bootloader::Bootloader* const bootloader = program_.bootloader()) {
    bootloader->transmitted(crystal_.at(time), frame);
  } else if (runs_program()) {
    module_.transmitted(crystal_.at(time), frame);
  }
  if (pause_end_ == 0) {
    finish_event(time);
  }
}

void NativeModule::error_seen(BusTime /*time*/, bool /*was_sending*/) {
  if (window_end_ == 0) {
    port_.note_error();  // else the program has not started
  }
}

void NativeModule::error_state_changed(BusTime time) {
  if (!runs_program()) {
    if (bootloader::Bootloader* const bootloader = program_.bootloader()) {
      bootloader->bus_was_lost();
    }
    return;
  }
  // The controller handles the other states itself; the module ignores bus_back() if it was not in bus-off.
  if (controller_.error_state() == ErrorState::bus_off) {
    module_.bus_off(crystal_.at(time));
  } else {
    module_.bus_back(crystal_.at(time));
  }
  finish_event(time);
}

}  // namespace proleg::sim
