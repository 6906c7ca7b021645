#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/record/axis.hpp"
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
  std::vector<Restart> restarts;     ///< in the order of time
  std::vector<double> loss_times_s;  ///< of ticks in which a state frame did not reach a joint, ascending
  std::size_t losses = 0;            ///< state frames times receivers
};

[[nodiscard]] Disturbances collect_disturbances(const Recording& recording);

/// Restarts as bands behind the lines of a panel, named at its top; losses as marks on its lower edge.
void draw_disturbances(Svg& svg, const Disturbances& disturbances, const Axis& time, double top, double height);

}  // namespace proleg::sim
