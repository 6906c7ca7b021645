#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// The endings of files that read_mesh_file() reads, for messages: STL, Wavefront OBJ, COLLADA, OFF.
inline constexpr std::string_view mesh_file_endings = ".stl, .obj, .dae or .off";

/// Whether a file has one of these endings, in any case.
[[nodiscard]] bool is_mesh_file_name(std::string_view name);

/// More triangles than any simulation of a link or an obstacle needs.
inline constexpr std::size_t max_triangles = 100'000;

/// Reads a mesh with the Open Asset Import Library (Assimp). All parts of the file become one mesh, in the coordinates
/// of the file, or in metres if the file states a unit. Colours are those of its vertices or materials.
///
/// name: of the file; its ending says the format. bytes: of the file. companion: gives the bytes of a file beside it,
/// such as the materials of an OBJ file, or nothing.
///
/// Throws MeshError for a file that Assimp cannot read, without triangles, with more than max_triangles, or with a
/// number that is not finite.
[[nodiscard]] TriangleMesh read_mesh_file(
    const std::string& name, const std::string& bytes,
    const std::function<std::optional<std::string>(const std::string& name)>& companion);

}  // namespace proleg::sim
