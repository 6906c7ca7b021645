#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Part of a run, in seconds from its start; by default the last three strides.
struct TimeWindow {
  std::optional<double> from_s;
  std::optional<double> to_s;
};

/// What a figure shows, read from the recording in one pass. Angles and positions are limited to +-10^9, so that the
/// picture has finite coordinates even if the simulation became unstable.
struct FigureContents {
  double from_s = 0.0;
  double to_s = 0.0;
  double tick_s = 0.0;
  std::uint32_t first_tick = 0;  ///< in the window
  std::uint32_t last_tick = 0;
  std::vector<Polyline> setpoints;  ///< per joint; x: s, y: degrees
  std::vector<Polyline> angles;
  struct Press {
    double from_s;
    double to_s;
  };
  std::vector<std::array<std::vector<Press>, 2>> presses;  ///< per link: of the rear and the front sensor
  std::vector<Polyline> sensors;  ///< of each attached sensor all quantities (quantities_of); x: s
  Polyline path;                  ///< x, y of the centre after each tick of the run, in m
  double path_from_s = 0.0;       ///< when the path begins
  Polyline first_chain;           ///< x, y of the ends of the links, head to tail
  Polyline last_chain;
};

/// robot: for the ends of the links; without it their chain consists of their positions. Throws InputError if fewer
/// than two ticks lie in the window.
[[nodiscard]] FigureContents collect_figure_contents(const Recording& recording, const TimeWindow& window,
                                                     const RobotModel* robot = nullptr);

}  // namespace proleg::sim
