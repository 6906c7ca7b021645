#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/kernel/servo_command.hpp"

namespace proleg {

/// The default for the greatest speed of commanded angles (object 0x6080) [deg/s]. It is faster than the servos that
/// such modules use (60 degrees in 0.083 s). A quick stop uses the minimum.
inline constexpr std::uint32_t default_command_speed = 720;
inline constexpr std::uint32_t min_command_speed = 90;
inline constexpr std::uint32_t max_command_speed = 10'000;

/// The last step before the pulse. The angle that a servo is commanded to is within the joint's limits. It differs from
/// the angle of the pulse before by at most what the greatest speed allows in a servo period. All commanded angles pass
/// through here, whether a gait, a host or a fault of either computes them. Simulator and module use this class.
class MotionLimiter {
 public:
  /// Greatest change of the angle in a servo period, 90 degrees = 2^30, rounded down. degrees_per_second: at most
  /// max_command_speed; servo_period_us: below 2^17.
  [[nodiscard]] static constexpr std::int32_t step_of(std::uint32_t degrees_per_second, std::uint32_t servo_period_us) {
    const std::uint64_t step = (std::uint64_t{degrees_per_second} * servo_period_us << 30U) / 90'000'000U;
    return static_cast<std::int32_t>(std::min<std::uint64_t>(step, 0x7FFF'FFFF));
  }

  /// Sets the limits of the joint angle, lower <= upper. The next angle is cut to them even if the last one was not.
  constexpr void set_limits(std::int32_t lower, std::int32_t upper) {
    lower_ = lower;
    upper_ = upper;
  }
  constexpr void set_step(std::int32_t max_step) { max_step_ = max_step; }
  [[nodiscard]] constexpr std::int32_t step() const { return max_step_; }

  /// Notes that the servo gets no pulses. Its position is then unknown, so the first angle afterwards may be any within
  /// the limits.
  constexpr void release() { is_released_ = true; }

  /// The angle to command when `wanted` is wanted. max_way: greatest distance from the last angle, if that is less than
  /// the step.
  constexpr std::int32_t next(std::int32_t wanted, std::int32_t max_way = 0x7FFF'FFFF) {
    const std::int32_t bound = std::min(max_step_, max_way);
    const std::int32_t goal = within_limits(wanted);
    if (is_released_) {
      is_released_ = false;
      angle_ = goal;
    } else {
      const std::int64_t way = std::int64_t{goal} - angle_;
      angle_ += static_cast<std::int32_t>(std::clamp<std::int64_t>(way, -bound, bound));
    }
    return angle_;
  }

  /// The angle within the limits that is nearest to the wanted one.
  [[nodiscard]] constexpr std::int32_t within_limits(std::int32_t wanted) const {
    return std::clamp(wanted, lower_, upper_);
  }

  /// The angle that the last next() returned.
  [[nodiscard]] constexpr std::int32_t angle() const { return angle_; }
  [[nodiscard]] constexpr bool is_released() const { return is_released_; }

 private:
  static constexpr std::int32_t right_angle = 1 << 30;

  std::int32_t lower_ = -right_angle;
  std::int32_t upper_ = right_angle;
  std::int32_t max_step_ = step_of(default_command_speed, 20'000);
  std::int32_t angle_ = 0;
  bool is_released_ = true;
};

}  // namespace proleg
