#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/bounds.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/source_set.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// What a body is: it decides which shapes its <Geom>s may have.
enum class BodyKind : std::uint8_t {
  moving,  ///< a link of a robot or an object that moves: a triangle mesh becomes a convex solid
  fixed,   ///< a static object: a triangle mesh stays as it is; height fields
};

/// What a <Geom> gives a body.
struct ReadGeometry {
  std::optional<Geometry> solid;  ///< nothing: only for the eye
  std::optional<Look> look;
};

/// Reads a <Geom>, with its pose in the body and its <friction>: box (<extents>: half sides), sphere (<radius>),
/// cylinder (<radius>, <height>; axis along y), trimesh (mesh_reader.hpp; <data> or <collision> from a file, or
/// <vertices> and <triangles>) or heightfield. <render> names a mesh that is shown in its place.
[[nodiscard]] ReadGeometry read_geometry(const XmlElement& element, BodyKind kind, SourceSet& sources,
                                         std::vector<std::string>& remarks);

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
