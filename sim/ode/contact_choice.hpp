#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <span>

namespace proleg::sim {

/// Points that the engine may report for two shapes of which one is a mesh. A point of a corner that several triangles
/// share comes once for each of them, and a flat side has points all over it.
inline constexpr std::size_t max_mesh_points = 192;

/// Keeps the points that hold a body as all of them would: the deepest, then again and again the one farthest from
/// those that are kept. Of points at the same place only the deepest counts. The kept ones come to the front; returns
/// their number, at most `most`.
[[nodiscard]] std::size_t choose_contacts(std::span<dContactGeom> points, std::size_t most);

}  // namespace proleg::sim
