#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// An actuation file names algorithms that this program does not have: users' ones that were not loaded, or typing
/// errors.
class UnknownAlgorithms : public InputError {
 public:
  /// place: of the first of them.
  UnknownAlgorithms(const InputError& place, std::vector<std::string> names)
      : InputError(place), names_(std::move(names)) {}
  /// All of them in the file, each once, in its order.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
};

/// A <parameter> tag: a setting for one joint, or for all joints of the slot.
struct ParameterTag {
  Setting setting;
  bool is_for_all = true;  ///< the joint of the setting is then not used
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
/// order. Values are in the declared unit. Throws InputError for a configuration that the kernel rejects,
/// UnknownAlgorithms.
void read_actuation(const XmlDocument& document, Scenario& scenario, const std::string& robot_file);

/// The tags of the modules, in the order of the file: slots 0, 1, ...
[[nodiscard]] std::vector<XmlElement> actuation_modules(const XmlDocument& document);

/// The <parameter> tags of a module in the order of the file. The scenario has its robot, and its slot the algorithm
/// and the group.
[[nodiscard]] std::vector<ParameterTag> read_parameter_tags(const XmlElement& module, const Scenario& scenario,
                                                            unsigned slot);

}  // namespace proleg::sim
