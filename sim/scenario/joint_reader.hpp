#pragma once

// Reads the OpenRAVE tag <Joint>.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// The contents of a <Joint>, with names as in the file.
struct JointDescription {
  Joint joint;  ///< anchor and axis in the frame of `offset_from`
  std::array<std::string, 2> bodies;
  std::optional<std::string> offset_from;
  AngleLimits kernel_limits;
};

/// Reads a <Joint type="hinge">: two <body>, <axis>, <anchor> (0 0 0 by default), <offsetfrom>, limits, <maxtorque>
/// (Nm), greatest speed. The model keeps limits beyond +-90 degrees; the kernel gets +-90 degrees, and a remark says
/// so.
[[nodiscard]] JointDescription read_joint(const XmlElement& element, std::vector<std::string>& remarks);

}  // namespace proleg::sim
