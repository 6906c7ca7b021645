#pragma once

#include <string>
#include <vector>

#include "sim/record/recording.hpp"

namespace proleg::sim {

/// A change during a run, for the figure.
struct ChangeMark {
  double time_s;     ///< of the SYNC at which it took effect
  std::string text;  ///< "frequency = 0.5", "current_phase J3 = 180", "amplitude J2 = 10, +3"
};

/// Commits and distortions, in the order of time, one mark for each tick.
[[nodiscard]] std::vector<ChangeMark> collect_change_marks(const Recording& recording);

}  // namespace proleg::sim
