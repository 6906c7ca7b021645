#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/robot/module_place.hpp"
#include "sim/robot/robot_control_entry.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/source_set.hpp"

namespace proleg::sim {

struct RobotDescription {
  RobotModel model;
  std::vector<AngleLimits> kernel_limits;          ///< kernel order
  std::vector<ModulePlace> modules;                ///< kernel order
  std::optional<RobotControlEntry> robot_control;  ///< the plug-in of a robot without modules
  std::vector<std::string> warnings;               ///< what is probably not meant
};

/// Reads a robot file: <Robot> with KinBodies and joints as in OpenRAVE, and our
///   <servo><gain>50</gain><period unit="ms">1</period><latency unit="ms">0</latency></servo>
/// (gain in 1/s; what is missing is as in ServoModel), the modules (module_reader.hpp), the
/// plug-in (robot_control_reader.hpp) and the sensors (sensor_reader.hpp). Adds the joint map to the remarks. step_s:
/// of the physics; bounds the gain.
[[nodiscard]] RobotDescription read_robot(const XmlDocument& document, double step_s, SourceSet& sources,
                                          std::vector<std::string>& remarks);

}  // namespace proleg::sim
