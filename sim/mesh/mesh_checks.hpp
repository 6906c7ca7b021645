#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// A mesh that cannot be used. The caller adds where it is named.
class MeshError : public std::runtime_error {
 public:
  MeshError(std::string found_text, std::string expected_text)
      : std::runtime_error(found_text), found(std::move(found_text)), expected(std::move(expected_text)) {}

  std::string found;
  std::string expected;
};

/// Checks that turn into one MeshError each. They are about a mesh in metres, after its scale.

/// The longest side of the box around the mesh is from least to most, in m. The message says by which factor lengths in
/// another usual unit would differ.
void require_size(const TriangleMesh& mesh, double least, double most);

/// No triangle without area. Numbers of triangles in messages count from 1.
void require_area(const TriangleMesh& mesh);

/// The surface is closed: each edge of a triangle is the edge of one other triangle, which runs through it in the other
/// direction. Vertices at the same place count as one.
void require_closed(const TriangleMesh& mesh);

/// The mesh without the triangles that have no area. Throws MeshError if none remains.
[[nodiscard]] TriangleMesh without_slivers(TriangleMesh mesh);

}  // namespace proleg::sim
