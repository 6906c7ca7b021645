#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/kernel/motion_limiter.hpp"
#include "shared/kernel/servo_command.hpp"
#include "shared/kernel/servo_schedule.hpp"
#include "sim/loop/kernel_chain.hpp"
#include "sim/record/recorder.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Makes the pulses that a chain gives its servos, as the modules of the robot do. They do not depend on the steps of
/// the physics.
class ServoPulses {
 public:
  /// limits: of each joint. command_speed: the greatest, in degrees a second.
  ServoPulses(const ServoSchedule& schedule, std::span<const AngleLimits> limits, std::uint32_t command_speed)
      : schedule_(schedule), limiters_(limits.size()) {
    const std::int32_t step = MotionLimiter::step_of(command_speed, schedule.servo_period_us());
    for (std::size_t joint = 0; joint < limits.size(); ++joint) {
      limiters_[joint].set_limits(limits[joint].lower, limits[joint].upper);
      limiters_[joint].set_step(step);
    }
  }

  [[nodiscard]] const ServoSchedule& schedule() const { return schedule_; }

  /// Appends the pulses of the running joints in the last computed tick, in the order of time, then of joints. To be
  /// called once after each tick.
  void append(const KernelChain& chain, std::vector<ServoPulse>& pulses) {
    ways_.clear();
    for (unsigned joint = 0; joint < chain.joint_count(); ++joint) {
      if (chain.is_running(joint)) {
        ways_.push_back({joint, chain.kernel(joint).previous_setpoint(joint), chain.kernel(joint).setpoint(joint)});
      } else {
        limiters_[joint].release();
      }
    }
    const std::uint64_t tick = chain.tick() - 1U;
    const std::uint64_t end = schedule_.first_interval(tick + 1);
    for (std::uint64_t interval = schedule_.first_interval(tick); interval < end; ++interval) {
      const std::int32_t fraction = schedule_.fraction(interval);
      for (const Way& way : ways_) {
        const std::int32_t angle = interpolate(way.from, way.to, fraction);
        pulses.push_back({schedule_.start_us(interval), way.joint, servo_command(limiters_[way.joint].next(angle))});
      }
    }
  }

 private:
  /// Of a running joint, in the tick.
  struct Way {
    unsigned joint;
    std::int32_t from;
    std::int32_t to;
  };

  ServoSchedule schedule_;
  std::vector<MotionLimiter> limiters_;  ///< by joint
  std::vector<Way> ways_;                ///< in append()
};

/// The gait of a robot in memory, with its changes in flight: the kernels of the joints, and the pulses for the servos.
class Gait {
 public:
  /// What determines a gait, beside its contacts and readings.
  struct Parts {
    const KernelConfiguration& kernel;
    std::span<const AngleLimits> limits;
    std::span<const Setting> settings;
    /// By ascending tick. They must outlive the gait; those of coming ticks may still be replaced, and others added.
    const std::vector<Change>& changes;
    std::uint32_t servo_period_us;
    std::uint32_t command_speed;  ///< the greatest of a joint, in degrees a second
  };
  /// Throws KernelRefusal, as apply_due_changes() does.
  explicit Gait(const Parts& parts);
  /// scenario: must outlive the gait.
  explicit Gait(const Scenario& scenario);
  explicit Gait(const Scenario&& scenario) = delete;

  /// Position of the first change that has not been applied or left out.
  [[nodiscard]] std::size_t next_change() const { return next_change_; }
  /// The same, if the change is for the coming tick.
  [[nodiscard]] std::optional<std::size_t> due_change() const;
  /// The changes for the coming tick take effect at it. Returns the last of them; null if there is none.
  const Change* apply_due_changes();
  /// The next change never takes effect.
  void leave_out_change() { ++next_change_; }

  /// Computes the tick, and its pulses. contacts: of each joint, as in KernelChain::advance().
  void advance(std::span<const std::uint8_t> contacts);

  /// The coming tick.
  [[nodiscard]] std::uint32_t tick() const { return chain_.tick(); }
  [[nodiscard]] const KernelChain& chain() const { return chain_; }
  [[nodiscard]] KernelChain& chain() { return chain_; }
  [[nodiscard]] const ServoSchedule& schedule() const { return pulse_source_.schedule(); }
  /// The pulses of the servo intervals that start in the last tick, in the order of time, then of joints.
  [[nodiscard]] std::span<const ServoPulse> pulses() const { return pulses_; }

  /// What a recorder takes of the gait in the last tick: number, set-points, internal values, pulses and lost frames.
  /// Valid until the next advance().
  [[nodiscard]] TickSample sample();

 private:
  KernelConfiguration kernel_;
  const std::vector<Change>& changes_;
  std::size_t next_change_ = 0;
  KernelChain chain_;
  ServoPulses pulse_source_;
  std::vector<ServoPulse> pulses_;
  std::vector<std::int32_t> internal_values_;  ///< in sample()
};

}  // namespace proleg::sim
