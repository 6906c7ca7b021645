#include "host/dynamixel/chain_settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string_view>

#include "host/dynamixel/control_table.hpp"
#include "host/dynamixel/line.hpp"
#include "host/dynamixel/packet.hpp"

namespace proleg::host {
namespace {

constexpr std::uint32_t usual_return_delay_us = 500;
/// Time that an adapter with low latency adds to a request: from its last byte to the driver, and back.
constexpr std::uint32_t turnaround_us = 1000;
/// Bytes in front of the ids or values of a packet to several servos.
constexpr std::size_t address_and_size = 4;
constexpr double step_deg = 360.0 / steps_per_turn;

template <typename Number>
std::optional<Number> parse(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty() ? std::optional(value)
                                                                                   : std::nullopt;
}

std::string quoted(std::string_view text) { return "'" + std::string(text.substr(0, 60)) + "'"; }

std::string number_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
}

[[noreturn]] void refuse(const proleg_parameter& parameter, const std::string& expected) {
  throw SettingError(parameter.line, std::string(parameter.name) + " " + quoted(parameter.value), expected);
}

std::uint64_t read_whole(const proleg_parameter& parameter, std::uint64_t min, std::uint64_t max,
                         const std::string& unit) {
  const auto value = parse<std::uint64_t>(parameter.value);
  if (!value || *value < min || *value > max) {
    refuse(parameter, "a whole number from " + std::to_string(min) + " to " + std::to_string(max) + unit);
  }
  return *value;
}

double read_angle(const proleg_parameter& parameter, double min, double max) {
  const auto value = parse<double>(parameter.value);
  if (!value || !(*value >= min && *value <= max)) {
    refuse(parameter, "a number from " + number_text(min) + " to " + number_text(max) + " degrees");
  }
  return *value;
}

void read_device(ChainSettings& settings, const proleg_parameter& parameter) {
  if (*parameter.value == '\0') {
    refuse(parameter, "a serial port such as /dev/ttyUSB0");
  }
  settings.device = parameter.value;
}

void read_rate(ChainSettings& settings, const proleg_parameter& parameter) {
  const auto rate = parse<unsigned>(parameter.value);
  const auto known = serial_rates();
  if (!rate || std::ranges::find(known, *rate) == known.end()) {
    std::string list;
    for (const unsigned one : known) {
      list += (list.empty() ? "" : ", ") + std::to_string(one);
    }
    refuse(parameter, "one of " + list + ", as in Baud Rate(8) of the servos");
  }
  settings.rate = *rate;
}

void read_watchdog(ChainSettings& settings, const proleg_parameter& parameter) {
  const std::uint64_t ms = read_whole(parameter, watchdog_unit_ms, watchdog_unit_ms * max_watchdog, " ms");
  settings.watchdog = static_cast<unsigned>((ms + watchdog_unit_ms - 1) / watchdog_unit_ms);
}

void read_id(ServoSettings& servo, const proleg_parameter& parameter) {
  servo.id = static_cast<std::uint8_t>(read_whole(parameter, 0, max_servo_id, ""));
}

void read_direction(ServoSettings& servo, const proleg_parameter& parameter) {
  const std::string_view text = parameter.value;
  if (text != "1" && text != "-1") {
    refuse(parameter, "1, or -1 if the servo turns the joint the other way");
  }
  servo.is_reversed = text == "-1";
}

void read_offset(ServoSettings& servo, const proleg_parameter& parameter) {
  servo.offset_deg = read_angle(parameter, -180.0, 180.0);
}

void read_lower_limit(ServoSettings& servo, const proleg_parameter& parameter) {
  servo.lower_limit_deg = std::max(servo.lower_limit_deg, read_angle(parameter, -90.0, 0.0));
}

void read_upper_limit(ServoSettings& servo, const proleg_parameter& parameter) {
  servo.upper_limit_deg = std::min(servo.upper_limit_deg, read_angle(parameter, 0.0, 90.0));
}

using ChainReader = void (*)(ChainSettings&, const proleg_parameter&);
using ServoReader = void (*)(ServoSettings&, const proleg_parameter&);

const std::map<std::string_view, ChainReader>& chain_readers() {
  static const std::map<std::string_view, ChainReader> readers{
      {"baud", read_rate}, {"device", read_device}, {"watchdog", read_watchdog}};
  return readers;
}

const std::map<std::string_view, ServoReader>& servo_readers() {
  static const std::map<std::string_view, ServoReader> readers{{"direction", read_direction},
                                                               {"id", read_id},
                                                               {"lower_limit", read_lower_limit},
                                                               {"offset", read_offset},
                                                               {"upper_limit", read_upper_limit}};
  return readers;
}

/// Reads the values for all joints first, so that those of single joints replace them in any order of the file.
void read_servo_parameters(ChainSettings& settings, const proleg_setup& setup, bool of_single_joints) {
  for (const proleg_parameter& parameter : std::span(setup.parameters, setup.parameter_count)) {
    const auto reader = servo_readers().find(parameter.name);
    if (reader == servo_readers().end() || (parameter.joint != PROLEG_ALL_JOINTS) != of_single_joints) {
      continue;
    }
    if (of_single_joints) {
      reader->second(settings.servos[parameter.joint], parameter);
    } else if (std::string_view(parameter.name) == "id") {
      throw SettingError(parameter.line, "an id for all joints",
                         "an attribute 'joint', because each servo has its own");
    } else {
      std::ranges::for_each(settings.servos, [&](ServoSettings& servo) { reader->second(servo, parameter); });
    }
  }
}

void read_chain_parameters(ChainSettings& settings, const proleg_setup& setup) {
  for (const proleg_parameter& parameter : std::span(setup.parameters, setup.parameter_count)) {
    const auto reader = chain_readers().find(parameter.name);
    if (reader == chain_readers().end()) {
      if (!servo_readers().contains(parameter.name)) {
        throw SettingError(parameter.line, "unknown parameter " + quoted(parameter.name),
                           "baud, device, direction, id, lower_limit, offset, upper_limit or watchdog");
      }
      continue;
    }
    if (parameter.joint != PROLEG_ALL_JOINTS) {
      throw SettingError(parameter.line, std::string(parameter.name) + " of one joint", "one for the whole robot");
    }
    reader->second(settings, parameter);
  }
  if (settings.device.empty()) {
    throw SettingError(0, "no parameter 'device'", "a serial port such as /dev/ttyUSB0");
  }
}

void check_servos(const ChainSettings& settings) {
  std::map<unsigned, std::string> joints;
  for (const ServoSettings& servo : settings.servos) {
    const auto [first, is_new] = joints.try_emplace(servo.id, servo.joint);
    if (!is_new) {
      throw SettingError(0,
                         "id " + std::to_string(servo.id) + " for the joints " + first->second + " and " + servo.joint,
                         "another id for each joint");
    }
    for (const double limit : {servo.lower_limit_deg, servo.upper_limit_deg}) {
      const std::int32_t position = servo.position_of(limit);
      if (position < 0 || position >= steps_per_turn) {
        throw SettingError(0,
                           "joint " + servo.joint + " with the limit " + number_text(limit) + " and the offset " +
                               number_text(servo.offset_deg) + " degrees, which is position " +
                               std::to_string(position),
                           "0 to 4095: mount the horn so that the offset is near 0");
      }
    }
  }
}

void check_rate(const ChainSettings& settings) {
  const std::size_t servos = settings.servos.size();
  if (readable_servos(servos, settings.rate, settings.tick_us, usual_return_delay_us) > 0) {
    return;
  }
  const std::span<const unsigned> rates = serial_rates();
  const auto fast = std::ranges::find_if(
      rates, [&](unsigned rate) { return readable_servos(servos, rate, settings.tick_us, usual_return_delay_us) > 0; });
  const std::string advice = fast == rates.end() ? "a longer tick"
                                                 : "at least " + std::to_string(*fast) +
                                                       " baud (Baud Rate(8) of the servos and the parameter 'baud'), "
                                                       "or a longer tick";
  throw SettingError(0,
                     std::to_string(settings.rate) + " baud for " + std::to_string(servos) + " servos in a tick of " +
                         number_text(settings.tick_us / 1000.0) + " ms",
                     advice);
}

}  // namespace

std::int32_t ServoSettings::position_of(double joint_deg) const {
  // Without an offset the result is exact: degrees * 1024 is exact, and the quotient is rounded only if it is not a
  // multiple of 2^-20 steps, as set-points are.
  const double servo_deg = (is_reversed ? -joint_deg : joint_deg) + offset_deg;
  return middle_position + static_cast<std::int32_t>(std::floor(servo_deg * 1024.0 / 90.0 + 0.5));
}

double ServoSettings::angle_of(std::int32_t position) const {
  const double servo_deg = (static_cast<double>(position) - middle_position) * step_deg - offset_deg;
  return is_reversed ? -servo_deg : servo_deg;
}

std::uint32_t line_time_us(std::size_t bytes, unsigned rate) {
  constexpr std::size_t bits_per_byte = 10;
  return static_cast<std::uint32_t>((bytes * bits_per_byte * 1'000'000 + rate - 1) / rate);
}

std::size_t goal_packet_size(std::size_t servos) {
  return packet_overhead + address_and_size + servos * (1 + goal_position.size);
}

std::uint32_t expected_read_time_us(std::size_t servos, unsigned rate, std::uint32_t return_delay_us) {
  const auto count = static_cast<std::uint32_t>(servos);
  return turnaround_us + line_time_us(packet_overhead + address_and_size, rate) +
         count * (return_delay_us + line_time_us(1 + status_overhead + present_block.size, rate));
}

std::size_t readable_servos(std::size_t servos, unsigned rate, std::uint32_t tick_us, std::uint32_t return_delay_us) {
  const std::uint64_t goals_us = line_time_us(goal_packet_size(servos), rate);
  std::size_t count = servos;
  while (count > 0 &&
         goals_us + expected_read_time_us(count, rate, return_delay_us) > tick_time_for_reads_us(tick_us)) {
    --count;
  }
  return count;
}

ChainSettings read_chain_settings(const proleg_setup& setup) {
  ChainSettings settings;
  settings.tick_us = setup.tick_us;
  for (std::uint32_t joint = 0; joint < setup.joint_count; ++joint) {
    const proleg_joint& entry = setup.joints[joint];
    settings.servos.push_back({entry.name, static_cast<std::uint8_t>(joint + 1), false, 0.0, entry.lower_limit_deg,
                               entry.upper_limit_deg, entry.max_speed_deg_s});
  }
  read_chain_parameters(settings, setup);
  read_servo_parameters(settings, setup, false);
  read_servo_parameters(settings, setup, true);
  check_servos(settings);
  check_rate(settings);
  return settings;
}

}  // namespace proleg::host
