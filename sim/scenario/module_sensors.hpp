#pragma once

#include <cstdint>
#include <string_view>

#include "shared/gait/joint_readings.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What a joint module measures, beside its touch sensors (docs/board.md): bits of JointReadings::Sensor.
inline constexpr std::uint8_t sensors_of_modules = JointReadings::servo_current;

/// Throws InputError if an algorithm of the scenario needs a sensor that is not among these bits, with its start values
/// or after a change. what: who has them, e.g. "a module".
void require_sensors(const Scenario& scenario, std::uint8_t sensors, std::string_view what);

}  // namespace proleg::sim
