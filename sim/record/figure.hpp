#pragma once

#include <string>

#include "sim/record/figure_contents.hpp"
#include "sim/record/recording.hpp"

namespace proleg::sim {

/// Draws a recording as an SVG picture: the robot in a stride (RobotViews), set-points and measured angles of the
/// joints and the contacts of the links in the window, with changes, restarts and losses, and the path of the chain's
/// centre (mean of the positions of its links) over the whole run, from above.
/// Throws InputError if fewer than two ticks lie in the window.
[[nodiscard]] std::string draw_figure(const Recording& recording, const TimeWindow& window);

}  // namespace proleg::sim
