#pragma once

// The robot file of a chain from a URDF file.

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/urdf/mesh_places.hpp"
#include "sim/urdf/urdf_chain.hpp"

namespace proleg::sim {

inline constexpr double default_joint_speed = 4.5;  ///< rad/s, of the servos of the shipped robots

/// A text of which each part came from a line of another file.
class TracedText {
 public:
  void add(const std::string& text, int line) {
    origins_.emplace(next_line_, line);
    next_line_ += static_cast<int>(std::ranges::count(text, '\n'));
    text_ += text;
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The line of the other file that a line of this text came from; 0: none.
  [[nodiscard]] int origin_of(int line) const {
    const auto next = origins_.upper_bound(line);
    return next == origins_.begin() ? 0 : std::prev(next)->second;
  }

 private:
  std::string text_;
  int next_line_ = 1;
  std::map<int, int> origins_;
};

/// What the text of a robot needs beside its chain.
struct RobotTextOptions {
  double density = 0.0;  ///< kg/m^3, of bodies without <inertial>
  double torque = 0.0;   ///< Nm, of joints that have none
};

struct RobotText {
  TracedText text;                 ///< each line with its line in the URDF file
  std::vector<std::string> notes;  ///< what was chosen, one line each
  std::vector<std::string> lost;   ///< what Proleg has not, one line each
};

/// Writes robot.robot.xml. source: name of the URDF file. Throws InputError for a mesh that touches and cannot, for a
/// mass out of range, for an inertia that no body has, and for a link without mass and geometry.
[[nodiscard]] RobotText write_robot_text(const UrdfRobot& robot, const UrdfChain& chain, const std::string& source,
                                         const RobotTextOptions& options, ImportedMeshes& meshes);

}  // namespace proleg::sim
