#include "sim/ode/hinge_motor.hpp"

#include <algorithm>

namespace proleg::sim {
namespace {

/// Rotates a vector. rotation: 3 rows of 4 numbers, as the engine has it.
inline Eigen::Vector3d rotated(const dReal* rotation, const Eigen::Vector3d& vector) {
  return {rotation[0] * vector.x() + rotation[1] * vector.y() + rotation[2] * vector.z(),
          rotation[4] * vector.x() + rotation[5] * vector.y() + rotation[6] * vector.z(),
          rotation[8] * vector.x() + rotation[9] * vector.y() + rotation[10] * vector.z()};
}

inline double dot(const dReal* a, const Eigen::Vector3d& b) { return a[0] * b.x() + a[1] * b.y() + a[2] * b.z(); }

}  // namespace

void HingeMotor::attach(dJointID hinge, dBodyID body, const Joint& joint, const Link& link) {
  hinge_ = hinge;
  body_ = body;
  const Eigen::Quaterniond to_link = link.pose.orientation.conjugate();
  const Eigen::Vector3d arm = to_link * (joint.anchor - link.pose.position) - link.mass.center;
  axis_in_link_ = to_link * joint.axis.normalized();
  moment_in_link_ = axis_in_link_.cross(arm);
  set_max_torque(joint.max_torque);
  set_speed(0.0);
  dJointSetFeedback(hinge, &feedback_);
  lower_stop_ = dJointGetHingeParam(hinge, dParamLoStop);
  upper_stop_ = dJointGetHingeParam(hinge, dParamHiStop);
  end_step();
}

void HingeMotor::set_max_torque(double torque) {
  dJointSetHingeParam(hinge_, dParamFMax, torque);
  max_torque_ = torque;
}

void HingeMotor::begin_step() {
  // The engine notes in a step with stops that the angle is at none of them. Therefore it keeps them one step longer.
  const bool is_at_stop = angle_ <= lower_stop_ || angle_ >= upper_stop_;
  if (const bool needs_stops = is_at_stop || was_at_stop_; needs_stops != has_stops_) {
    has_stops_ = needs_stops;
    dJointSetHingeParam(hinge_, dParamLoStop, needs_stops ? lower_stop_ : -dInfinity);
    dJointSetHingeParam(hinge_, dParamHiStop, needs_stops ? upper_stop_ : dInfinity);
  }
  was_at_stop_ = is_at_stop;

  const dReal* rotation = dBodyGetRotation(body_);
  axis_ = rotated(rotation, axis_in_link_);
  moment_ = rotated(rotation, moment_in_link_);
}

double HingeMotor::torque() const {
  return std::clamp(dot(feedback_.t1, axis_) - dot(feedback_.f1, moment_), -max_torque_, max_torque_);
}

}  // namespace proleg::sim
