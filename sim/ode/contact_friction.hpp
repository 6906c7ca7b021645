#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <Eigen/Core>

#include "sim/physics/contact_sliding.hpp"

namespace proleg::sim {

/// Coulomb friction at the contact points of a world: at most coefficient * normal force, in every direction.
///
/// The engine limits the friction of a contact point along two axes, each on its own. With axes that are fixed in the
/// world, friction on the diagonal is 1.41 times as large. This class chooses the axes of every point in every step:
///
/// - A point that slides has its first axis along its velocity. Friction along the second axis must not hold the point
///   on its line: there it is proportional to the sideways speed v2, as for small v2 in Coulomb's law,
///     -coefficient * normal force * v / |v|  ~  -(coefficient * normal force / |v|) * v2
///   The engine calls this force-dependent slip.
/// - A point that sticks has its first axis along the friction of the step before. A load that is too large in any
///   direction therefore moves the robot one step later.
/// - A point that does not move and has no step before has its first axis along its link.
///
/// All axes turn with the robot and its motion. Therefore a run does not depend on the robot's heading.
class ContactFriction {
 public:
  /// Must be called before the contacts of a step.
  void begin_step();
  /// Kinds of pairs that touch; the kind decides what the sums of sliding() count.
  enum class Between : std::uint8_t {
    robot_and_world,  ///< a link, and the environment or an object that moves
    links,            ///< counts for nothing
    objects,          ///< an object that moves, and another or the environment: only friction_power
  };
  /// Must be called before the contact points of two shapes that touch.
  void begin_pair(dGeomID a, dGeomID b, Between between);
  /// Sets the surface of a contact point whose friction is not the same in every direction: the engine limits it along
  /// two fixed axes. axis: the body's axis, in the world; along, across: coefficients along it and across it.
  void set_surface(dContact& contact, const Eigen::Vector3d& axis, double along, double across);
  /// Sets the surface of a contact point, without its geometry.
  void set_surface(dContact& contact, double coefficient);
  /// Notes the joint of the contact of the last set_surface(), which must be attached to its bodies.
  void observe(dJointID joint);
  /// Must be called after the step, before its contact joints are destroyed.
  void end_step();
  /// Sums over the robot's contact points with the world in the last step.
  [[nodiscard]] const ContactSliding& sliding() const { return sliding_; }
  /// Calls visit(a, b, normal force in N) for each two shapes that touched in the last step.
  template <typename Visitor>
  void for_each_pair(Visitor&& visit) const {
    for (const Pair& pair : pairs_before_) {
      visit(pair.a, pair.b, pair.normal_force);
    }
  }

 private:
  /// Two shapes that touch, and their bodies; the environment has no body.
  struct Pair {
    dGeomID a;
    dGeomID b;
    dBodyID body_a;
    dBodyID body_b;
    Between between;
    std::size_t points = 0;
    double normal_force = 0.0;                           ///< sum of its points, N
    Eigen::Vector3d friction = Eigen::Vector3d::Zero();  ///< sum of its points on either shape, N
  };
  /// A contact point of this step.
  struct Point {
    std::size_t pair;  ///< index in pairs_
    Eigen::Vector3d position;
    Eigen::Vector3d normal;
    Eigen::Vector3d velocity;  ///< sliding velocity before the step, m/s
    dJointFeedback feedback;
  };

  Point& note_point(const dContact& contact);
  [[nodiscard]] static Eigen::Vector3d sliding_velocity(const Pair& pair, const Eigen::Vector3d& point,
                                                        const Eigen::Vector3d& normal);

  std::vector<Pair> pairs_before_;  ///< pairs of the step before, with their forces
  std::vector<Pair> pairs_;         ///< pairs of this step
  std::deque<Point> points_;        ///< points, not all in use; the engine keeps pointers to their feedback
  std::size_t point_count_ = 0;
  const Pair* before_ = nullptr;  ///< the present pair in the step before, if it touched then
  ContactSliding sliding_;
};

}  // namespace proleg::sim
