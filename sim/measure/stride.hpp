#pragma once

// The strides of a gait, the wave that it sends along the body, and its step without slip (thesis, equations 2.14 and
// 3.2). SI units, angles in radians.

#include <cmath>
#include <cstddef>
#include <numbers>
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

/// Number of body waves, for a phase difference between neighbouring joints (equation 2.14). count: number of joints,
/// as in the examples of the thesis, or of segments (one more), as in its text.
[[nodiscard]] inline double wave_count(double phase_difference, double count) {
  return std::abs(phase_difference) * count / (2.0 * std::numbers::pi);
}

/// The maximum angle of a link to the robot's direction of travel, when its joints swing by an amplitude: links that
/// follow a serpenoid curve (S. Hirose, "Biologically Inspired Robots", 1993) have the headings
/// winding_angle * cos(w t - l * phase_difference), and a joint angle is the difference of two. phase_difference: not a
/// multiple of 2 pi.
[[nodiscard]] inline double winding_angle(double amplitude, double phase_difference) {
  return amplitude / (2.0 * std::abs(std::sin(phase_difference / 2.0)));
}

/// Length of a serpenoid curve divided by the length of its arc, which is the Bessel function J0.
[[nodiscard]] inline double serpenoid_shortening(double winding_angle) {
  return std::cyl_bessel_j(0.0, std::abs(winding_angle));
}

/// The distance of a stride without slip (equation 3.2): the body length of one wave minus the length of the wave, a
/// serpenoid curve. body_length: m; waves: number of waves on the body, above 0.
[[nodiscard]] inline double predicted_step_length(double body_length, double waves, double winding_angle) {
  return body_length / waves * (1.0 - serpenoid_shortening(winding_angle));
}

/// A wave of joint angles along the body.
struct BodyWave {
  double phase_difference = 0.0;  ///< mean between neighbouring joints, weighted with the amplitudes; -pi to pi
  double amplitude = 0.0;         ///< mean amplitude of the joints
  std::size_t joints = 0;         ///< number of joints that bend the body in the plane of the wave
};

/// The wave in the target angles of some joints over whole strides: the part of each angle that swings with the stride.
/// joints: positions in the table, from head to tail. Nothing if there are fewer than two, or if they do not swing.
[[nodiscard]] std::optional<BodyWave> find_body_wave(const SignalTable& angles, std::span<const std::size_t> joints,
                                                     const Stride& stride, double tick_s);

}  // namespace proleg::sim
