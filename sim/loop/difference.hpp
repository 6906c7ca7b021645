#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "sim/robot/servo_pulse.hpp"

namespace proleg::sim {

/// A value that is not what the gait in memory makes of the same inputs.
struct Difference {
  enum class Kind : std::uint8_t {
    setpoint,
    servo_command,
    last_servo_command,  ///< as recorded beside the set-point
    internal_value,
    missed_tick,  ///< a module was gone at its end, and the run had not stopped it; no found and expected value
  };
  Kind kind;
  std::uint32_t tick;
  std::uint32_t joint;                   ///< kernel order
  std::optional<std::int32_t> found;     ///< nothing: it is missing
  std::optional<std::int32_t> expected;  ///< nothing: it should not be there
};

using DifferenceNote = std::function<void(const Difference&)>;

/// Calls note for every joint whose set-points differ.
void compare_setpoints(std::uint32_t tick, std::span<const std::int32_t> found, std::span<const std::int32_t> expected,
                       const DifferenceNote& note);

/// The same for pulses, which are in the order of time, then of joints; one that only one side has differs, too.
void compare_pulses(std::uint32_t tick, std::span<const ServoPulse> found, std::span<const ServoPulse> expected,
                    const DifferenceNote& note);

/// "set-point of J3 at tick 120: found 149130808 (12.5 deg), expected ..."
[[nodiscard]] std::string describe(const Difference& difference, const std::string& joint_name);

}  // namespace proleg::sim
