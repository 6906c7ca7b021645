#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/record/figure_contents.hpp"
#include "sim/record/outline.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The robot at one moment.
struct Snapshot {
  double time_s;
  std::vector<Pose> link_poses;
  std::vector<std::uint8_t> contacts;  ///< per link: bit 0 rear, bit 1 front sensor
  std::vector<Pose> object_poses;      ///< of the objects that move; empty: they were not simulated
};

/// The robot in a row of cells, one for each moment of a stride: seen from its side, or from above.
struct RobotView {
  std::string heading;
  View view;
  bool from_above;
  double pixels_per_m;
  Point half_size;  ///< of what a cell shows, in m
  double center_y;  ///< seen from the side: height that is in the middle of the cells, in m
  std::size_t columns;
  double top;     ///< of the cells, in pixels
  double height;  ///< of all rows, in pixels
};

/// The views of a figure with the snapshots that they show.
struct RobotViews {
  std::vector<Snapshot> snapshots;
  std::vector<RobotView> views;
  double bottom;  ///< of the last view, in pixels; `top` if there are none
};

/// The last stride of the window, or its last second if the joints do not swing. From the side; also from above if the
/// robot has joints that bend it sideways, or if it does not go where it points. There are no views of a robot that the
/// simulation has torn apart.
[[nodiscard]] RobotViews make_robot_views(const Recording& recording, const FigureContents& contents,
                                          const Scenario& scenario, double top);

void draw_robot_views(Svg& svg, const Scenario& scenario, const RobotViews& views);

}  // namespace proleg::sim
