#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace proleg::sim {

/// Signals of one length, with one sample of each at each tick. Sample `tick * signals + i` belongs to signal i.
struct SignalTable {
  std::span<const double> samples;
  std::size_t signals = 0;

  [[nodiscard]] std::size_t ticks() const { return signals == 0 ? 0 : samples.size() / signals; }
  [[nodiscard]] double at(std::size_t tick, std::size_t signal) const { return samples[tick * signals + signal]; }
};

/// The strides in a table of signals: repetitions of one cycle.
struct Stride {
  double frequency = 0.0;      ///< mean frequency, Hz
  std::size_t first_tick = 0;  ///< first tick of a whole number of strides, rounded to ticks
  std::size_t end_tick = 0;    ///< one past their last tick
  std::vector<double> bounds;  ///< start of each stride and end of the last one, in ticks; at least two
};

/// Finds the strides in the target angles (rad) of a robot's joints, by the signal with the largest standard deviation.
/// A stride lasts from one upward crossing of the signal's mean to the next. A crossing counts only if the signal was
/// well below the mean before; its time is interpolated. The first stride is left out if there are others, because a
/// robot starts from rest. Returns nothing without a whole stride, or if all signals are smaller than a sine of half a
/// degree.
[[nodiscard]] std::optional<Stride> find_stride(const SignalTable& angles, double tick_s);

}  // namespace proleg::sim
