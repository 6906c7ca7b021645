#pragma once

// Reads what a <Body> consists of: its <Geom>s and its <Mass>.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/bounds.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// What a body is: it decides which shapes its <Geom>s may have.
enum class BodyKind : std::uint8_t {
  moving,  ///< a link of a robot or an object that moves: a triangle mesh becomes a convex solid
  fixed,   ///< a static object: a triangle mesh stays as it is; height fields
};

/// What a <Geom> gives a body.
struct ReadGeometry {
  std::optional<Geometry> solid;  ///< nothing: the body only looks like that, and touches nothing with it
  std::optional<Look> look;
};

/// Reads a <Geom>, with its pose in the body and its <friction>: box (<extents>: half sides), sphere (<radius>),
/// cylinder (<radius>, <height>; axis along y), trimesh (mesh_reader.hpp; <data> or <collision> from a file, or
/// <vertices> and <triangles>) or heightfield. <render> names a mesh that is shown in its place.
[[nodiscard]] ReadGeometry read_geometry(const XmlElement& element, BodyKind kind, SourceSet& sources,
                                         std::vector<std::string>& remarks);

/// Reads a <Mass>. Its types:
///   custom     <total>; <com>, by default the centre of the body's geometries; <inertia>, nine numbers row by row,
///              about the centre of mass, by default of the geometries at uniform density scaled to the total
///   box, sphere, cylinder   <total> or <density>, the size as in a <Geom>, <com> (by default the body's origin)
///   mimicgeom  <total> or <density>; all else from the geometries
/// Throws InputError for a mass outside 1e-6 to 1e4 kg and for an inertia that is not
/// symmetric and clearly positive definite.
[[nodiscard]] MassProperties read_mass(const XmlElement& element, const std::vector<Geometry>& geometries);

}  // namespace proleg::sim
