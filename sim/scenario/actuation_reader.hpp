#pragma once

#include <cstdint>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// A <parameter>: a value for one joint of the slot, or for all of them (-1).
struct ParameterEntry {
  unsigned index = 0;  ///< in the declaration
  int joint = -1;      ///< kernel order
  std::int32_t value = 0;
};

/// Reads an actuation file into the kernel configuration and the settings of a scenario, which must have its robot:
///   <actuation>
///     <validRobot robotName="..."/>
///     <actuationModule name="PatternGenerator_sinusoidal">
///       <jointConfiguration joints="10101"/>
///       <parameter name="amplitude" value="40" unit="deg"/>
///       <parameter name="amplitude" value="0" joint="J1"/>
///     </actuationModule>
///   </actuation>
/// Modules get the slots of the kernel in their order. The first character of `joints` is the first joint of the robot
/// FILE. A parameter without `joint` applies to all joints of the module; a parameter with `joint` overrides it, in any
/// order. Values are in the declared unit. Throws InputError for a configuration that the kernel rejects.
void read_actuation(const XmlDocument& document, Scenario& scenario, const std::string& robot_file);

/// The tags of the modules, in the order of the file: slots 0, 1, ...
[[nodiscard]] std::vector<XmlElement> actuation_modules(const XmlDocument& document);

/// The <parameter> tags of a module in the order of the file. The scenario has its robot, and its slot the algorithm
/// and the group.
[[nodiscard]] std::vector<ParameterEntry> read_parameter_entries(const XmlElement& module, const Scenario& scenario,
                                                                 unsigned slot);

}  // namespace proleg::sim
