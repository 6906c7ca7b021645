#pragma once

#include "sim/record/figure_contents.hpp"
#include "sim/record/plot_frame.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// Which way the world is turned on the page: the longer way of the robot lies across it.
struct PathView {
  bool turned = false;  ///< y to the right and x down, instead of x to the right and y up
  [[nodiscard]] Point across(Point world) const { return turned ? Point{world.y, -world.x} : world; }
};

/// The panel in which one metre is as long across as upwards.
struct PathPanel {
  PathView view;
  Axis x;
  Axis y;
  double top;
  double height;

  [[nodiscard]] Point pixel(Point world) const {
    const Point p = view.across(world);
    return {x.pixel(p.x), y.pixel(p.y)};
  }
  /// Without points that lie too close together to be seen.
  [[nodiscard]] Polyline pixels(const Polyline& trace) const;
};

/// The panel below `top`, in pixels, of a size in which the path and the chain at both its ends have room.
[[nodiscard]] PathPanel make_path_panel(const FigureContents& contents, double top);

void draw_path(Svg& svg, const Recording& recording, const FigureContents& contents, const PathPanel& panel);

}  // namespace proleg::sim
