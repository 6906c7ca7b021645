#include "sim/measure/crawling_models.hpp"

#include <cmath>
#include <numbers>

namespace proleg::sim {

CrawlingWork two_anchor_work(double friction, double speed, double stride_length, double gravity) {
  return {friction * gravity, 4.0 * speed * speed / (3.0 * stride_length)};
}

double two_anchor_crossover_speed(double friction, double stride_length, double gravity) {
  return std::sqrt(0.75 * friction * gravity * stride_length);
}

CrawlingWork peristalsis_work(double friction, double moving_share, double speed, double stride_length,
                              double gravity) {
  return {friction * gravity, speed * speed / (2.0 * moving_share * moving_share * stride_length)};
}

double peristalsis_crossover_speed(double friction, double moving_share, double stride_length, double gravity) {
  return moving_share * std::sqrt(2.0 * friction * gravity * stride_length);
}

double max_moving_share(double friction_forward, double friction_back) {
  return friction_back / (friction_back + friction_forward);
}

CrawlingWork serpentine_work(double axial_friction, double bend, double speed, double stride_length, double gravity) {
  const double sideways = speed * std::tan(bend);
  return {axial_friction * gravity / std::cos(bend), sideways * sideways / stride_length};
}

double serpentine_crossover_speed(double axial_friction, double bend, double stride_length, double gravity) {
  return std::sqrt(axial_friction * gravity * stride_length * std::cos(bend)) / std::sin(bend);
}

double min_bend(double axial_friction, double transverse_friction) {
  return std::atan2(axial_friction, transverse_friction);
}

double wave_count(double phase_difference, double count) {
  return std::abs(phase_difference) * count / (2.0 * std::numbers::pi);
}

double winding_angle(double amplitude, double phase_difference) {
  return amplitude / (2.0 * std::abs(std::sin(phase_difference / 2.0)));
}

double serpenoid_shortening(double winding_angle) { return std::cyl_bessel_j(0.0, std::abs(winding_angle)); }

double predicted_step_length(double body_length, double waves, double winding_angle) {
  return body_length / waves * (1.0 - serpenoid_shortening(winding_angle));
}

}  // namespace proleg::sim
