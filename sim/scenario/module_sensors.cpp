#include "sim/scenario/module_sensors.hpp"

#include <array>
#include <string>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::sim {
namespace {

constexpr std::array<std::pair<JointReadings::Sensor, std::string_view>, 3> reading_names{
    {{JointReadings::servo_current, "the current of its servo"},
     {JointReadings::inclination, "the inclination of its link"},
     {JointReadings::acceleration, "the acceleration of its link"}}};

}  // namespace

void require_sensors(const Scenario& scenario, std::uint8_t sensors, std::string_view what) {
  for (const unsigned slot : used_slots(scenario)) {
    const unsigned missing = scenario.kernel.slots[slot].algorithm->senses_readings() & ~unsigned{sensors};
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
