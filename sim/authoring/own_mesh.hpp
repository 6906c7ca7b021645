#pragma once

// Meshes that a person brings along: the files as they come, what can be said about them before they are used, and
// their way into a draft.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/authoring/draft.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// A file that is not on disk: its name, without a folder, and its bytes.
struct NamedBytes {
  std::string name;
  std::string bytes;
};

/// What can be said about a mesh before anybody knows the length of its unit.
struct MeshFacts {
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero();  ///< corner of the box around it, in its unit
  Eigen::Vector3d highest = Eigen::Vector3d::Zero();
  /// Why the surface is not closed; nothing: it is.
  std::optional<std::string> gap;
  /// Why it cannot be a static object, closed or not; nothing: it can.
  std::optional<std::string> flaw;
  /// Volume of its convex hull, in its unit; nothing: its points lie in a plane, so that no link can have it.
  std::optional<double> hull_volume;
  /// Sum of normal times area over its triangles: where a sheet faces, mostly.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
};

/// A mesh and the files that it needs, such as the materials of an OBJ file.
struct OwnMesh {
  std::vector<NamedBytes> files;  ///< the mesh, then those that it names
  TriangleMesh mesh;              ///< in the unit of the file, of a COLLADA file with a unit in m
  MeshFacts facts;
};

/// Throws InputError for names that no file of a scenario may have (a folder, a beginning with ".", control
/// characters), for an ending of no mesh, for two meshes, and for a file beside the mesh that is no ".mtl" file.
/// Returns the position of the mesh.
[[nodiscard]] std::size_t require_mesh_files(const std::vector<std::string>& names);

/// Reads a mesh, as the reader of scenarios does. It takes up to half a minute. Throws InputError for files of other
/// names than require_mesh_files() takes and for a mesh that the reader would refuse with any scale.
[[nodiscard]] OwnMesh read_own_mesh(std::vector<NamedBytes> files);

/// How a mesh is used.
struct MeshFit {
  double factor = 1.0;  ///< metres of its unit
  /// Turns of 90 degrees about x, then y, then z, of the frame that does not turn.
  std::array<unsigned, 3> quarter_turns{};
  Eigen::Vector3d colour{0.6, 0.5, 0.4};  ///< of a mesh without colours: red, green, blue, 0 to 1

  [[nodiscard]] Eigen::Quaterniond rotation() const;
};

/// Throws InputError for a factor, turns or a colour out of range.
void require_fit(const MeshFit& fit);

/// The box around a mesh after its scale and rotation, in m.
struct FittedBox {
  Eigen::Vector3d lowest;
  Eigen::Vector3d highest;
};
[[nodiscard]] FittedBox fitted_box(const MeshFacts& facts, const MeshFit& fit);

/// The lines of <Geom type="trimesh"> that give a mesh its pose, file, scale and colour. file: as the element names it.
[[nodiscard]] std::string mesh_lines(const std::string& file, const MeshFit& fit, const Eigen::Vector3d& translation);

/// Adds files to a draft in a folder of `parent` that has no other files of these names: `folder`, or with a number
/// behind it. Files that are there as they are stay. Returns the name of the folder.
[[nodiscard]] std::string add_in_free_folder(DraftChange& change, const std::filesystem::path& parent,
                                             const std::string& folder, std::span<const SourceFile> files);

/// The files of a mesh as texts of a draft.
[[nodiscard]] std::vector<SourceFile> source_files(const OwnMesh& mesh);

}  // namespace proleg::sim
