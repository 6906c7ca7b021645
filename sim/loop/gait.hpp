#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/loop/kernel_chain.hpp"
#include "sim/loop/servo_pulses.hpp"
#include "sim/record/recorder.hpp"
#include "sim/robot/servo_pulse.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

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
