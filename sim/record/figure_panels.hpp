#pragma once

// The panels of a figure (figure.hpp): the robot in a stride, attached sensors, lost frames, touch sensors, angles of
// the joints, and the path.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/record/figure_contents.hpp"
#include "sim/record/marks.hpp"
#include "sim/record/outline.hpp"
#include "sim/record/plot_frame.hpp"
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

/// Height of the panel of the touch sensors, in pixels.
[[nodiscard]] double contact_panel_height(const Recording& recording);

/// The touch sensors of each link over time, below `top`.
void draw_contact_panel(Svg& svg, const Recording& recording, const FigureContents& contents, double top,
                        const Axis& time);

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
  /// The trace in pixels, without points that lie too close together to be seen.
  [[nodiscard]] Polyline pixels(const Polyline& trace) const;
};

/// The panel below `top`, in pixels, of a size in which the path and the chain at both its ends have room.
[[nodiscard]] PathPanel make_path_panel(const FigureContents& contents, double top);

void draw_path(Svg& svg, const Recording& recording, const FigureContents& contents, const PathPanel& panel);

}  // namespace proleg::sim
