#pragma once

// The SDO writes that set up the module of a joint. There is no other way to configure a module: simulator and host
// send this list.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/canopen/robot_configuration.hpp"
#include "shared/computer/master/sdo_client_pool.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::canopen {

/// Time without a heartbeat of the host after which a module stops: with the ramp of a quick stop, 1 s at most, a joint
/// is at rest after 1.45 s. A host that sends one each 100 ms may stand still for 0.3 s.
inline constexpr std::uint32_t host_timeout_ms = 450;
/// Period of a module's heartbeat.
inline constexpr std::uint32_t heartbeat_period_ms = 100;

/// The set-up of a robot on a bus.
struct RobotSetup : RobotConfiguration {
  std::uint32_t command_speed = default_command_speed;  ///< the greatest speed of commanded angles, degrees a second
  std::span<const AngleLimits> limits;                  ///< limits of each joint, in kernel order
  std::span<const Setting> start_values;  ///< of parameters; if one occurs several times, the last value counts
};

/// The writes that configure a module for a joint, in the order in which they must be made: heartbeats, the
/// configuration of the kernel, `activate`, then limits and parameters. The module is in Pre-operational after a reset,
/// so values that equal the defaults are left out.
///
/// setup: must outlive the list. The list is empty if the joint does not exist, or if nodes or limits are missing. The
/// list leaves out a start value without a parameter of an algorithm that drives the joint.
class SetupList {
 public:
  SetupList(const RobotSetup& setup, unsigned joint);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The write at a position below size().
  [[nodiscard]] SdoRequest at(std::size_t position) const;

 private:
  using Values = std::array<std::array<std::int32_t, max_parameters>, max_slots>;

  void collect_start_values();
  template <typename Visitor>
  void visit_all(Visitor& visitor) const;

  const RobotSetup& setup_;
  unsigned joint_;
  JointMask second_channel_;
  Values start_values_{};
  std::array<std::uint32_t, max_slots> to_write_{};  ///< for each slot, bit p: parameter p differs from its default
  std::size_t size_ = 0;
};

}  // namespace proleg::canopen
