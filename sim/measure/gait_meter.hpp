#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sim/environment/environment_model.hpp"
#include "sim/measure/measure.hpp"
#include "sim/measure/stride.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {

/// The energies that a robot's body holds while it moves (thesis, equations 2.11 to 2.13), at the ends of the ticks.
class BodyEnergy {
 public:
  /// All joint angles are 0 and the robot rests before the first tick, in the pose of the environment.
  BodyEnergy(const RobotModel& robot, const Pose& start, double gravity, double tick_s);

  /// link_poses: in the world. motor_torques: Nm, mean over the tick; empty if they are not known.
  void add_tick(std::span<const Pose> link_poses, std::span<const double> joint_angles,
                std::span<const double> joint_targets, std::span<const double> motor_torques);

  // Energies in J, means over the ticks; NaN before the first tick.
  /// m g h, where h is the height of the centre of mass above its height at the start.
  [[nodiscard]] double mean_potential() const { return potential_sum_ / static_cast<double>(ticks_); }
  /// Sum of m v^2 / 2 and w I w / 2 over the links, with the mean velocities of the tick.
  [[nodiscard]] double mean_kinetic() const { return kinetic_sum_ / static_cast<double>(ticks_); }
  /// Sum of K x^2 / 2 over the joints, if a servo were a spring that has the servo's torque at its distance from its
  /// target.
  [[nodiscard]] double mean_elastic() const { return elastic_sum_ / static_cast<double>(ticks_); }

 private:
  struct Body {
    MassProperties mass;
    Eigen::Vector3d center;  ///< centre of mass in the world, a tick before
    Eigen::Quaterniond orientation;
  };

  double weight_per_mass_;  ///< m/s^2
  double ticks_per_s_;
  std::vector<Body> bodies_;
  double start_moment_ = 0.0;  ///< sum of mass times height at the start, kg m
  std::uint64_t ticks_ = 0;
  double potential_sum_ = 0.0;
  double kinetic_sum_ = 0.0;
  double elastic_sum_ = 0.0;
};

/// Measures how well a joint follows the set-points of the gait, and for what share of the time the limits of its servo
/// prevent this. Times without pulses do not count.
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
  /// Must be called for each tick with pulses. error: difference between set-point and angle of the joint, rad.
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
  /// The ticks and steps since an earlier state of the same servo. max_error() then is that of all ticks.
  [[nodiscard]] ServoTracking since(const ServoTracking& earlier) const {
    ServoTracking recent = *this;
    recent.steps_ -= earlier.steps_;
    recent.speed_limited_ -= earlier.speed_limited_;
    recent.torque_limited_ -= earlier.torque_limited_;
    recent.ticks_ -= earlier.ticks_;
    recent.squares_ -= earlier.squares_;
    return recent;
  }
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
    /// Set-points of the gait, rad: the angles that the joints are to have at the end of the tick. Empty if they are
    /// not known; then tracking has no errors.
    std::span<const double> setpoints;
    /// Touch sensors of each link, bit 0 rear, bit 1 front: not debounced, without noise.
    std::span<const std::uint8_t> link_contacts;
    std::span<const double> motor_torques{};  ///< Nm, mean over the tick; empty if they are not known
  };
  /// Must be called after the last step of every tick.
  void add_tick(const Tick& tick);

  /// The measures of the run so far. heading_deg: direction of `speed` in the horizontal plane, relative to the
  /// direction of the head at the start; 90 is to its left.
  [[nodiscard]] MeasureValues values(double heading_deg = 0.0) const;
  /// How far the centre of mass has come in the direction of the head at the start, m; not a number if the head pointed
  /// up or down.
  [[nodiscard]] double forward_distance() const { return (center_ - start_).head<2>().dot(forward_); }
  /// Horizontal speed of the centre of mass in any direction, m/s: over the last two strides, or over as many as take a
  /// second; without strides over the last two seconds. Nothing before that.
  [[nodiscard]] std::optional<double> recent_speed() const;
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
  /// Bounds of strides, in ticks of the kept history: two whole strides, or as many as take a second, that ended just
  /// now. `ticks`: length of the history in which they are searched.
  [[nodiscard]] std::optional<std::pair<double, double>> recent_strides(std::size_t ticks) const;
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
  bool bends_vertically_;                   ///< the first joint does
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
  std::vector<double> targets_;          ///< targets of the last ticks, by tick, then by joint
  std::vector<std::uint8_t> contacts_;   ///< contacts in the last ticks, by tick, then by link
  std::vector<Eigen::Vector2d> places_;  ///< of the centre of mass in the last ticks, seen from above
};

}  // namespace proleg::sim
