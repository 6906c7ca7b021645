#pragma once

#include "sim/record/axis.hpp"
#include "sim/record/figure_contents.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// In pixels.
[[nodiscard]] double contact_panel_height(const Recording& recording);

/// The touch sensors of each link over time, below `top`.
void draw_contact_panel(Svg& svg, const Recording& recording, const FigureContents& contents, double top,
                        const Axis& time);

}  // namespace proleg::sim
