#pragma once

// A robot's gait in memory: one kernel for each joint, as on the robot; the kernels exchange state frames and nothing
// else. It computes the gait where there are no modules, and modules on a bus are compared with it.

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "shared/kernel/kernel.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The kernel rejects a configuration or a change. Readers of scenarios check their values, so with a scenario this is
/// a fault of the program. what(): the reason.
class KernelRefusal : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

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

  /// Of each joint; a joint that does not run keeps its last one.
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

}  // namespace proleg::sim
