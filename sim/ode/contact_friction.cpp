#include "sim/ode/contact_friction.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::sim {
namespace {

/// Least sliding speed, m/s. Below it, the direction of the velocity may be an error of the solver.
constexpr double min_sliding_speed = 1e-3;

Eigen::Vector3d point_velocity(dGeomID shape, const Eigen::Vector3d& point) {
  const dBodyID body = dGeomGetBody(shape);
  if (body == nullptr) {
    return Eigen::Vector3d::Zero();
  }
  dVector3 velocity;
  dBodyGetPointVel(body, point.x(), point.y(), point.z(), velocity);
  return {velocity[0], velocity[1], velocity[2]};
}

Eigen::Vector3d tangential(const Eigen::Vector3d& vector, const Eigen::Vector3d& normal) {
  return vector - vector.dot(normal) * normal;
}

/// Sliding velocity of shape a relative to shape b.
Eigen::Vector3d sliding_velocity(dGeomID a, dGeomID b, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  return tangential(point_velocity(a, point) - point_velocity(b, point), normal);
}

/// A direction in the plane of contact that turns with the link.
Eigen::Vector3d axis_of_link(dGeomID a, dGeomID b, const Eigen::Vector3d& normal) {
  const dBodyID body = dGeomGetBody(a) != nullptr ? dGeomGetBody(a) : dGeomGetBody(b);
  const dReal* rotation = dBodyGetRotation(body);  // 3 rows of 4
  const Eigen::Vector3d x = tangential({rotation[0], rotation[4], rotation[8]}, normal);
  const Eigen::Vector3d y = tangential({rotation[1], rotation[5], rotation[9]}, normal);
  return x.squaredNorm() > y.squaredNorm() ? x : y;
}

void set_first_axis(dContact& contact, const Eigen::Vector3d& direction) {
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

const ContactFriction::Pair* ContactFriction::before(dGeomID a, dGeomID b) const {
  const auto found = std::ranges::find_if(pairs_before_, [&](const Pair& pair) { return pair.a == a && pair.b == b; });
  return found == pairs_before_.end() ? nullptr : &*found;
}

std::size_t ContactFriction::pair_of(dGeomID a, dGeomID b, Between between) {
  // The engine reports all points of a pair one after another.
  if (pairs_.empty() || pairs_.back().a != a || pairs_.back().b != b) {
    pairs_.push_back({a, b, between});
  }
  return pairs_.size() - 1;
}

void ContactFriction::note_point(const dContact& contact, dGeomID a, dGeomID b, Between between) {
  next_.pair = pair_of(a, b, between);
  next_.position = {contact.geom.pos[0], contact.geom.pos[1], contact.geom.pos[2]};
  next_.normal = {contact.geom.normal[0], contact.geom.normal[1], contact.geom.normal[2]};
  next_.velocity = sliding_velocity(a, b, next_.position, next_.normal);
}

void ContactFriction::set_surface(dContact& contact, const Eigen::Vector3d& axis, double along, double across,
                                  dGeomID a, dGeomID b, Between between) {
  constexpr double least_projection = 0.1;
  note_point(contact, a, b, between);
  contact.surface.mode = dContactApprox1 | dContactMu2;
  contact.surface.mu = along;
  contact.surface.mu2 = across;
  const Eigen::Vector3d direction = tangential(axis, next_.normal);
  if (direction.norm() > least_projection) {
    set_first_axis(contact, direction);
  } else {
    contact.surface.mu2 = along;  // the body stands on its end
  }
}

void ContactFriction::set_surface(dContact& contact, double coefficient, dGeomID a, dGeomID b, Between between) {
  note_point(contact, a, b, between);
  const Eigen::Vector3d& normal = next_.normal;
  // In this mode mu is a coefficient; without it mu would be a force.
  contact.surface.mode = dContactApprox1;
  contact.surface.mu = coefficient;
  if (coefficient <= 0.0) {
    return;
  }
  const Pair* const last = before(a, b);
  const Eigen::Vector3d& velocity = next_.velocity;
  const double speed = velocity.norm();
  if (speed > min_sliding_speed) {
    set_first_axis(contact, velocity);
    if (last != nullptr && last->normal_force > 0.0) {
      contact.surface.mode |= dContactSlip2;
      contact.surface.slip2 =
          speed * static_cast<double>(last->points) / (coefficient * last->normal_force);  // m/s per N
    }
    return;
  }
  const Eigen::Vector3d friction = last != nullptr ? tangential(last->friction, normal) : Eigen::Vector3d::Zero();
  set_first_axis(contact, friction.squaredNorm() > 0.0 ? friction : axis_of_link(a, b, normal));
}

void ContactFriction::observe(dJointID joint) {
  if (point_count_ == points_.size()) {
    points_.emplace_back();
  }
  Point& point = points_[point_count_++];
  point.pair = next_.pair;
  point.position = next_.position;
  point.normal = next_.normal;
  point.velocity = next_.velocity;
  dJointSetFeedback(joint, &point.feedback);
}

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
      const Eigen::Vector3d velocity = sliding_velocity(pair.a, pair.b, point.position, point.normal);
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
