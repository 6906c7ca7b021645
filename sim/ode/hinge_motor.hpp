#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// A hinge with its motor: the angle, the stops, and the torque that the motor gives.
///
/// The engine reports the force and the torque that the whole hinge exerts on the centre of mass of its first link.
/// Both include the force of the bearing. The motor's part is
///   torque * axis - force * moment,  moment = axis x (anchor - centre of mass)
///
/// The engine computes the angle of a hinge with stops in every step, only to see whether it is at a stop. This class
/// computes it once a step and makes the same test. The engine has the stops while they can be reached: the motion is
/// the same.
class HingeMotor {
 public:
  /// hinge: the hinge of the joint, with its stops; body: the body of the link, which must be the hinge's first. The
  /// engine keeps a pointer to this object until the hinge is destroyed, so it must not move.
  void attach(dJointID hinge, dBodyID body, const Joint& joint, const Link& link);

  void set_speed(double speed) { dJointSetHingeParam(hinge_, dParamVel, speed); }  ///< rad/s
  void set_max_torque(double torque);                                              ///< Nm

  /// Must be called before each step.
  void begin_step();
  /// Must be called after each step, and when the bodies were moved.
  void end_step() { angle_ = dJointGetHingeAngle(hinge_); }
  [[nodiscard]] double angle() const { return angle_; }  ///< rad
  /// Torque in the last step, Nm; 0 before the first step.
  [[nodiscard]] double torque() const;

 private:
  dJointID hinge_ = nullptr;
  dBodyID body_ = nullptr;
  dJointFeedback feedback_{};
  double max_torque_ = 0.0;  ///< Nm
  double lower_stop_ = 0.0;  ///< rad
  double upper_stop_ = 0.0;
  double angle_ = 0.0;       ///< rad
  bool was_at_stop_ = true;  ///< at the start of the last step
  bool has_stops_ = true;    ///< the engine has the stops
  Eigen::Vector3d axis_in_link_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_in_link_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();  ///< axis in the world, at the start of the last step
  Eigen::Vector3d moment_ = Eigen::Vector3d::Zero();
};

}  // namespace proleg::sim
