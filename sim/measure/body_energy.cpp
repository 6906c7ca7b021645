#include "sim/measure/body_energy.hpp"

#include <cmath>

namespace proleg::sim {

BodyEnergy::BodyEnergy(const RobotModel& robot, const Pose& start, double gravity, double tick_s)
    : weight_per_mass_(gravity), ticks_per_s_(1.0 / tick_s) {
  for (const Link& link : robot.links) {
    const Pose pose = start * link.pose;
    bodies_.push_back({link.mass, pose * link.mass.center, pose.orientation});
    start_moment_ += link.mass.mass * bodies_.back().center.z();
  }
}

void BodyEnergy::add_tick(std::span<const Pose> link_poses, std::span<const double> joint_angles,
                          std::span<const double> joint_targets, std::span<const double> motor_torques) {
  double moment = 0.0;
  double kinetic = 0.0;
  for (std::size_t link = 0; link < bodies_.size(); ++link) {
    Body& body = bodies_[link];
    const Eigen::Vector3d center = link_poses[link] * body.mass.center;
    const Eigen::Vector3d velocity = (center - body.center) * ticks_per_s_;
    // The vector of a quaternion has the length of the sine of half the angle; for the turn of a tick this is half the
    // angle itself. The vector is in the frame of the link, as is the inertia.
    const Eigen::Quaterniond turn = body.orientation.conjugate() * link_poses[link].orientation;
    const Eigen::Vector3d rotation = (turn.w() < 0.0 ? -2.0 : 2.0) * ticks_per_s_ * turn.vec();
    kinetic += 0.5 * (body.mass.mass * velocity.squaredNorm() + rotation.dot(body.mass.inertia * rotation));
    moment += body.mass.mass * center.z();
    body.center = center;
    body.orientation = link_poses[link].orientation;
  }
  kinetic_sum_ += kinetic;
  potential_sum_ += weight_per_mass_ * (moment - start_moment_);
  for (std::size_t joint = 0; joint < motor_torques.size(); ++joint) {
    elastic_sum_ += 0.5 * std::abs(motor_torques[joint] * (joint_targets[joint] - joint_angles[joint]));
  }
  ++ticks_;
}

}  // namespace proleg::sim
