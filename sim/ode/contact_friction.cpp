#include "sim/ode/contact_friction.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::sim {
namespace {

/// Least sliding speed, m/s. Below it, the direction of the velocity may be an error of the solver.
constexpr double min_sliding_speed = 1e-3;

/// Velocity of a point of a body, [m/s]: v + w x (point - centre of mass), with the same bits as dBodyGetPointVel(). No
/// body is at rest.
inline Eigen::Vector3d point_velocity(dBodyID body, const Eigen::Vector3d& point) {
  if (body == nullptr) {
    return Eigen::Vector3d::Zero();
  }
  const dReal* middle = dBodyGetPosition(body);
  const dReal* velocity = dBodyGetLinearVel(body);
  const dReal* turning = dBodyGetAngularVel(body);
  const double x = point.x() - middle[0];
  const double y = point.y() - middle[1];
  const double z = point.z() - middle[2];
  return {velocity[0] + (turning[1] * z - turning[2] * y), velocity[1] + (turning[2] * x - turning[0] * z),
          velocity[2] + (turning[0] * y - turning[1] * x)};
}

inline Eigen::Vector3d tangential(const Eigen::Vector3d& vector, const Eigen::Vector3d& normal) {
  return vector - vector.dot(normal) * normal;
}

/// A direction in the plane of contact that turns with the link.
Eigen::Vector3d axis_of_link(dBodyID body, const Eigen::Vector3d& normal) {
  const dReal* rotation = dBodyGetRotation(body);  // 3 rows of 4
  const Eigen::Vector3d x = tangential({rotation[0], rotation[4], rotation[8]}, normal);
  const Eigen::Vector3d y = tangential({rotation[1], rotation[5], rotation[9]}, normal);
  return x.squaredNorm() > y.squaredNorm() ? x : y;
}

inline void set_first_axis(dContact& contact, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d axis = direction.normalized();
  contact.surface.mode |= dContactFDir1;
  contact.fdir1[0] = axis.x();
  contact.fdir1[1] = axis.y();
  contact.fdir1[2] = axis.z();
  contact.fdir1[3] = 0.0;
}

}  // namespace

void ContactFriction::begin_step() {
  pairs_.clear();
  point_count_ = 0;
}

void ContactFriction::begin_pair(dGeomID a, dGeomID b, Between between) {
  const auto found = std::ranges::find_if(pairs_before_, [&](const Pair& pair) { return pair.a == a && pair.b == b; });
  before_ = found == pairs_before_.end() ? nullptr : &*found;
  pairs_.push_back({a, b, dGeomGetBody(a), dGeomGetBody(b), between});
}

/// Sliding velocity of the first shape of a pair relative to the second.
inline Eigen::Vector3d ContactFriction::sliding_velocity(const Pair& pair, const Eigen::Vector3d& point,
                                                         const Eigen::Vector3d& normal) {
  return tangential(point_velocity(pair.body_a, point) - point_velocity(pair.body_b, point), normal);
}

/// Notes a point of the present pair. It counts when observe() has its joint.
inline ContactFriction::Point& ContactFriction::note_point(const dContact& contact) {
  if (point_count_ == points_.size()) {
    points_.emplace_back();
  }
  Point& point = points_[point_count_];
  point.pair = pairs_.size() - 1;
  point.position = {contact.geom.pos[0], contact.geom.pos[1], contact.geom.pos[2]};
  point.normal = {contact.geom.normal[0], contact.geom.normal[1], contact.geom.normal[2]};
  point.velocity = sliding_velocity(pairs_.back(), point.position, point.normal);
  return point;
}

void ContactFriction::set_surface(dContact& contact, const Eigen::Vector3d& axis, double along, double across) {
  constexpr double least_projection = 0.1;
  const Point& point = note_point(contact);
  contact.surface.mode = dContactApprox1 | dContactMu2;
  contact.surface.mu = along;
  contact.surface.mu2 = across;
  const Eigen::Vector3d direction = tangential(axis, point.normal);
  if (direction.norm() > least_projection) {
    set_first_axis(contact, direction);
  } else {
    contact.surface.mu2 = along;  // the body stands on its end
  }
}

void ContactFriction::set_surface(dContact& contact, double coefficient) {
  const Point& point = note_point(contact);
  // In this mode mu is a coefficient; without it, mu would be a force.
  contact.surface.mode = dContactApprox1;
  contact.surface.mu = coefficient;
  if (coefficient <= 0.0) {
    return;
  }
  const double speed = point.velocity.norm();
  if (speed > min_sliding_speed) {
    set_first_axis(contact, point.velocity);
    if (before_ != nullptr && before_->normal_force > 0.0) {
      contact.surface.mode |= dContactSlip2;
      contact.surface.slip2 =
          speed * static_cast<double>(before_->points) / (coefficient * before_->normal_force);  // m/s per N
    }
    return;
  }
  const Eigen::Vector3d friction =
      before_ != nullptr ? tangential(before_->friction, point.normal) : Eigen::Vector3d::Zero();
  const Pair& pair = pairs_.back();
  set_first_axis(contact, friction.squaredNorm() > 0.0
                              ? friction
                              : axis_of_link(pair.body_a != nullptr ? pair.body_a : pair.body_b, point.normal));
}

void ContactFriction::observe(dJointID joint) { dJointSetFeedback(joint, &points_[point_count_++].feedback); }

void ContactFriction::end_step() {
  sliding_ = {};
  for (std::size_t i = 0; i < point_count_; ++i) {
    const Point& point = points_[i];
    const Eigen::Vector3d force(point.feedback.f1[0], point.feedback.f1[1], point.feedback.f1[2]);
    const double normal_force = std::abs(force.dot(point.normal));
    Pair& pair = pairs_[point.pair];
    pair.points += 1;
    pair.normal_force += normal_force;
    pair.friction += tangential(force, point.normal);
    if (pair.between != Between::links) {
      const Eigen::Vector3d velocity = sliding_velocity(pair, point.position, point.normal);
      if (pair.between == Between::robot_and_world) {
        sliding_.normal_force += normal_force;
        sliding_.force_times_speed += normal_force * velocity.norm();
      }
      // A force times the mean of the speeds before and after a step is the power that the step takes. Friction always
      // takes energy, but the sign of the engine's force depends on the order of the bodies.
      sliding_.friction_power += std::abs(force.dot(0.5 * (velocity + point.velocity)));
    }
  }
  pairs_before_.swap(pairs_);
}

}  // namespace proleg::sim
