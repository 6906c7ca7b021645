#pragma once

#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads an actuation file into the kernel configuration and the settings of a scenario that has its robot already:
///   <actuation>
///     <validRobot robotName="..."/>
///     <actuationModule name="PatternGenerator_sinusoidal">
///       <jointConfiguration joints="10101"/>
///       <parameter name="amplitude" value="40" unit="deg"/>
///       <parameter name="amplitude" value="0" joint="J1"/>
///     </actuationModule>
///   </actuation>
/// Modules take the slots of the kernel in their order. The first character of `joints` is the first joint of the robot
/// FILE. A parameter without `joint` holds for all joints of the module; with one it holds for that joint, wherever it
/// stands. Values are in the declared unit. A configuration that the kernel refuses is an InputError.
void read_actuation(const XmlDocument& document, Scenario& scenario, const std::string& robot_file);

}  // namespace proleg::sim
