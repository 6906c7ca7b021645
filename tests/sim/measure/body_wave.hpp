#pragma once

// The step of a body wave without slip (thesis, equation 3.2), which the tests compare with simulated gaits. SI units,
// angles in radians.

#include <cmath>
#include <numbers>

namespace proleg::sim {

/// Number of body waves, for a phase difference between neighbouring joints (equation 2.14). count: of joints, as in
/// the examples of the thesis, or of segments, one more, as in its text.
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

/// Length of a serpenoid curve divided by the length of its arc: the Bessel function J0.
[[nodiscard]] inline double serpenoid_shortening(double winding_angle) {
  return std::cyl_bessel_j(0.0, std::abs(winding_angle));
}

/// The distance of a stride without slip (equation 3.2): the body length of one wave minus the length of the wave,
/// which is that of a serpenoid curve. body_length: m; waves: number of waves on the body, above 0.
[[nodiscard]] inline double predicted_step_length(double body_length, double waves, double winding_angle) {
  return body_length / waves * (1.0 - serpenoid_shortening(winding_angle));
}

}  // namespace proleg::sim
