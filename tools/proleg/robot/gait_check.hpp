#pragma once

// Whether the modules of a robot compute the gait of this computer: the same kernels, with the contacts that the
// modules have sent, compared with every state frame.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/robot_drive.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "sim/loop/gait.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The angle that a module has measured, in rad. It must have measured it.
[[nodiscard]] double radians(const canopen::Monitoring& measured);

class GaitCheck {
 public:
  /// scenario: must outlive the check.
  explicit GaitCheck(const sim::Scenario& scenario);
  GaitCheck(const GaitCheck&) = delete;
  GaitCheck& operator=(const GaitCheck&) = delete;

  /// A change, which takes effect at its tick. Call this before the tick is followed.
  void add_change(const Change& change);

  /// Computes the next tick and compares it. Returns the change that took effect, if any.
  const Change* follow(const host::TickFrames& tick);
  /// Computes the next tick while the robot stops: only the set-points count, for compare_setpoints().
  void follow_stopping(const host::TickFrames& tick);
  /// Compares all bits of the set-points of a joint, if the comparison has not ended. To be called when the ticks up to
  /// that of the module were followed.
  void compare_setpoints(unsigned joint, const canopen::Master::SetpointChecksum& found);
  /// From now on nothing is compared. why: for the verdict.
  void end_comparison(const std::string& why);

  /// The last tick as a recorder takes it. Measured angles and currents are those that the modules have sent; what
  /// modules do not measure is 0.
  [[nodiscard]] sim::TickSample sample(const host::RobotDrive& drive);

  /// The set-points of the gait after the last tick: 90 degrees = 2^30.
  [[nodiscard]] std::span<const std::int32_t> setpoints() const { return gait_.chain().setpoints(); }
  /// Number of ticks of the run, without those while the robot stopped.
  [[nodiscard]] std::uint32_t ticks() const { return ticks_; }
  [[nodiscard]] std::uint64_t compared() const { return compared_; }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }
  [[nodiscard]] std::uint64_t differences() const { return differences_; }
  /// One line; nothing without a difference.
  [[nodiscard]] const std::optional<std::string>& first_difference() const { return first_difference_; }
  /// Why the comparison ended before the run.
  [[nodiscard]] const std::optional<std::string>& end_of_comparison() const { return end_of_comparison_; }
  /// Joints whose set-points are equal to the last bit, and those with a difference, which state frames may not show.
  [[nodiscard]] const std::vector<std::string>& equal_setpoints() const { return equal_setpoints_; }
  [[nodiscard]] const std::vector<std::string>& different_setpoints() const { return different_setpoints_; }
  /// The others that were asked: "J2 (node 2): its module has joined late".
  [[nodiscard]] const std::vector<std::string>& not_compared_setpoints() const { return not_compared_setpoints_; }
  [[nodiscard]] const ValueHash& setpoint_hash() const { return setpoint_hash_; }
  [[nodiscard]] const ValueHash& servo_hash() const { return servo_hash_; }
  /// Of the pulses in servo_hash().
  [[nodiscard]] std::uint32_t servo_period_us() const { return scenario_.robot.servo.period_us; }

 private:
  const Change* advance(const host::TickFrames& tick);
  /// The joint whose contacts are needed and were not received; null: none.
  [[nodiscard]] const std::string* unknown_contacts(const host::TickFrames& tick) const;
  void compare(unsigned joint, unsigned channel, const std::optional<StateFrame>& found);
  [[nodiscard]] std::string name_of(unsigned joint) const;

  const sim::Scenario& scenario_;
  std::vector<Change> changes_;  ///< by tick
  sim::Gait gait_;
  std::uint32_t ticks_ = 0;
  host::SetpointCheck setpoint_check_;
  bool knows_setpoints_ = true;         ///< of all ticks, also while the robot stops
  bool senses_contacts_ = false;        ///< an algorithm of the gait reads them
  std::vector<std::uint8_t> contacts_;  ///< by joint
  std::uint64_t compared_ = 0;
  std::uint64_t missing_ = 0;
  std::uint64_t differences_ = 0;
  std::optional<std::string> first_difference_;
  std::optional<std::string> end_of_comparison_;
  std::vector<std::string> equal_setpoints_;
  std::vector<std::string> different_setpoints_;
  std::vector<std::string> not_compared_setpoints_;
  ValueHash setpoint_hash_;
  ValueHash servo_hash_;
  // The samples that sample() returns refer to these.
  std::vector<std::uint8_t> link_contacts_;
  std::vector<std::int32_t> commands_;
  std::vector<sim::Pose> poses_;
  std::vector<double> angles_;
  std::vector<double> torques_;
  std::vector<double> currents_;
  std::vector<double> forces_;
};

}  // namespace proleg::tools
