#pragma once

// The frames of a data file with the touch sensors and the motion of a robot, and their text: it is made module by
// module, while the frames come tick by tick.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A module of the header, and its frames since the last round.
class DataModuleText {
 public:
  /// names: names of the parts. joint_names: names for types with a number for each joint; empty if there is no such
  /// type.
  DataModuleText(const std::string& name, std::vector<std::string> types, const std::vector<std::string>& names,
                 const std::vector<std::string>& joint_names = {});

  /// The module's element in <header>.
  [[nodiscard]] std::string header() const;

  void begin_frame(std::uint32_t index, double realtime_ms, double simtime_ms);
  /// Adds the numbers of the next type, in the order of the types.
  void add(std::span<const double> numbers);
  void end_frame() { frames_ += "      </frame>\n"; }

  /// Returns the module's element in <round> and removes the frames.
  [[nodiscard]] std::string finish_round();

 private:
  std::string name_;
  std::vector<std::string> types_;
  std::string names_;
  std::string joint_names_;
  std::size_t parts_;
  std::size_t next_type_ = 0;
  std::string frames_;
};

/// A text as a tag or as a name in a list: characters that these cannot contain become '_'.
[[nodiscard]] std::string tag_name(std::string_view text);
[[nodiscard]] std::string list_name(std::string_view text);

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
