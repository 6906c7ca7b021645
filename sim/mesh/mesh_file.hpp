#pragma once

#include <string>
#include <string_view>

#include "sim/mesh/import_process.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// The endings of files that read_mesh_file() reads, for messages: STL, Wavefront OBJ, COLLADA, OFF.
inline constexpr std::string_view mesh_file_endings = ".stl, .obj, .dae or .off";

/// Whether a file has one of these endings, in any case.
[[nodiscard]] bool is_mesh_file_name(std::string_view name);

/// Reads a mesh with the Open Asset Import Library (Assimp). All parts of the file become one mesh, in the coordinates
/// of the file, or in metres if the file states a unit. Colours are those of its vertices or materials.
///
/// The library runs in a child of this process, which a damaged file can end (sim/mesh/import_process.hpp).
///
/// name: of the file; its ending says the format. bytes: of the file. companion: is called in this process.
///
/// Throws MeshError for a file that Assimp cannot read, at which it ends or needs too much memory or time, without
/// triangles, with more than max_triangles or max_mesh_vertices, or with a number that is not finite; and what
/// `companion` throws.
[[nodiscard]] TriangleMesh read_mesh_file(const std::string& name, const std::string& bytes,
                                          const MeshCompanion& companion);

/// Reads a mesh as read_mesh_file() does, but in this process: a damaged file can end it. For fuzz tests.
[[nodiscard]] TriangleMesh import_mesh(const std::string& name, const std::string& bytes,
                                       const MeshCompanion& companion);

}  // namespace proleg::sim
