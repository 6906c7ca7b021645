#pragma once

// A robot's gait in memory: one kernel for each joint, as on the robot; the kernels exchange state frames and nothing
// else. It computes the gait where there are no modules, and modules on a bus are compared with it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "shared/kernel/kernel.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "sim/record/recorder.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The kernel rejects a configuration or a change. Readers of scenarios check their values, so with a scenario this is
/// a fault of the program. what(): the reason.
class KernelRefusal : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// The kernels of the joints.
class KernelChain {
 public:
  /// Copies the arguments. Throws KernelRefusal, as apply() does.
  KernelChain(const KernelConfiguration& configuration, std::span<const AngleLimits> limits,
              std::span<const Setting> settings);

  /// Withholds state frames from now on. losses: must outlive the chain; null for none.
  void set_losses(const Losses* losses) { losses_ = losses; }

  /// A change for the coming tick. Of several changes for one tick, the later one counts.
  void apply(const Change& change);

  /// The module of a joint restarts: from the coming tick on it computes nothing. The other joints still receive the
  /// frame that it has sent for that tick.
  void stop(unsigned joint);
  /// The joint computes again from the coming tick on, with the parameters of the settings and of all changes so far.
  void join(unsigned joint);
  [[nodiscard]] bool is_running(unsigned joint) const { return running_.contains(joint); }
  /// The parameters that a joint gets when it joins: each once, with its start value or that of the last change.
  [[nodiscard]] std::span<const Setting> settings() const { return settings_; }

  /// What the module of a joint measured, for the coming tick (Kernel::set_readings).
  void set_readings(unsigned joint, const JointReadings& readings) {
    if (running_.contains(joint)) {
      kernels_[joint]->set_readings(joint, readings);
    }
  }
  /// Whether any joint uses readings of its module.
  [[nodiscard]] bool needs_readings() const;

  /// The tick: delivers the frames labelled tick(), then every running joint computes state tick() + 1.
  /// contacts: of each joint, at this SYNC, in bits 0 to 3 as in the state frame.
  void advance(std::span<const std::uint8_t> contacts);

  /// The set-point of each joint; a joint that does not run keeps its last one.
  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return setpoints_; }
  /// Ticks so far, by joint, in which its limits cut the sum of the slots.
  [[nodiscard]] std::span<const std::uint32_t> clipped_ticks() const { return clipped_ticks_; }
  /// Frames that the losses withheld in the last tick.
  [[nodiscard]] std::span<const Loss> lost() const { return lost_; }
  /// Frames of the last tick that a joint received or that were withheld from it; a frame counts once for each joint.
  [[nodiscard]] std::uint32_t receptions() const { return receptions_; }
  /// The coming tick.
  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  [[nodiscard]] unsigned joint_count() const { return static_cast<unsigned>(kernels_.size()); }
  /// The kernel of a joint.
  [[nodiscard]] const Kernel& kernel(unsigned joint) const { return *kernels_[joint]; }

 private:
  void configure(unsigned joint);
  void keep(const Setting& setting);
  /// A number that no change waits under: 1 to 65,535.
  [[nodiscard]] std::uint16_t next_transaction();
  void exchange_frames();

  KernelConfiguration configuration_;
  std::vector<AngleLimits> limits_;
  std::vector<Setting> settings_;
  std::uint16_t transaction_ = 0;  ///< of the last change; 0 before the first one
  std::vector<std::unique_ptr<KernelOf<1>>> kernels_;
  const Losses* losses_ = nullptr;
  JointMask running_;
  JointMask sent_;  ///< joints that have sent frames labelled tick()
  std::uint32_t tick_ = 0;
  std::vector<std::int32_t> setpoints_;
  std::vector<std::uint32_t> clipped_ticks_;
  std::vector<Loss> lost_;
  std::uint32_t receptions_ = 0;
};

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

  /// The way of a joint in a tick: the set-point at its start and the one at its end.
  struct Way {
    unsigned joint;
    std::int32_t from;
    std::int32_t to;
  };
  /// Appends the pulses of a tick, in the order of time, then of joints. ways: of the joints that get pulses, by
  /// ascending joint. To be called once for each tick.
  void append(std::uint64_t tick, std::span<const Way> ways, std::vector<ServoPulse>& pulses) {
    const std::uint64_t end = schedule_.first_interval(tick + 1);
    for (std::uint64_t interval = schedule_.first_interval(tick); interval < end; ++interval) {
      const std::int32_t fraction = schedule_.fraction(interval);
      for (const Way& way : ways) {
        const std::int32_t angle = interpolate(way.from, way.to, fraction);
        pulses.push_back({schedule_.start_us(interval), way.joint, servo_command(limiters_[way.joint].next(angle))});
      }
    }
  }

  /// The same for the last computed tick of a chain: its running joints get pulses.
  void append(const KernelChain& chain, std::vector<ServoPulse>& pulses) {
    ways_.clear();
    for (unsigned joint = 0; joint < chain.joint_count(); ++joint) {
      if (chain.is_running(joint)) {
        ways_.push_back({joint, chain.kernel(joint).previous_setpoint(joint), chain.kernel(joint).setpoint(joint)});
      } else {
        limiters_[joint].release();
      }
    }
    append(chain.tick() - 1U, ways_, pulses);
  }

 private:
  ServoSchedule schedule_;
  std::vector<MotionLimiter> limiters_;  ///< by joint
  std::vector<Way> ways_;                ///< in append()
};

/// The gait of a robot in memory, with its changes while the robot moves: the kernels of the joints, and the pulses for
/// the servos.
class Gait {
 public:
  /// What determines a gait, beside its contacts and readings.
  struct Parts {
    const KernelConfiguration& kernel;
    std::span<const AngleLimits> limits;
    std::span<const Setting> settings;
    /// The changes by ascending tick. They must outlive the gait; those of coming ticks may still be replaced, and
    /// others added.
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
  /// Position of the next change if it is for the coming tick.
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
  std::vector<std::int32_t> internal_values_;  ///< which the result of sample() refers to
};

}  // namespace proleg::sim
