#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/record/plot_frame.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// What disturbed a run, for the figure.
struct Disturbances {
  /// The module of a joint did not compute.
  struct Restart {
    std::string joint;
    double from_s;
    std::optional<double> to_s;  ///< nothing: until the end
  };
  /// State frames that did not reach a joint; a frame counts once for each joint.
  struct TickLosses {
    std::uint32_t tick;
    std::uint32_t frames;
  };
  /// Something was made to fail.
  struct FaultMark {
    std::string text;
    double from_s;
    std::optional<double> to_s;  ///< nothing: it happens once, or lasts to the end
  };
  std::vector<FaultMark> faults;          ///< in the order of time
  std::vector<Restart> restarts;          ///< in the order of time
  std::vector<TickLosses> lost_in_ticks;  ///< ascending, without ticks that lost none
};

[[nodiscard]] Disturbances collect_disturbances(const Recording& recording);

/// Faults as bands from their start to their end behind the lines of a panel; one that has no end is a line.
void draw_faults(Svg& svg, const Disturbances& disturbances, const Axis& time, double top, double height);
/// The texts of the faults at their starts, one below the other.
void draw_fault_texts(Svg& svg, const Disturbances& disturbances, const Axis& time, double top);

/// Restarts as bands behind the lines of a panel, named at its lower edge.
void draw_restarts(Svg& svg, const Disturbances& disturbances, const Axis& time, double top, double height);

/// A change during a run, for the figure.
struct ChangeMark {
  double time_s;     ///< of the SYNC at which it took effect
  std::string text;  ///< "frequency = 0.5", "current_phase J3 = 180", "amplitude J2 = 10, +3"
};

/// Commits and distortions, in the order of time, one mark for each tick.
[[nodiscard]] std::vector<ChangeMark> collect_change_marks(const Recording& recording);

}  // namespace proleg::sim
