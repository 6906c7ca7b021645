#pragma once

// Scenarios from XML files, in the format of the thesis (listings B.1, B.2, B.5, B.6) with a few additions. The
// top-level file names the others. A path is relative to the folder of the file that contains it; if there is no such
// file, to the folder of the top-level file:
//
//   <simulation>
//     <robot>caterpillar.robot.xml</robot>                    robot_reader.hpp, kinbody_reader.hpp, joint_reader.hpp,
//                                                             geometry_reader.hpp, mass_reader.hpp, module_reader.hpp
//     <actuation>uniform.actuation.xml</actuation>            actuation_reader.hpp
//     <environment>flat.environment.xml</environment>         environment_reader.hpp
//     <simulationProperties>...</simulationProperties>        properties_reader.hpp; optional
//   </simulation>
//
// The case of tags and attributes does not matter; the case of names does. An unknown tag or attribute is an error that
// lists the known ones. Lengths are metres, masses kilograms, angles degrees unless a tag says otherwise.

#include <cstdint>
#include <filesystem>
#include <string>

#include "shared/fixed/unit.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/scenario/file_source.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Reads a top-level simulation file and all that it names, and applies the overrides. Throws InputError.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& path, FileSource& files,
                                     const Overrides& overrides = {});

/// Applies a `--set` word to a scenario: [MODULE.]NAME[:JOINT]=VALUE[@TICK]
///   MODULE  name of an algorithm, or 1 to 4 for its position in the actuation file; required if several modules that
///           drive the joint have a value of that name
///   NAME    a parameter, or an internal value
///   JOINT   a joint of the robot file; without it all joints of the module
///   VALUE   a decimal number in the declared unit
///   TICK    0 to 2^32 - 1
/// A parameter without a tick gets a new start value; with a tick it changes in flight. An internal value is
/// overwritten (a distortion) at the tick, by default 0. Throws InputError with the word as its file, and then does not
/// change the scenario.
void apply_setting(Scenario& scenario, const std::string& word);

/// The values that a `--set` word changes.
struct SettingTarget {
  unsigned slot = 0;
  bool internal = false;
  unsigned number = 0;     ///< of the parameter or internal value in the declaration
  JointMask joints;        ///< kernel order, at least one
  bool in_flight = false;  ///< as a change at the tick; otherwise a start value
  std::uint32_t tick = 0;  ///< of the change; 0 for a start value
  Unit unit = Unit::count;

  [[nodiscard]] bool same_value(const SettingTarget& other) const {
    return slot == other.slot && internal == other.internal && number == other.number;
  }
};

/// Does not look at the VALUE of the word. Throws InputError as apply_setting() does.
[[nodiscard]] SettingTarget find_target(const Scenario& scenario, const std::string& word);

}  // namespace proleg::sim
