#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// The motor of a hinge, and the torque that it gives.
///
/// The engine reports the force and the torque that the whole hinge exerts on the centre of mass of its first link.
/// Both include the force of the bearing. The motor's part is
///   torque * axis - force * moment,  moment = axis x (anchor - centre of mass)
class HingeMotor {
 public:
  /// hinge: the hinge of the joint; body: the body of the link, which must be the hinge's first. The engine keeps a
  /// pointer to this object until the hinge is destroyed, so it must not move.
  void attach(dJointID hinge, dBodyID body, const Joint& joint, const Link& link);

  void set_speed(double speed) { dJointSetHingeParam(hinge_, dParamVel, speed); }  ///< rad/s
  void set_max_torque(double torque);                                              ///< Nm

  /// Must be called before each step.
  void note_axis();
  /// Torque in the last step, Nm; 0 before the first step.
  [[nodiscard]] double torque() const;

 private:
  dJointID hinge_ = nullptr;
  dBodyID body_ = nullptr;
  dJointFeedback feedback_{};
  double max_torque_ = 0.0;  ///< Nm
  Eigen::Vector3d axis_in_link_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_in_link_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_ = Eigen::Vector3d::Zero();  ///< axis in the world, at the start of the last step
  Eigen::Vector3d moment_ = Eigen::Vector3d::Zero();
};

}  // namespace proleg::sim
