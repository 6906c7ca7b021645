#pragma once

#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/kinbody_reader.hpp"

namespace proleg::sim {

/// A robot's links and joints in kernel order.
struct Chain {
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<JointLimits> kernel_limits;
  std::string joint_map;  ///< "joint map: kernel 0 = J5 (Head - 4Seg), ..."
};

/// Orders what a robot file declares from head to tail. The head is the end of the chain whose name is or ends with
/// "Head", in any case; without one the end that comes last in the file. An axis is turned round if its joint names
/// the link towards the head first, so that an angle is always the rotation of that link relative to the other.
/// Refuses robots that are not one unbranched chain of 1 to 64 joints.
[[nodiscard]] Chain make_chain(const KinBodyContents& contents, const Origin& robot);

}  // namespace proleg::sim
