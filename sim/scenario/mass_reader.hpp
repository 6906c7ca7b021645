#pragma once

#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Reads a <Mass>. Its types:
///   custom     <total>; <com>, by default the centre of the body's geometries; <inertia>, nine numbers row by row,
///              about the centre of mass, by default of the geometries at uniform density scaled to the total
///   box        <total> or <density>, <extents> (half sides), <com> (by default the body's origin)
///   mimicgeom  <total> or <density>; all else from the geometries
/// Throws InputError for a mass outside 1e-6 to 1e4 kg and for an inertia that is not
/// symmetric and clearly positive definite.
[[nodiscard]] MassProperties read_mass(const XmlElement& element, const std::vector<Geometry>& geometries);

}  // namespace proleg::sim
