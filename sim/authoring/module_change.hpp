#pragma once

// Exchanges the modules that a robot of a draft is made of.

#include <cstddef>
#include <optional>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_kinds.hpp"

namespace proleg::sim {

/// Makes a link, or all links, a module of a kind: its file becomes that of the kind, in a folder beside the robot's
/// file, and the links in front of it move by the difference in length. Joints keep their axes and servos. link:
/// counted from the tail; nothing: all. Throws InputError for a chain of another form than read_chain_text() takes, and
/// for joints in the frame of the link behind them, whose anchors would not follow.
void set_kind_of_links(DraftChange& change, const RobotKind& kind, std::optional<std::size_t> link);

}  // namespace proleg::sim
