#include "host/dynamixel/servo_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace proleg::host {
namespace {

/// Number of missed answers in a row after which a servo counts as lost: two damaged answers in a row can be noise.
constexpr unsigned max_missed = 3;
/// Period in ticks at which the watchdog of one servo is read instead of angles.
constexpr std::uint32_t watchdog_ticks = 16;
constexpr unsigned return_delay_unit_us = 2;
constexpr std::uint32_t search_time_us = 300'000;

struct HardwareError {
  unsigned bit;
  const char* what;
};

/// The bits of Hardware Error Status(70) (e-manual).
constexpr std::array<HardwareError, 5> hardware_errors{{{0x01, "input voltage"},
                                                        {0x04, "overheating"},
                                                        {0x08, "motor encoder"},
                                                        {0x10, "electrical shock"},
                                                        {0x20, "overload"}}};

std::string describe_hardware_error(std::uint32_t status) {
  std::string text;
  for (const HardwareError& error : hardware_errors) {
    if ((status & error.bit) != 0) {
      text += (text.empty() ? "" : ", ") + std::string(error.what);
    }
  }
  return text.empty() ? "status " + std::to_string(status) : text;
}

std::string listed(std::span<const std::uint8_t> ids) {
  std::string text;
  for (const std::uint8_t id : ids) {
    text += (text.empty() ? "" : ", ") + std::to_string(id);
  }
  return text.empty() ? "no servo answers" : "servos that answer: " + text;
}

std::int32_t position_in(std::span<const std::uint8_t> bytes) { return static_cast<std::int32_t>(number_of(bytes)); }

}  // namespace

ServoChain::ServoChain(Line& line, ChainSettings settings, Show show)
    : settings_(std::move(settings)),
      show_(std::move(show)),
      bus_(line, settings_.rate),
      readings_(settings_.servos.size()),
      missed_(settings_.servos.size()) {
  for (const ServoSettings& servo : settings_.servos) {
    ids_.push_back(servo.id);
  }
}

std::string ServoChain::name_of(std::size_t joint) const {
  return "servo " + std::to_string(ids_[joint]) + " (joint " + settings_.servos[joint].joint + ")";
}

std::size_t ServoChain::joint_of(std::uint8_t id) const {
  return static_cast<std::size_t>(std::ranges::find(ids_, id) - ids_.begin());
}

void ServoChain::connect(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  is_connected_ = false;
  return_delay_us_ = 0;
  find_all();
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    prepare(joint);
  }
  reads_per_tick_ =
      std::max<std::size_t>(1, readable_servos(ids_.size(), settings_.rate, settings_.tick_us, return_delay_us_));
  read_all_angles();
  std::ranges::fill(missed_, 0U);
  next_read_ = 0;
  ticks_ = 0;
  is_connected_ = true;
}

void ServoChain::find_all() {
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    unsigned model = 0;
    try {
      model = bus_.ping(ids_[joint]);
    } catch (const ServoError& error) {
      throw ServoError(name_of(joint) + " " + error.what_it_does() + " on " + settings_.device + " at " +
                       std::to_string(settings_.rate) + " baud (" + listed(bus_.find_servos(search_time_us)) +
                       "); check cable, power, id and Baud Rate(8)");
    }
    if (!has_this_table(model)) {
      throw ServoError(name_of(joint) + " has the model number " + std::to_string(model) +
                       ", expected one of the X series or MX(2.0)");
    }
  }
}

void ServoChain::prepare(std::size_t joint) {
  const std::uint8_t id = ids_[joint];
  // At a lower status return level a servo does not answer the following requests.
  bus_.write_unconfirmed(id, status_return_level, 2);
  bus_.write(id, torque_enable, 0);
  require_healthy(joint);
  bus_.write(id, bus_watchdog, 0);
  prepare_modes(joint);
  check_position_limits(joint);
  bus_.write(id, profile_acceleration, 0);
  const double velocity = std::floor(settings_.servos[joint].max_speed_deg_s / profile_velocity_unit_deg_s);
  bus_.write(id, profile_velocity, static_cast<std::uint32_t>(std::clamp(velocity, 1.0, 32'767.0)));
  return_delay_us_ = std::max(return_delay_us_, bus_.read_number(id, return_delay_time) * return_delay_unit_us);
}

void ServoChain::prepare_modes(std::size_t joint) {
  // These items are in the EEPROM, which wears out: they are written only if they are wrong.
  const std::uint8_t id = ids_[joint];
  const std::array<std::pair<TableItem, std::uint8_t>, 2> wanted{
      {{operating_mode, position_control_mode}, {drive_mode, 0}}};
  for (const auto& [item, value] : wanted) {
    const std::uint32_t found = bus_.read_number(id, item);
    if (found != value) {
      bus_.write(id, item, value);
      show_(name_of(joint) + ": " + (item.address == drive_mode.address ? "Drive Mode(10)" : "Operating Mode(11)") +
            " was " + std::to_string(found) + ", is " + std::to_string(value) + " now");
    }
  }
}

void ServoChain::check_position_limits(std::size_t joint) {
  const ServoSettings& servo = settings_.servos[joint];
  const auto first = position_in(bus_.read(servo.id, min_position_limit));
  const auto last = position_in(bus_.read(servo.id, max_position_limit));
  const auto [lowest, highest] =
      std::minmax({servo.position_of(servo.lower_limit_deg), servo.position_of(servo.upper_limit_deg)});
  if (lowest < first || highest > last) {
    // The servo would not move to such a goal, and a packet to all servos is not answered.
    throw ServoError(name_of(joint) + " allows positions " + std::to_string(first) + " to " + std::to_string(last) +
                     ", expected " + std::to_string(lowest) + " to " + std::to_string(highest) +
                     " for the limits of the joint: change Min and Max Position Limit(52, 48), or set lower_limit and "
                     "upper_limit");
  }
}

void ServoChain::require_healthy(std::size_t joint) {
  const std::uint32_t status = bus_.read_number(ids_[joint], hardware_error_status);
  if (status != 0) {
    throw ServoError(name_of(joint) + " has a hardware error: " + describe_hardware_error(status) +
                     "; remove the cause, then switch the servo off and on");
  }
}

void ServoChain::read_all_angles() {
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    store(joint, bus_.read(ids_[joint], present_block));
  }
}

void ServoChain::store(std::size_t joint, std::span<const std::uint8_t> block) {
  Reading& reading = readings_[joint];
  const auto position = position_in(block.subspan(position_in_block, present_position.size));
  reading.angle_deg = settings_.servos[joint].angle_of(position);
  reading.current = static_cast<std::int16_t>(number_of(block.subspan(current_in_block, 2)));
  reading.temperature_c = block[temperature_in_block];
}

void ServoChain::switch_on(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  read_all_angles();
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    // A servo rejects goals outside of its position limits, and may rest a little outside.
    const ServoSettings& servo = settings_.servos[joint];
    const double angle = std::clamp(readings_[joint].angle_deg, servo.lower_limit_deg, servo.upper_limit_deg);
    bus_.write(servo.id, goal_position, static_cast<std::uint32_t>(servo.position_of(angle)));
  }
  for (const std::uint8_t id : ids_) {
    bus_.write(id, torque_enable, 1);
    bus_.write(id, bus_watchdog, settings_.watchdog);
  }
}

void ServoChain::switch_off(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  // The first attempt requests no answers, because a servo that does not answer must not delay the others.
  const std::vector<std::uint32_t> zeros(ids_.size());
  bus_.sync_write(torque_enable, ids_, zeros);
  std::string failed;
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    try {
      bus_.write(ids_[joint], torque_enable, 0);
      bus_.write(ids_[joint], bus_watchdog, 0);
    } catch (const ServoError&) {
      failed += (failed.empty() ? "" : ", ") + name_of(joint);
    }
  }
  if (!failed.empty()) {
    throw ServoError(failed + " did not confirm that the power is off; switch the supply of the servos off");
  }
}

void ServoChain::send_goals(std::span<const double> joint_deg, std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  const std::uint64_t start_us = bus_.now_us();
  std::vector<std::uint32_t> positions(ids_.size());
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    const ServoSettings& servo = settings_.servos[joint];
    const double angle = std::clamp(joint_deg[joint], servo.lower_limit_deg, servo.upper_limit_deg);
    positions[joint] = static_cast<std::uint32_t>(servo.position_of(angle));
  }
  bus_.sync_write(goal_position, ids_, positions);
  const std::uint64_t reads_end_us = std::min(deadline_us, start_us + settings_.tick_us * std::uint64_t{9} / 10);
  if (++ticks_ % watchdog_ticks == 0) {
    check_watchdog(reads_end_us);
  } else {
    read_some(reads_end_us);
  }
  if (const auto id = bus_.take_alert()) {
    const std::size_t joint = joint_of(*id);
    if (joint < ids_.size()) {
      require_healthy(joint);
    }
  }
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    if (missed_[joint] >= max_missed) {
      throw ServoError(name_of(joint) + " has not answered " + std::to_string(missed_[joint]) +
                       " times in a row; check its cable and its power");
    }
  }
}

void ServoChain::read_some(std::uint64_t deadline_us) {
  std::vector<std::size_t> joints;
  std::vector<std::uint8_t> ids;
  for (std::size_t i = 0; i < reads_per_tick_; ++i) {
    joints.push_back((next_read_ + i) % ids_.size());
    ids.push_back(ids_[joints.back()]);
  }
  next_read_ = (next_read_ + joints.size()) % ids_.size();
  const auto answers = bus_.sync_read(present_block, ids, deadline_us);
  bool is_first_missing = true;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (answers[i]) {
      missed_[joints[i]] = 0;
      store(joints[i], answers[i]->parameters);
    } else if (std::exchange(is_first_missing, false)) {
      // The servos behind it may have waited for its answer, so only this one has failed. The next read begins with
      // it.
      ++missed_[joints[i]];
      next_read_ = joints[i];
    }
  }
}

void ServoChain::check_watchdog(std::uint64_t deadline_us) {
  const std::size_t joint = std::exchange(next_watchdog_, (next_watchdog_ + 1) % ids_.size());
  const auto answer = bus_.sync_read(bus_watchdog, std::span(ids_).subspan(joint, 1), deadline_us);
  if (answer[0] && answer[0]->parameters[0] == watchdog_has_stopped) {
    throw ServoError(name_of(joint) + " was stopped by its bus watchdog: it received nothing for " +
                     std::to_string(settings_.watchdog * watchdog_unit_ms) +
                     " ms; reduce the load of the computer, or set a longer 'watchdog'");
  }
}

void ServoChain::test(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    static_cast<void>(bus_.ping(ids_[joint]));
    require_healthy(joint);
  }
}

}  // namespace proleg::host
