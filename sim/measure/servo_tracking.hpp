#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace proleg::sim {

/// Measures how well a servo follows its pulses, and for what share of the time its limits prevent this. Times without
/// pulses do not count.
class ServoTracking {
 public:
  /// max_speed (rad/s) and max_torque (Nm) must be above 0.
  ServoTracking(double max_speed, double max_torque) : max_speed_(max_speed), torque_limit_(almost_all * max_torque) {}

  /// Share of the time at a limit, and error in rad, above which a servo cannot follow. Both must be exceeded, because
  /// a servo at its torque limit may still keep its angle.
  static constexpr double much_time = 0.2;
  static constexpr double large_error = 5.0 * std::numbers::pi / 180.0;

  /// Must be called for each step of the physics with pulses. commanded_speed: speed that the servo tries to reach,
  /// rad/s; motor_torque: Nm.
  void add_step(double commanded_speed, double motor_torque) {
    ++steps_;
    speed_limited_ += std::abs(commanded_speed) >= max_speed_ ? 1U : 0U;
    torque_limited_ += std::abs(motor_torque) >= torque_limit_ ? 1U : 0U;
  }
  /// Must be called for each tick with pulses. error: difference between the angle and that of the pulse, rad.
  void add_tick(double error) {
    ++ticks_;
    squares_ += error * error;
    max_ = std::max(max_, std::abs(error));
  }

  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// Sum of the squared errors, rad^2.
  [[nodiscard]] double squared_errors() const { return squares_; }
  /// Errors in rad. The root mean square is NaN before the first tick.
  [[nodiscard]] double rms_error() const { return std::sqrt(squares_ / static_cast<double>(ticks_)); }
  [[nodiscard]] double max_error() const { return ticks_ > 0 ? max_ : std::numeric_limits<double>::quiet_NaN(); }
  /// Shares of the time at a limit, 0 to 1. NaN before the first step.
  [[nodiscard]] double at_speed_limit() const { return share(speed_limited_); }
  [[nodiscard]] double at_torque_limit() const { return share(torque_limited_); }
  /// Whether the servo is at a limit for much of the time and has a large error (root mean square).
  [[nodiscard]] bool cannot_follow() const {
    return (at_speed_limit() > much_time || at_torque_limit() > much_time) && rms_error() > large_error;
  }

 private:
  /// Share of the torque limit that counts as the limit: the solver reaches it only up to rounding.
  static constexpr double almost_all = 0.999;

  [[nodiscard]] double share(std::uint64_t steps) const {
    return static_cast<double>(steps) / static_cast<double>(steps_);
  }

  double max_speed_;
  double torque_limit_;
  std::uint64_t steps_ = 0;
  std::uint64_t speed_limited_ = 0;
  std::uint64_t torque_limited_ = 0;
  std::uint64_t ticks_ = 0;
  double squares_ = 0.0;
  double max_ = 0.0;
};

}  // namespace proleg::sim
