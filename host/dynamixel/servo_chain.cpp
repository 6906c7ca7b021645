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
/// The same if its late answers show that it has power and a cable: the adapter or the host was delayed.
constexpr unsigned max_late = 10;
/// Period in ticks at which something else than angles is read.
constexpr std::uint32_t state_ticks = 4;

std::string in_tenths(std::uint64_t tenths) { return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10); }

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

}  // namespace

ServoChain::ServoChain(Line& line, ChainSettings settings, Show show)
    : settings_(std::move(settings)),
      show_(std::move(show)),
      bus_(line, settings_.rate),
      readings_(settings_.servos.size()),
      watched_(settings_.servos.size()) {
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

std::vector<std::uint8_t> ServoChain::read(std::size_t joint, TableItem item) {
  try {
    return bus_.read(ids_[joint], item);
  } catch (const ServoError& error) {
    throw ServoError(name_of(joint) + " " + error.what_it_does());
  }
}

void ServoChain::require_healthy(std::size_t joint) {
  require_healthy(joint, read(joint, torque_block)[hardware_error_in_block]);
}

void ServoChain::require_healthy(std::size_t joint, std::uint8_t hardware_error) const {
  if (hardware_error != 0) {
    throw ServoError(name_of(joint) + " has a hardware error: " + describe_hardware_error(hardware_error) +
                     "; remove the cause, then switch the servo off and on");
  }
}

void ServoChain::read_all_angles() {
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    store(joint, read(joint, present_block));
  }
}

void ServoChain::store(std::size_t joint, std::span<const std::uint8_t> block) {
  Reading& reading = readings_[joint];
  const auto position = signed_number_of(block.subspan(position_in_block, present_position.size));
  require_one_turn(joint, position);
  reading.angle_deg = settings_.servos[joint].angle_of(position);
  reading.current = static_cast<std::int16_t>(number_of(block.subspan(current_in_block, 2)));
  if (block.size() == present_block.size) {
    reading.temperature_c = block[temperature_in_block];
    check_voltage(joint, number_of(block.subspan(voltage_in_block, 2)));
  }
  if (has_power_) {
    check_movement(joint, position);
  }
}

void ServoChain::require_one_turn(std::size_t joint, std::int32_t position) {
  // A load may turn a servo a little beyond the ends of its turn.
  constexpr std::int32_t tolerance = steps_per_turn / 8;
  if (position >= -tolerance && position < steps_per_turn + tolerance) {
    return;
  }
  const auto homing = signed_number_of(read(joint, homing_offset));
  throw ServoError(name_of(joint) + " is at position " + std::to_string(position) + ", expected 0 to " +
                   std::to_string(steps_per_turn - 1) + "; its Homing Offset(20) is " + std::to_string(homing) +
                   (homing == 0 ? ", so the joint was turned by more than one revolution: turn it back, or switch the "
                                  "servo off and on"
                                : ": set it to 0, or turn the joint back"));
}

void ServoChain::check_voltage(std::size_t joint, std::uint32_t voltage) {
  std::uint32_t& min_voltage = watched_[joint].min_voltage;
  if (voltage < min_voltage) {
    show_(name_of(joint) + " has " + in_tenths(voltage) + " V, expected at least the " + in_tenths(min_voltage) +
          " V of its Min Voltage Limit(34); charge the battery, or use a stronger supply");
    min_voltage = 0;  // it is shown once
  }
}

void ServoChain::check_movement(std::size_t joint, std::int32_t position) {
  Watched& watched = watched_[joint];
  if (const auto report = watched.standstill.add(position, watched.goal, bus_.now_us())) {
    const auto difference_tenths = static_cast<std::uint64_t>(report->max_difference * 3600 / steps_per_turn);
    show_(name_of(joint) + " has power, but has stood still for " + in_tenths(report->time_us / 100'000) +
          " s, up to " + in_tenths(difference_tenths) +
          " degrees from its goal; free the joint, or check its gear and its load");
  }
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
  std::ranges::for_each(watched_, [](Watched& watched) { watched.standstill.reset(); });
  has_power_ = true;
}

void ServoChain::switch_off(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  has_power_ = false;
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
    watched_[joint].goal = servo.position_of(angle);
    positions[joint] = static_cast<std::uint32_t>(watched_[joint].goal);
  }
  bus_.sync_write(goal_position, ids_, positions);
  read_some(std::min(deadline_us, start_us + tick_time_for_reads_us(settings_.tick_us)));
  if (const auto id = bus_.take_alert()) {
    const std::size_t joint = joint_of(*id);
    if (joint < ids_.size()) {
      require_healthy(joint);
    }
  }
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    require_answers(joint);
  }
}

void ServoChain::count_answer(std::size_t joint) {
  watched_[joint].missed = 0;
  watched_[joint].useless = bus_.useless_answers(ids_[joint]);
  watched_[joint].damaged = bus_.damaged_answers();
}

void ServoChain::require_answers(std::size_t joint) const {
  const Watched& watched = watched_[joint];
  if (watched.missed < max_missed) {
    return;
  }
  const std::string times = std::to_string(watched.missed) + " times in a row";
  const ServoBus::UselessAnswers& useless = bus_.useless_answers(ids_[joint]);
  const std::uint32_t late = useless.late - watched.useless.late;
  const std::uint32_t damaged = bus_.damaged_answers() - watched.damaged;
  if (late != 0 && watched.missed < max_late) {
    return;
  }
  if (late != 0) {
    throw ServoError(name_of(joint) + " has not answered in its tick " + times + ", but " + std::to_string(late) +
                     " late answers were received; " + latency_advice(settings_.device));
  }
  if (useless.rejecting != watched.useless.rejecting) {
    throw ServoError(name_of(joint) + " rejects reads with " + describe_error_number(useless.error) + ", " + times +
                     "; check its cable and the ground of the line");
  }
  if (damaged != 0) {
    throw ServoError(name_of(joint) + " has not answered " + times + ", and " + std::to_string(damaged) +
                     " damaged answers were received; check its cable and the ground of the line");
  }
  throw ServoError(name_of(joint) + " has not answered " + times + "; check its cable and its power");
}

ServoChain::TickRead ServoChain::next_tick_read() {
  // No read is longer than that of present_block, for which there is time in each tick.
  static constexpr std::array<TickRead, 4> reads{{{present_block, &ServoChain::store},
                                                  {torque_block, &ServoChain::check_torque},
                                                  {bus_watchdog, &ServoChain::check_watchdog},
                                                  {mode_block, &ServoChain::check_modes}}};
  // A servo that restarts loses its torque, so torque is read most often.
  static constexpr std::array<std::size_t, 8> states{1, 2, 1, 0, 1, 2, 1, 3};
  const std::uint32_t tick = ticks_++;
  if (!has_power_ || tick % state_ticks != 0) {
    // The sizes differ from tick to tick, so a late answer is not taken for one to the next request.
    const auto size = static_cast<std::uint16_t>(angle_block.size + tick % state_ticks);
    return {{angle_block.address, size}, &ServoChain::store, 0};
  }
  const std::size_t state = states[tick / state_ticks % states.size()];
  return {reads[state].item, reads[state].take, 1 + state};
}

void ServoChain::read_some(std::uint64_t deadline_us) {
  const TickRead read = next_tick_read();
  std::size_t& next = next_joints_[read.order];
  std::vector<std::size_t> joints;
  std::vector<std::uint8_t> ids;
  for (std::size_t i = 0; i < reads_per_tick_; ++i) {
    joints.push_back((next + i) % ids_.size());
    ids.push_back(ids_[joints.back()]);
  }
  next = (next + joints.size()) % ids_.size();
  const auto answers = bus_.sync_read(read.item, ids, deadline_us);
  const auto first_missing = std::ranges::find_if(answers, [](const auto& answer) { return !answer; });
  if (first_missing != answers.end()) {
    // The servos behind it may have waited for its answer, so only this one has failed. The next read begins with it.
    next = joints[static_cast<std::size_t>(first_missing - answers.begin())];
    ++watched_[next].missed;
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (answers[i]) {
      count_answer(joints[i]);
      (this->*read.take)(joints[i], answers[i]->parameters);
    }
  }
}

void ServoChain::check_torque(std::size_t joint, std::span<const std::uint8_t> block) {
  require_healthy(joint, block[hardware_error_in_block]);
  if (block[torque_in_block] == 0) {
    const unsigned watchdog = read(joint, bus_watchdog)[0];
    throw ServoError(name_of(joint) + " has lost its torque: " +
                     (watchdog == 0 ? "it has restarted, its Bus Watchdog(98) is 0; check its supply and its cable"
                                    : "another program has set Torque Enable(64) to 0; end that program"));
  }
}

void ServoChain::check_watchdog(std::size_t joint, std::span<const std::uint8_t> value) {
  const unsigned found = value[0];
  if (found == watchdog_has_stopped) {
    throw ServoError(name_of(joint) + " was stopped by its bus watchdog: it received nothing for " +
                     std::to_string(settings_.watchdog * watchdog_unit_ms) +
                     " ms; reduce the load of the computer, or set a longer 'watchdog'");
  }
  if (found != settings_.watchdog) {
    check_torque(joint, read(joint, torque_block));
    throw ServoError(name_of(joint) + " has the Bus Watchdog(98) " + std::to_string(found) + ", expected " +
                     std::to_string(settings_.watchdog) +
                     ": it has restarted, or another program has changed it; check its supply, end that program");
  }
}

void ServoChain::check_modes(std::size_t joint, std::span<const std::uint8_t> block) {
  const auto require = [&](const char* item, unsigned found, unsigned expected) {
    if (found != expected) {
      throw ServoError(name_of(joint) + " has the " + item + " " + std::to_string(found) + ", expected " +
                       std::to_string(expected) + ": another program has changed it; end that program");
    }
  };
  require("Operating Mode(11)", block[1], position_control_mode);
  require("Drive Mode(10)", block[0], 0);
}

void ServoChain::test(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    static_cast<void>(bus_.ping(ids_[joint]));
    require_healthy(joint);
  }
}

}  // namespace proleg::host
