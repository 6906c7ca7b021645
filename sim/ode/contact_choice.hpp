#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <span>

namespace proleg::sim {

/// Most points that the engine may report for two shapes of which one is a mesh. It reports a corner that several
/// triangles share once for each of them, and a flat side has points all over it.
inline constexpr std::size_t max_mesh_points = 192;

/// Keeps points that hold a body as all of them would: the deepest, then repeatedly the one farthest from the kept
/// ones. Of points at the same place only the deepest counts. Moves the kept points to the front and returns their
/// number, at most `most`.
[[nodiscard]] std::size_t choose_contacts(std::span<dContactGeom> points, std::size_t most);

}  // namespace proleg::sim
