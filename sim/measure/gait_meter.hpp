#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/environment/environment_model.hpp"
#include "sim/measure/body_energy.hpp"
#include "sim/measure/measure.hpp"
#include "sim/measure/servo_tracking.hpp"
#include "sim/measure/stride.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {

/// Supply voltage of the servos; sim/robot/servo.hpp estimates their current for this voltage.
inline constexpr double servo_supply_v = 6.0;

/// Computes the measures of a run from the robot's motion. docs/gait-measures.md defines them.
class GaitMeter {
 public:
  /// start: centre of mass in the world before the first step, when all joint angles are 0.
  GaitMeter(const RobotModel& robot, const EnvironmentModel& environment, const Eigen::Vector3d& start, double step_s,
            double tick_s);

  /// The motion of a joint in a step of the physics.
  struct JointStep {
    double motor_torque;     ///< Nm, about the joint's axis
    double commanded_speed;  ///< speed that the servo tries to reach, rad/s
    double angle_before;     ///< rad, before the step
    double angle;            ///< rad, after the step
    bool limp;               ///< the servo has no pulses
  };
  /// Must be called for each joint after each step. Returns an estimate of the current that its servo draws, in mA.
  double add_joint_step(std::size_t joint, const JointStep& step) {
    JointState& state = joints_[joint];
    state.limp = step.limp;
    if (!step.limp && has_settled_) {
      tracking_[joint].add_step(step.commanded_speed, step.motor_torque);
    }
    const double speed = (step.angle - step.angle_before) * steps_per_s_;
    // Torque times the mean of the speeds before and after a step is exactly the energy that the step adds.
    const double power = 0.5 * step.motor_torque * (speed + state.speed);
    motor_power_sum_ += power;
    mechanical_power_sum_ += std::max(power, 0.0);
    state.speed = speed;
    // Speeds are relative to max_speed, which avoids a division in every step.
    const double current_ma = step.limp ? servo_.idle_ma
                                        : servo_current_ma(servo_, step.commanded_speed * state.per_max_speed,
                                                           speed * state.per_max_speed, 1.0);
    current_sum_ma_ += current_ma;
    ++joint_steps_;
    return current_ma;
  }
  /// Must be called after each step. normal_force: sum over the contact points with the environment, N;
  /// force_times_speed: sum of normal force times sliding speed, N m/s; friction_power: W.
  void add_contacts(double normal_force, double force_times_speed, double friction_power) {
    friction_power_sum_ += friction_power;
    normal_force_sum_ += normal_force;
    sliding_sum_ += force_times_speed;
  }
  struct Tick {
    Eigen::Vector3d center_of_mass;    ///< in the world
    std::span<const Pose> link_poses;  ///< in the world
    std::span<const double> joint_angles;
    std::span<const double> joint_targets;  ///< targets of the servos in the last step, rad
    /// Touch sensors of each link, bit 0 rear, bit 1 front: not debounced, without noise.
    std::span<const std::uint8_t> link_contacts;
    std::span<const double> motor_torques{};  ///< Nm, mean over the tick; empty if they are not known
  };
  /// Must be called after the last step of every tick.
  void add_tick(const Tick& tick);

  /// The measures of the run so far. heading_deg: direction of `speed` in the horizontal plane, relative to the
  /// direction of the head at the start; 90 is to its left.
  [[nodiscard]] MeasureValues values(double heading_deg = 0.0) const;
  /// Share of the ticks in which at least one sensor of a link was pressed, for each link from the head: over a whole
  /// number of strides, or over all ticks without a stride. NaN before the first tick.
  [[nodiscard]] std::vector<double> link_duty_factors() const;
  /// Energy that the motors gave the robot so far, less the energy that they took from it, J.
  [[nodiscard]] double motor_work() const { return motor_power_sum_ * step_s_; }
  /// Energy that friction took so far, J.
  [[nodiscard]] double friction_work() const { return friction_power_sum_ * step_s_; }
  /// Tracking of the servos, by joint.
  [[nodiscard]] std::span<const ServoTracking> tracking() const { return tracking_; }
  /// The strides from which measures of strides are computed.
  [[nodiscard]] std::optional<Stride> stride() const;

  /// Time in which the servos move from the start into the gait. tracking() and its measures leave it out.
  static constexpr double settling_s = 1.0;
  /// Strides are searched in at least this number of the last ticks.
  static constexpr std::size_t history_ticks = 65'536;

 private:
  struct JointState {
    double per_max_speed;  ///< s/rad
    double speed = 0.0;    ///< speed in the last step, rad/s
    bool limp = false;
  };
  /// Positions of the touch sensors of a link, in its frame: in the middle of the halves that they sense.
  struct SensorPositions {
    Eigen::Vector3d rear;
    Eigen::Vector3d front;
  };

  void add_stability(const Tick& tick, const Eigen::Vector2d& span);
  void add_turn(const Eigen::Vector2d& span);
  void add_tracking(const Tick& tick);
  void drop_oldest_ticks();
  [[nodiscard]] double speed_along(double heading_deg) const;
  void add_servo_measures(MeasureValues& values) const;
  void add_wave_measures(MeasureValues& values, const Stride& stride) const;
  [[nodiscard]] std::vector<double> duty_factors(const std::optional<Stride>& stride) const;

  ServoCurrent servo_;
  double steps_per_s_;
  double step_s_;
  double tick_s_;
  double gravity_;
  double mass_ = 0.0;
  double body_length_ = 0.0;
  Eigen::Vector2d forward_;  ///< direction of the head at the start; not numbers if the head points up or down
  std::vector<SensorPositions> sensors_;
  std::vector<std::size_t> planar_joints_;  ///< joints that bend in the first joint's plane, from head to tail
  BodyEnergy energy_;
  std::vector<Eigen::Vector3d> link_centers_;  ///< centres of mass, in the frames of the links

  std::vector<JointState> joints_;
  std::vector<ServoTracking> tracking_;  ///< by joint; from the end of settling_s on
  bool has_settled_ = false;
  double normal_force_sum_ = 0.0;      ///< N, over all steps
  double sliding_sum_ = 0.0;           ///< N m/s, over all steps
  double mechanical_power_sum_ = 0.0;  ///< W, over all steps: power that motors give, without power that they take
  double motor_power_sum_ = 0.0;       ///< W, over all steps
  double friction_power_sum_ = 0.0;    ///< W, over all steps
  double current_sum_ma_ = 0.0;        ///< over all steps and joints
  std::uint64_t joint_steps_ = 0;      ///< number of terms of current_sum_ma_

  std::uint64_t ticks_ = 0;
  Eigen::Vector3d start_;
  Eigen::Vector3d center_;         ///< present centre of mass
  Eigen::Vector3d center_before_;  ///< centre of mass a tick before
  double squared_second_differences_ = 0.0;
  double largest_squared_second_difference_ = 0.0;
  Eigen::Vector2d span_;  ///< from tail to head, seen from above, when it was last long enough to have a direction
  double turn_ = 0.0;     ///< turn of the span since the start, rad
  double margin_sum_ = 0.0;
  std::uint64_t supported_ticks_ = 0;
  std::vector<double> targets_;         ///< targets of the last ticks, by tick, then by joint
  std::vector<std::uint8_t> contacts_;  ///< contacts in the last ticks, by tick, then by link
};

}  // namespace proleg::sim
