#pragma once

#include <string>
#include <vector>

#include "sim/record/axis.hpp"
#include "sim/record/figure_contents.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// What the sensors of one kind measured over time, the first seven quantities of them.
struct SensorPanel {
  struct Line {
    std::string name;
    const Polyline* values;  ///< in FigureContents
  };
  std::string heading;
  std::vector<Line> lines;
  bool is_of_switches = false;  ///< values are 0 and 1
  double top = 0.0;             ///< pixels
  double height = 0.0;          ///< pixels
};

/// A panel for each kind of sensor that the recording has, one below the other from `top` on. contents: must outlive
/// the panels.
[[nodiscard]] std::vector<SensorPanel> make_sensor_panels(const Recording& recording, const FigureContents& contents,
                                                          double top, double between);

void draw_sensors(Svg& svg, const SensorPanel& panel, const Axis& time);

}  // namespace proleg::sim
