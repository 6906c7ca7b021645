#pragma once

// Meshes and height fields of a <Geom>.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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

/// A text that names a file: its path, and what is behind it. Both are parts of the text.
struct FileText {
  std::string_view path;
  std::string_view rest;
};

/// Splits the text of an element that names a mesh: a path, which may be in quotes, then nothing, a scale, or three of
/// them for x, y and z. The path may have blanks: it is the longest beginning that is a file. Without such a file it is
/// what is before the last numbers, at most three.
[[nodiscard]] FileText split_file_text(std::string_view text,
                                       const std::function<bool(const std::string& path)>& is_file);

/// The path of the mesh that an element names.
[[nodiscard]] std::string mesh_file_named_by(const XmlElement& element, SourceSet& sources);

/// A mesh from the file that the element names.
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
