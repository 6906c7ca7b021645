#pragma once

// Theory of crawling: the models of R. McN. Alexander, "Principles of Animal Locomotion" (2003), as in section 2.3 of
// the thesis, and the step of a body wave without slip (thesis, equation 3.2). SI units, angles in radians.

namespace proleg::sim {

/// Work per mass and distance, in J/(kg m) = m/s^2: the part for friction, and the part for kinetic energy that is lost
/// in each stride.
struct CrawlingWork {
  double friction;
  double inertia;
};

// In all of them: speed: m/s; stride_length: m, above 0; gravity: m/s^2; the coefficients of friction are Coulomb's.
// The crossover is the speed at which both parts of the work are equal.

/// Three segments of which the first and the last are anchors in turn (equations 2.4 and 2.5). friction: forward.
[[nodiscard]] CrawlingWork two_anchor_work(double friction, double speed, double stride_length, double gravity);
[[nodiscard]] double two_anchor_crossover_speed(double friction, double stride_length, double gravity);

/// An earthworm (equations 2.6 and 2.7). moving_share: share of the segments that move at any time; above 0, below 1.
[[nodiscard]] CrawlingWork peristalsis_work(double friction, double moving_share, double speed, double stride_length,
                                            double gravity);
[[nodiscard]] double peristalsis_crossover_speed(double friction, double moving_share, double stride_length,
                                                 double gravity);
/// Above this share of moving segments, the segments at rest slide back.
[[nodiscard]] double max_moving_share(double friction_forward, double friction_back);

/// A snake as a zigzag (equations 2.8 to 2.10). bend: angle of the segments to the way they go, 0 to pi/2.
[[nodiscard]] CrawlingWork serpentine_work(double axial_friction, double bend, double speed, double stride_length,
                                           double gravity);
/// Equations 2.9 and 2.10 set equal. bend: above 0.
[[nodiscard]] double serpentine_crossover_speed(double axial_friction, double bend, double stride_length,
                                                double gravity);
/// Below this angle the snake does not move forwards.
[[nodiscard]] double min_bend(double axial_friction, double transverse_friction);

/// Number of body waves, for a phase difference between neighbouring joints (equation 2.14). count: of joints, as in
/// the examples of the thesis, or of segments, one more, as in its text.
[[nodiscard]] double wave_count(double phase_difference, double count);

/// The maximum angle of a link to the robot's direction of travel, when its joints swing by an amplitude: links that
/// follow a serpenoid curve (S. Hirose, "Biologically Inspired Robots", 1993) have the headings
/// winding_angle * cos(w t - l * phase_difference), and a joint angle is the difference of two. phase_difference: not a
/// multiple of 2 pi.
[[nodiscard]] double winding_angle(double amplitude, double phase_difference);

/// Length of a serpenoid curve divided by the length of its arc: the Bessel function J0.
[[nodiscard]] double serpenoid_shortening(double winding_angle);

/// The distance of a stride without slip (equation 3.2): the body length of one wave minus the length of the wave,
/// which is that of a serpenoid curve. body_length: m; waves: number of waves on the body, above 0.
[[nodiscard]] double predicted_step_length(double body_length, double waves, double winding_angle);

}  // namespace proleg::sim
