#pragma once

// Exchanges the modules that a robot of a draft is made of.

#include <cstddef>
#include <span>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/module_kind.hpp"

namespace proleg::sim {

/// Makes links modules of a kind: the file of each becomes that of the kind, in a folder beside the robot's file, and
/// the links in front of it move by the difference in length. Joints keep their axes and servos. links: counted from
/// the tail, in ascending order; none: all. Throws InputError for a chain of another form than read_chain_text() takes,
/// and for joints in the frame of the link behind them, whose anchors would not follow.
void set_kind_of_links(DraftChange& change, const ModuleKind& kind, std::span<const std::size_t> links);

}  // namespace proleg::sim
