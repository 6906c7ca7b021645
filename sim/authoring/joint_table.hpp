#pragma once

// The values of several joints of a draft as one change, as a table has them.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"

namespace proleg::sim {

/// New values of a joint; what is missing stays.
struct JointRow {
  unsigned joint = 0;  ///< kernel order, from the head
  std::optional<std::string> name;
  std::optional<Eigen::Vector3d> axis;              ///< as in RobotChange::set_axis()
  std::optional<std::pair<double, double>> limits;  ///< degrees, the lower one first
  std::optional<double> torque;                     ///< Nm
  std::optional<double> speed;                      ///< rad/s
};

/// Sets the values of joints. Names may be exchanged. Throws InputError, and names the joint and the value, if the
/// reader refuses the result; also for a joint that does not exist, is there twice, or cannot be edited.
void set_joint_table(DraftChange& change, const std::vector<JointRow>& rows);

}  // namespace proleg::sim
