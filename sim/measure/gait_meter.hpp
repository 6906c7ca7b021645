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
#include "sim/robot/servo_current.hpp"

namespace proleg::sim {

/// Supply voltage of the servos; sim/robot/servo_current.hpp estimates their current for this voltage.
inline constexpr double servo_supply_v = 6.0;

/// Computes the measures of a run from the robot's motion. docs/gait-measures.md defines them.
class GaitMeter {
 public:
  /// start: centre of mass in the world before the first step. All joint angles are 0 there.
  GaitMeter(const RobotModel& robot, const EnvironmentModel& environment, const Eigen::Vector3d& start, double step_s,
            double tick_s);

  /// What a joint did in a step of the physics.
  struct JointStep {
    double motor_torque;     ///< Nm, about the joint's axis
    double commanded_speed;  ///< rad/s, that the servo tries to reach
    double angle_before;     ///< rad
    double angle;            ///< rad, after the step
    bool limp;               ///< without pulses
  };
  /// Must be called for every joint after every step. Returns the current, in mA, that its servo draws (an estimate).
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
  /// Must be called after every step. normal_force: N, sum over the contact points with the environment;
  /// force_times_speed: N m/s, sum of normal force times sliding speed; friction_power: W.
  void add_contacts(double normal_force, double force_times_speed, double friction_power) {
    friction_power_sum_ += friction_power;
    normal_force_sum_ += normal_force;
    sliding_sum_ += force_times_speed;
  }
  struct Tick {
    Eigen::Vector3d center_of_mass;    ///< in the world
    std::span<const Pose> link_poses;  ///< in the world
    std::span<const double> joint_angles;
    std::span<const double> joint_targets;  ///< rad, of the servos in the last step
    /// Per link, bit 0 rear, bit 1 front sensor: not debounced, without noise.
    std::span<const std::uint8_t> link_contacts;
    std::span<const double> motor_torques{};  ///< Nm, mean over the tick; empty if they are not known
  };
  /// Must be called after the last step of every tick.
  void add_tick(const Tick& tick);

  /// The measures of the run so far. heading_deg: direction of `speed` in the horizontal plane, relative to the
  /// direction of the head at the start; 90 is to its left.
  [[nodiscard]] MeasureValues values(double heading_deg = 0.0) const;
  /// For each link from the head: share of the ticks in which at least one of its sensors was pressed, over a whole
  /// number of strides, or over all ticks if there is no stride. Not a number before the first tick.
  [[nodiscard]] std::vector<double> link_duty_factors() const;
  /// J, so far: what the motors gave the robot less what they took from it.
  [[nodiscard]] double motor_work() const { return motor_power_sum_ * step_s_; }
  /// J, so far: what friction took.
  [[nodiscard]] double friction_work() const { return friction_power_sum_ * step_s_; }
  /// By joint.
  [[nodiscard]] std::span<const ServoTracking> tracking() const { return tracking_; }
  /// The strides from which measures of strides are computed.
  [[nodiscard]] std::optional<Stride> stride() const;

  /// The time in which the servos move from the start into the gait. tracking() and its measures leave it out.
  static constexpr double settling_s = 1.0;
  /// Strides are searched in at least this number of the last ticks.
  static constexpr std::size_t history_ticks = 65'536;

 private:
  struct JointState {
    double per_max_speed;  ///< s/rad
    double speed = 0.0;    ///< rad/s, in the last step
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
  std::vector<std::size_t> planar_joints_;  ///< those of the first joint's plane, from head to tail
  BodyEnergy energy_;
  std::vector<Eigen::Vector3d> link_centers_;  ///< centres of mass, in the frames of the links

  std::vector<JointState> joints_;
  std::vector<ServoTracking> tracking_;  ///< by joint; from the end of settling_s on
  bool has_settled_ = false;
  double normal_force_sum_ = 0.0;      ///< N, over all steps
  double sliding_sum_ = 0.0;           ///< N m/s, over all steps
  double mechanical_power_sum_ = 0.0;  ///< W, over all steps: what motors give, without what they take
  double motor_power_sum_ = 0.0;       ///< W, over all steps
  double friction_power_sum_ = 0.0;    ///< W, over all steps
  double current_sum_ma_ = 0.0;        ///< over all steps and joints
  std::uint64_t joint_steps_ = 0;      ///< number of these

  std::uint64_t ticks_ = 0;
  Eigen::Vector3d start_;
  Eigen::Vector3d center_;         ///< of mass, now
  Eigen::Vector3d center_before_;  ///< a tick before
  double squared_second_differences_ = 0.0;
  double largest_squared_second_difference_ = 0.0;
  Eigen::Vector2d span_;  ///< from tail to head, seen from above, when it was last long enough to have a direction
  double turn_ = 0.0;     ///< rad, of the span since the start
  double margin_sum_ = 0.0;
  std::uint64_t supported_ticks_ = 0;
  std::vector<double> targets_;         ///< of the last ticks, by tick, then by joint
  std::vector<std::uint8_t> contacts_;  ///< of the last ticks, by tick, then by link
};

}  // namespace proleg::sim
