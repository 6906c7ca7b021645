#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "sim/robot/servo.hpp"

namespace proleg::sim {

/// A value that differs from that of the gait in memory with the same inputs.
struct Difference {
  enum class Kind : std::uint8_t {
    setpoint,
    servo_command,
    last_servo_command,  ///< as recorded beside the set-point
    internal_value,
    late_servo_command,  ///< the servo acted on it a tick later than the gait in memory demands; found is the command
    missed_tick,         ///< a module did not finish it, and the run had not stopped it; no found and expected value
  };
  Kind kind;
  std::uint32_t tick;
  std::uint32_t joint;                   ///< kernel order
  std::optional<std::int32_t> found;     ///< nothing: the value is missing
  std::optional<std::int32_t> expected;  ///< nothing: there must be no value
};

using DifferenceNote = std::function<void(const Difference&)>;

/// Calls note for every joint whose set-points differ.
void compare_setpoints(std::uint32_t tick, std::span<const std::int32_t> found, std::span<const std::int32_t> expected,
                       const DifferenceNote& note);

/// Calls note for every pulse that differs or that only one side has. Pulses: in the order of time, then of joints.
void compare_pulses(std::uint32_t tick, std::span<const ServoPulse> found, std::span<const ServoPulse> expected,
                    const DifferenceNote& note);

/// "set-point of J3 at tick 120: found 149130808 (12.5 deg), expected ..."
[[nodiscard]] std::string describe(const Difference& difference, const std::string& joint_name);

}  // namespace proleg::sim
