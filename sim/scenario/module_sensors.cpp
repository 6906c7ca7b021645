#include "sim/scenario/module_sensors.hpp"

#include <array>
#include <string>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

constexpr std::array<std::pair<JointReadings::Sensor, std::string_view>, 4> reading_names{
    {{JointReadings::servo_current, "the current of its servo"},
     {JointReadings::inclination, "the inclination of its link"},
     {JointReadings::acceleration, "the acceleration of its link"},
     {JointReadings::angle_of_joint, "the angle of its joint"}}};

/// The sensors that a slot needs: bits of JointReadings::Sensor.
unsigned sensors_needed_by(const Scenario& scenario, unsigned slot) {
  const ActuationModule& algorithm = *scenario.kernel.slots[slot].algorithm;
  const HostRules rules = algorithm.declaration().rules;
  if (rules == nullptr) {
    return algorithm.senses_readings();
  }
  unsigned needed = 0;
  visit_parameter_values(scenario, slot, [&](unsigned /*joint*/, const auto& values) {
    needed |= rules->required_readings(values.data());
  });
  return needed;
}

}  // namespace

void require_sensors(const Scenario& scenario, std::uint8_t sensors, std::string_view what) {
  for (const unsigned slot : used_slots(scenario)) {
    const unsigned missing = sensors_needed_by(scenario, slot) & ~unsigned{sensors};
    for (const auto& [sensor, name] : reading_names) {
      if ((missing & sensor) != 0) {
        std::string has = "touch";
        for (const auto& [other, other_name] : reading_names) {
          has += (sensors & other) != 0 ? " and " + std::string(other_name) : "";
        }
        throw InputError(scenario.actuation_file, 0, slot_name(scenario, slot) + ", which reads " + std::string(name),
                         "an algorithm that reads what " + std::string(what) + " measures: " + has +
                             " (proleg simulate has all sensors)");
      }
    }
  }
}

}  // namespace proleg::sim
