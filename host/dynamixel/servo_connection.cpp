// What a chain does when it connects: finds the servos and prepares them. Nothing has power then.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/dynamixel/servo_chain.hpp"

namespace proleg::host {
namespace {

constexpr unsigned return_delay_unit_us = 2;
constexpr std::uint32_t search_time_us = 300'000;

std::string in_ms(std::uint64_t time_us) {
  const std::uint64_t tenths = (time_us + 50) / 100;
  return std::to_string(tenths / 10) + (tenths % 10 == 0 ? "" : "." + std::to_string(tenths % 10));
}

std::string listed(std::span<const std::uint8_t> ids) {
  std::string text;
  for (const std::uint8_t id : ids) {
    text += (text.empty() ? "" : ", ") + std::to_string(id);
  }
  return text.empty() ? "no servo answers" : "servos that answer: " + text;
}

}  // namespace

void ServoChain::connect(std::uint64_t deadline_us) {
  bus_.set_deadline(deadline_us);
  is_connected_ = false;
  has_power_ = false;
  return_delay_us_ = 0;
  find_all();
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    take_power(joint);
  }
  choose_reads_per_tick();
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    prepare(joint);
  }
  read_all_angles();
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    count_answer(joint);
  }
  next_joints_.fill(0);
  ticks_ = 0;
  is_connected_ = true;
}

void ServoChain::find_all() {
  for (std::size_t joint = 0; joint < ids_.size(); ++joint) {
    unsigned model = 0;
    try {
      model = bus_.ping_one(ids_[joint]);
    } catch (const ServoError& error) {
      if (error.what_it_does().empty()) {
        throw;
      }
      const std::vector<std::uint8_t> found = bus_.find_servos(search_time_us);
      if (error.what_it_does() == ServoBus::no_answer && std::ranges::find(found, ids_[joint]) != found.end()) {
        throw ServoError(name_of(joint) + " " + error.what_it_does() + " within " + in_ms(answer_timeout_us) +
                         " ms, but has answered later; check its cable, or " + latency_advice(settings_.device));
      }
      throw ServoError(name_of(joint) + " " + error.what_it_does() + " on " + settings_.device + " at " +
                       std::to_string(settings_.rate) + " baud (" + listed(found) +
                       "); check cable, power, id and Baud Rate(8)");
    }
    if (!has_this_table(model)) {
      throw ServoError(name_of(joint) + " has the model number " + std::to_string(model) +
                       ", expected one of the X series or MX(2.0)");
    }
  }
}

void ServoChain::take_power(std::size_t joint) {
  const std::uint8_t id = ids_[joint];
  // At a lower status return level a servo does not answer the following requests.
  bus_.write_unconfirmed(id, status_return_level, 2);
  bus_.write(id, torque_enable, 0);
  require_healthy(joint);
  bus_.write(id, bus_watchdog, 0);
  // Two servos that answer at the same time give the same bits to a ping, but damage each other's angle.
  static_cast<void>(read(joint, present_block));
  return_delay_us_ = std::max(return_delay_us_, bus_.read_number(id, return_delay_time) * return_delay_unit_us);
}

/// Chooses how many servos are read in a tick: as many as the line allows, if their answers come in time.
void ServoChain::choose_reads_per_tick() {
  const std::uint64_t goals_us = line_time_us(goal_packet_size(ids_.size()), settings_.rate);
  const std::uint64_t room_us = tick_time_for_reads_us(settings_.tick_us) - goals_us;
  std::size_t count =
      std::max<std::size_t>(1, readable_servos(ids_.size(), settings_.rate, settings_.tick_us, return_delay_us_));
  for (;;) {
    const std::uint64_t expected_us = expected_read_time_us(count, settings_.rate, return_delay_us_);
    const std::uint64_t time_us = measure_read(count);
    // An unexpected delay varies. There is time for twice of it, or for a quarter more if only one servo is read.
    const std::uint64_t unexpected_us = std::max(time_us, expected_us) - expected_us;
    const std::uint64_t needed_us = time_us + (count == 1 ? unexpected_us / 4 : unexpected_us);
    if (needed_us <= room_us) {
      break;
    }
    if (count == 1) {
      throw ServoError("answers take " + in_ms(time_us) + " ms, a tick of " + in_ms(settings_.tick_us) +
                       " ms has time for " + in_ms((4 * room_us + expected_us) / 5) +
                       " ms: " + latency_advice(settings_.device));
    }
    count = std::clamp<std::size_t>(count * room_us / needed_us, 1, count - 1);
  }
  reads_per_tick_ = count;
}

/// The time in us in which this number of servos is usually read, if the host is not delayed by other programs.
std::uint64_t ServoChain::measure_read(std::size_t count) {
  std::array<std::uint64_t, 9> times{};
  for (std::uint64_t& time : times) {
    const std::uint64_t start_us = bus_.now_us();
    const std::uint64_t end_us =
        start_us + expected_read_time_us(count, settings_.rate, return_delay_us_) + answer_timeout_us;
    const auto answers = bus_.sync_read(present_block, std::span(ids_).first(count), end_us);
    time = bus_.now_us() - start_us;
    if (std::ranges::any_of(answers, [](const auto& answer) { return !answer; })) {
      bus_.drain();
    }
  }
  std::ranges::sort(times);
  return times[times.size() / 4];
}

void ServoChain::prepare(std::size_t joint) {
  const std::uint8_t id = ids_[joint];
  prepare_modes(joint);
  check_position_limits(joint);
  bus_.write(id, profile_acceleration, 0);
  const double velocity = std::floor(settings_.servos[joint].max_speed_deg_s / profile_velocity_unit_deg_s);
  bus_.write(id, profile_velocity, static_cast<std::uint32_t>(std::clamp(velocity, 1.0, 32'767.0)));
  watched_[joint].min_voltage = bus_.read_number(id, min_voltage_limit);
}

void ServoChain::prepare_modes(std::size_t joint) {
  // These items are in the EEPROM, which wears out: they are written only if they are wrong.
  const std::uint8_t id = ids_[joint];
  const std::array<std::pair<TableItem, std::uint8_t>, 2> wanted{
      {{operating_mode, position_control_mode}, {drive_mode, 0}}};
  for (const auto& [item, value] : wanted) {
    std::uint32_t found = bus_.read_number(id, item);
    if (found != value) {
      found = bus_.read_number_of_one(id, item);
    }
    if (found != value) {
      bus_.write(id, item, value);
      show_(name_of(joint) + ": " + (item.address == drive_mode.address ? "Drive Mode(10)" : "Operating Mode(11)") +
            " was " + std::to_string(found) + ", is " + std::to_string(value) + " now");
    }
  }
}

void ServoChain::check_position_limits(std::size_t joint) {
  const ServoSettings& servo = settings_.servos[joint];
  const std::vector<std::uint8_t> limits = read(joint, position_limits);
  const auto last = signed_number_of(std::span(limits).first(4));
  const auto first = signed_number_of(std::span(limits).last(4));
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

}  // namespace proleg::host
