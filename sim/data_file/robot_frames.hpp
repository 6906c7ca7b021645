#pragma once

// The frames of a data file with the touch sensors and the motion of a robot.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/data_file/data_frame_text.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Joints and links of a recording in the order of the robot's file.
struct FileOrder {
  explicit FileOrder(const Recording& recording);
  std::vector<std::uint32_t> joints;
  /// The links, from the tail if the file lists the joint at the tail before that at the head.
  std::vector<std::uint32_t> links;
};

/// `tactile`: two sensors of each link, the rear one first, then the touch sensors that the robot's file attaches, with
/// the direction in which the ground pushes.
class TactileFrames {
 public:
  TactileFrames(const Recording& recording, const FileOrder& order);
  [[nodiscard]] DataModuleText& text() { return text_; }
  void add(const RecordedTick& tick);

 private:
  const FileOrder& order_;
  std::vector<std::size_t> attached_;  ///< indices of the attached sensors' first values in RecordedTick::sensor_values
  DataModuleText text_;
};

/// `robot_data`: poses, speeds and energies of the links; angles, currents and speeds of the joints.
class RobotFrames {
 public:
  RobotFrames(const Recording& recording, const FileOrder& order, const std::optional<Scenario>& scenario);
  [[nodiscard]] DataModuleText& text() { return text_; }
  void add(const RecordedTick& tick);

 private:
  void add_links(const RecordedTick& tick, const std::vector<Eigen::Vector3d>& centers);
  void add_joints(const RecordedTick& tick);

  const FileOrder& order_;
  const std::optional<Scenario>& scenario_;
  double tick_s_;
  DataModuleText text_;
  // State at the tick before; empty before the first tick.
  std::vector<Eigen::Vector3d> centers_;
  std::vector<double> angles_;
  Eigen::Vector3d first_center_ = Eigen::Vector3d::Zero();
  std::uint32_t first_tick_ = 0;
};

}  // namespace proleg::sim
