#pragma once

// Meshes and height fields of a <Geom>.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::sim {

/// What a mesh is for: it decides its checks.
enum class MeshUse : std::uint8_t {
  hull,     ///< contact of a link or a body that moves: its convex hull
  surface,  ///< contact of a static object: as it is
  look,     ///< for the eye
};

/// A mesh from a file: the text of the element is the path of the file, then nothing, a scale, or three of them for x,
/// y and z.
[[nodiscard]] std::shared_ptr<const TriangleMesh> read_mesh_of_file(const XmlElement& element, MeshUse use,
                                                                    bool is_open, SourceSet& sources,
                                                                    std::vector<std::string>& remarks);

/// A mesh from <vertices> (x y z of each, in m) and, optionally, <triangles> (three numbers of vertices of each, from
/// 0); without <triangles> each three vertices are one. element: the <Geom> that has them.
[[nodiscard]] std::shared_ptr<const TriangleMesh> read_mesh_of_text(const XmlElement& element, MeshUse use,
                                                                    bool is_open, std::vector<std::string>& remarks);

/// A <Geom type="heightfield">: <extents> x y (half sides), <columns>, <rows>, and <heights> or the file of <data>.
void read_height_field(const XmlElement& element, SourceSet& sources, Geometry& geometry);

/// A copy of a mesh without colours, in one colour; the same copy for the same mesh and colour.
[[nodiscard]] std::shared_ptr<const TriangleMesh> painted(const std::shared_ptr<const TriangleMesh>& mesh,
                                                          const Eigen::Vector3f& colour, SourceSet& sources);

}  // namespace proleg::sim
