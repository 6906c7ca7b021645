#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace proleg::sim {

/// Signals of one length, a sample of each at every tick. The outer span is by ticks, then by signals: sample
/// `tick * signals + i` is that of signal i.
struct SignalTable {
  std::span<const double> samples;
  std::size_t signals = 0;

  [[nodiscard]] std::size_t ticks() const { return signals == 0 ? 0 : samples.size() / signals; }
  [[nodiscard]] double at(std::size_t tick, std::size_t signal) const { return samples[tick * signals + signal]; }
};

/// The cycle that signals repeat, as often as they do.
struct Stride {
  double frequency = 0.0;      ///< Hz, mean
  std::size_t first_tick = 0;  ///< of a whole number of strides, rounded to ticks
  std::size_t end_tick = 0;    ///< one past the last
  std::vector<double> bounds;  ///< in ticks: where a stride starts and the one before ends; at least two
};

/// Finds the strides in the angles (rad) that a robot's joints are to take. They are taken from the signal with the
/// largest standard deviation: from one upward crossing of its mean to the next, a crossing being one only if the
/// signal was well below the mean before; the times of crossings are interpolated. The first stride is left out if
/// there are others, as a robot starts from rest. Nothing if there is not one whole stride, or no signal that would be
/// a sine of half a degree.
[[nodiscard]] std::optional<Stride> find_stride(const SignalTable& angles, double tick_s);

/// mean + amplitude * sin(2 pi s + phase), s: strides since the first one began.
struct Oscillation {
  double mean = 0.0;
  double amplitude = 0.0;  ///< not negative
  double phase = 0.0;      ///< rad, -pi to pi
};

/// The part of each signal that repeats with the strides: projected on a sine and a cosine that each stride has one
/// period of, so that a gait that changes its pace does not blur it.
[[nodiscard]] std::vector<Oscillation> find_oscillations(const SignalTable& signals, const Stride& stride);

}  // namespace proleg::sim
