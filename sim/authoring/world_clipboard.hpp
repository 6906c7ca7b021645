#pragma once

// Objects of a world as text, to put them into the same world again or into another one.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/world_contents.hpp"

namespace proleg::sim {

/// A text of objects has at most so many bytes, so that an operation has room for it.
inline constexpr std::size_t max_copied_bytes = std::size_t{48} << 10U;

/// The elements of objects as the environment file has them, without comments. An object of a group has its whole
/// group with it. Throws InputError for an object that does not exist or is in a file of its own, and if the text is
/// too long.
[[nodiscard]] std::string copied_objects(const Draft& draft, const std::vector<std::size_t>& objects);

/// Adds the objects of a text from copied_objects(), or from anywhere. They stand where the text has them; if objects
/// of the world stand there, they are moved by `step` (m) until none does. Throws InputError for a text that has more
/// than objects, is too long, or names a file that the draft does not have; the reader judges the rest.
void paste_objects(const WorldContents& world, DraftChange& change, std::string_view text, const Eigen::Vector3d& step);

}  // namespace proleg::sim
