#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/record/figure_contents.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// The angles of some joints over time. Up to seven joints are lines, set-point and measured angle; more are rows of a
/// map, whose colours are the measured angles.
struct AnglePanel {
  std::string heading;
  std::vector<std::size_t> joints;  ///< from the head
  double top;                       ///< pixels
  double height;
};

/// The panel below `top`. what: of the heading, e.g. "Joint angles".
[[nodiscard]] AnglePanel make_angle_panel(std::string what, std::vector<std::size_t> joints, double top);

void draw_angles(Svg& svg, const Recording& recording, const FigureContents& contents, const AnglePanel& panel,
                 const Axis& time);

}  // namespace proleg::sim
