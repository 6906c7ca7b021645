#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/robot/bounds.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads a <Geom>: box (<extents>: half sides), sphere (<radius>) or cylinder (<radius>, <height>; axis along y), with
/// its pose in the body and its <friction>.
[[nodiscard]] Geometry read_geometry(const XmlElement& element);

/// What <Mass> may use of the solids of a body. The overlap of two solids counts twice.
struct SolidProperties {
  double volume = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   ///< of volume, in the frame of the body
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre, at density 1
};

[[nodiscard]] SolidProperties solid_properties(const std::vector<Geometry>& geometries);

/// Inertia about the centre of a box with these half sides and mass 1.
[[nodiscard]] Eigen::Matrix3d box_inertia(const Eigen::Vector3d& half_sides);

}  // namespace proleg::sim
