#pragma once

// Runs the import of a mesh in a process of its own. Assimp trusts the numbers of a file while it reads: a damaged file
// can end its process, or make it take all memory or all time.

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "sim/robot/triangle_mesh.hpp"

namespace proleg::sim {

/// More triangles than any simulation of a link or an obstacle needs.
inline constexpr std::size_t max_triangles = 100'000;

/// Number of corners of max_triangles triangles that share none. Of more vertices, some would belong to no triangle.
inline constexpr std::size_t max_mesh_vertices = 3 * max_triangles;

/// Gives the bytes of a file beside a mesh file, such as the materials of an OBJ file, or nothing.
using MeshCompanion = std::function<std::optional<std::string>(const std::string& name)>;

/// What the import of one file may use.
struct ImportLimits {
  std::size_t memory_gib = 2;          ///< beyond what this process has
  std::chrono::seconds processor{30};  ///< time of the processor
  std::chrono::milliseconds wall{60'000};
  std::size_t companions = 1000;  ///< files beside the mesh
};

/// Calls `import` in a child of this process, and returns its mesh. The child's stderr is not seen, except under
/// AddressSanitizer. No child and no open file is left, also after an exception.
///
/// A lock that another thread holds at the fork() stays locked in the child. A child that sleeps for about a second is
/// therefore ended and replaced, up to three times: `companion` may be called again for the same files.
///
/// name: of the file, for messages. companion: is called in this process, each time that `import` calls the function
/// that it gets; an exception of it ends the child and reaches the caller.
///
/// Throws the MeshError of `import`, and MeshError for a child that ends without a mesh or exceeds a limit, and for a
/// mesh with more than max_triangles or max_mesh_vertices, or with numbers that are not valid.
[[nodiscard]] TriangleMesh import_in_child(const std::string& name, const MeshCompanion& companion,
                                           const std::function<TriangleMesh(const MeshCompanion& companion)>& import,
                                           const ImportLimits& limits = {});

}  // namespace proleg::sim
