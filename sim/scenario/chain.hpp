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
  std::vector<AngleLimits> kernel_limits;
  std::vector<Origin> link_origins;
  std::vector<Origin> joint_origins;
  std::vector<bool> headward_first;       ///< by joint: whether its file lists the link towards the head first
  std::vector<bool> is_in_frame_of_link;  ///< by joint: whether its file gives it in the frame of one of its links
  std::string joint_map;                  ///< for the user: "joints from the head, ...: J5 (Head - 4Seg), ..."
};

/// Orders the bodies and joints of a robot file from head to tail. The head is the end of the chain whose name ends
/// with "Head", in any case; if there is none, the end that is last in the file. If a joint names the link towards the
/// head first, its axis is reversed, so that an angle is always the rotation of that link relative to the other. Throws
/// InputError for a robot that is not one unbranched chain of 1 to 64 joints.
[[nodiscard]] Chain make_chain(const KinBodyContents& contents, const Origin& robot);

}  // namespace proleg::sim
