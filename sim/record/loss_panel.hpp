#pragma once

#include <cstdint>
#include <vector>

#include "sim/record/axis.hpp"
#include "sim/record/disturbance_marks.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

inline constexpr double loss_panel_height = 40.0;  // pixels

/// State frames that joints should have received in a tick and, of these, lost ones; a frame counts once for each
/// joint.
struct LossShares {
  struct Bar {
    std::uint32_t first_tick;
    std::uint32_t end_tick;  ///< the first one after the bar
    double share;            ///< 0 to 1, of the frames in these ticks
  };
  std::vector<Bar> bars;  ///< without those of 0
  std::uint32_t ticks_of_bar = 1;
  double share = 0.0;  ///< of all frames in the window
};

/// The losses in the window of the time axis, in bars that are wide enough to be seen.
[[nodiscard]] LossShares collect_loss_shares(const Recording& recording, const Disturbances& disturbances,
                                             const Axis& time);

/// Bars over time below `top`: the height of a bar is the share of the state frames that were lost.
void draw_loss_panel(Svg& svg, const Recording& recording, const Disturbances& disturbances, double top,
                     const Axis& time);

}  // namespace proleg::sim
