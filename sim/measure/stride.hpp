#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace proleg::sim {

/// Signals of one length, one sample of each at every tick. Sample `tick * signals + i` is that of signal i.
struct SignalTable {
  std::span<const double> samples;
  std::size_t signals = 0;

  [[nodiscard]] std::size_t ticks() const { return signals == 0 ? 0 : samples.size() / signals; }
  [[nodiscard]] double at(std::size_t tick, std::size_t signal) const { return samples[tick * signals + signal]; }
};

/// The strides in a table of signals: the cycle that the signals repeat.
struct Stride {
  double frequency = 0.0;      ///< Hz, mean
  std::size_t first_tick = 0;  ///< of a whole number of strides, rounded to ticks
  std::size_t end_tick = 0;    ///< one past the last
  std::vector<double> bounds;  ///< in ticks: the start of each stride and the end of the last one; at least two
};

/// Finds the strides in the target angles (rad) of a robot's joints, by the signal with the largest standard deviation.
/// A stride lasts from one upward crossing of the signal's mean to the next. A crossing counts only if the signal was
/// well below the mean before; its time is interpolated. The first stride is left out if there are others, because a
/// robot starts from rest. Returns nothing without a whole stride, or if all signals are smaller than a sine of half a
/// degree.
[[nodiscard]] std::optional<Stride> find_stride(const SignalTable& angles, double tick_s);

}  // namespace proleg::sim
