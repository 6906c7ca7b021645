#pragma once

#include <vector>

namespace proleg::sim {

/// Maps a range of values to a range of pixels, linearly.
struct Axis {
  double low = 0.0;
  double high = 1.0;        ///< above low
  double pixel_low = 0.0;   ///< where `low` is
  double pixel_high = 1.0;  ///< where `high` is; below pixel_low for an axis that points upwards

  [[nodiscard]] double pixel(double value) const {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
};

/// Smallest of ..., 0.1, 0.2, 0.5, 1, 2, 5, ... that is at least `min`, which is above 0.
[[nodiscard]] double nice_step(double min);

/// Multiples of `step` from low to high.
[[nodiscard]] std::vector<double> multiples(double low, double high, double step);

/// Moves positions apart until neighbours have a distance of `gap` or more, within low to high if there is room. Keeps
/// their order; they need not be sorted.
[[nodiscard]] std::vector<double> spread(std::vector<double> positions, double gap, double low, double high);

}  // namespace proleg::sim
