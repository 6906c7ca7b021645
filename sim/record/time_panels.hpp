#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/record/figure_contents.hpp"
#include "sim/record/marks.hpp"
#include "sim/record/plot_frame.hpp"
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

inline constexpr double loss_panel_height = 40.0;  // pixels

/// State frames that joints should have received in a tick and, of these, lost ones; a frame counts once for each
/// joint.
struct LossShares {
  struct Bar {
    std::uint32_t first_tick;
    std::uint32_t end_tick;  ///< the first one after the bar
    double share;            ///< 0 to 1, of the frames in these ticks
  };
  std::vector<Bar> bars;  ///< without bars whose share is 0
  std::uint32_t ticks_of_bar = 1;
  double share = 0.0;  ///< of all frames in the window
};

/// The losses in the window of the time axis, in bars that are wide enough to be seen.
[[nodiscard]] LossShares collect_loss_shares(const Recording& recording, const Disturbances& disturbances,
                                             const Axis& time);

/// Bars over time below `top`: the height of a bar is the share of the state frames that were lost.
void draw_loss_panel(Svg& svg, const Recording& recording, const Disturbances& disturbances, double top,
                     const Axis& time);

/// Height of the panel of the touch sensors [pixels].
[[nodiscard]] double contact_panel_height(const Recording& recording);

/// The touch sensors of each link over time, below `top`.
void draw_contact_panel(Svg& svg, const Recording& recording, const FigureContents& contents, double top,
                        const Axis& time);

}  // namespace proleg::sim
