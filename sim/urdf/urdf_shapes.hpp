#pragma once

// Reads the <visual>s and <collision>s of a URDF file.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/pose.hpp"
#include "sim/urdf/urdf_check.hpp"

namespace proleg::sim {

/// The <geometry> of a <visual> or a <collision>.
struct UrdfShape {
  enum class Kind : std::uint8_t { box, sphere, cylinder, mesh };
  Kind kind = Kind::box;
  Pose pose;  ///< in the frame of the link
  /// box: the sides; sphere: the radius in x; cylinder: the radius in x, the length along z in y; mesh: its scale.
  Eigen::Vector3d size = Eigen::Vector3d::Ones();
  std::string mesh;                       ///< file name or URL, as it is written
  std::optional<Eigen::Vector3d> colour;  ///< red, green, blue: 0 to 1
  int line = 0;                           ///< of the <visual> or <collision>
};

/// The solids of a <collision> or <visual>: one, or none if it has no volume, or the three that a capsule consists of.
/// Throws InputError for what is no such shape.
[[nodiscard]] std::vector<UrdfShape> urdf_shapes(const XmlElement& element, UrdfRemarks& remarks);

/// Those of a <visual> with their colour.
[[nodiscard]] std::vector<UrdfShape> urdf_looks(const XmlElement& visual, const UrdfElements& elements,
                                                UrdfRemarks& remarks);

}  // namespace proleg::sim
