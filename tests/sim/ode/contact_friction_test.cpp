#include "sim/ode/contact_friction.hpp"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "sim/ode/engine.hpp"
#include "sim/ode/ode_world.hpp"
#include "tests/sim/physics/box_link.hpp"

// Oracle: Coulomb's law for a point mass, friction = coefficient * normal force, against the velocity.

namespace proleg::sim {
namespace {

constexpr double step_s = 0.001;
constexpr double gravity = 9.81;
constexpr double degree = std::numbers::pi / 180.0;

/// A flat plate of 0.1 kg. It does not tip over.
RobotModel plate() {
  RobotModel robot;
  robot.links.push_back(box_link(0.0, {0.05, 0.03, 0.005}, 0.1));
  return robot;
}

/// The plate lies on the ground. A horizontal load, in m/s^2, pulls it towards a heading.
EnvironmentModel ground(double friction, double load, double heading_deg) {
  EnvironmentModel environment;
  StaticObject floor;
  floor.pose.position = {0, 0, -0.5};
  Geometry geometry;
  geometry.extents = {50, 50, 0.5};
  geometry.friction = friction;
  floor.geometries.push_back(geometry);
  environment.objects.push_back(floor);
  environment.robot_pose.position = {0, 0, 0.005};
  environment.gravity = {load * std::cos(heading_deg * degree), load * std::sin(heading_deg * degree), -gravity};
  return environment;
}

Eigen::Vector2d position_after(World& world, double seconds) {
  for (long i = 0; i < std::lround(seconds / step_s); ++i) {
    world.step();
  }
  return world.center_of_mass().head<2>();
}

/// Along y the plate has the friction of the ground, along x another one.
RobotModel plate_with_friction_across(double along, double across) {
  RobotModel robot = plate();
  robot.links[0].geometries[0].friction = along;
  robot.links[0].geometries[0].friction_across = across;
  return robot;
}

// A load between the two limits moves the plate along y and holds it along x; both follow Coulomb's law.
TEST(FrictionAcross, HoldsInOneDirectionAndSlidesInTheOther) {
  const double along = 0.1;
  const double across = 0.6;
  const double load = 0.3 * gravity;
  for (const auto& [heading, coefficient] : {std::pair{0.0, across}, std::pair{90.0, along}, std::pair{270.0, along}}) {
    EnvironmentModel environment = ground(0.0, load, heading);
    environment.objects[0].geometries[0].friction.reset();  // then the plate's coefficient holds
    const std::unique_ptr<World> world =
        make_ode_world(plate_with_friction_across(along, across), environment, step_s, Stepper::direct);
    const double seconds = 1.0;
    const double distance = position_after(*world, seconds).norm();
    const double acceleration = std::max(load - coefficient * gravity, 0.0);
    EXPECT_NEAR(distance, 0.5 * acceleration * seconds * seconds, 0.01) << heading;
  }
}

/// A plate on the ground in the engine itself, which a test can push and turn.
class PlateInTheEngine {
 public:
  explicit PlateInTheEngine(double friction) : friction_(friction) {
    prepare_engine_for_this_thread();
    world_ = dWorldCreate();
    space_ = dSimpleSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, 0, 0, -gravity);
    floor_ = dCreateBox(space_, 100, 100, 1);
    dGeomSetPosition(floor_, 0, 0, -0.5);
    body_ = dBodyCreate(world_);
    dMass mass;
    dMassSetBoxTotal(&mass, 1.0, 0.1, 0.06, 0.01);
    dBodySetMass(body_, &mass);
    dBodySetPosition(body_, 0, 0, 0.005);
    plate_ = dCreateBox(space_, 0.1, 0.06, 0.01);
    dGeomSetBody(plate_, body_);
  }
  ~PlateInTheEngine() {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  PlateInTheEngine(const PlateInTheEngine&) = delete;
  PlateInTheEngine& operator=(const PlateInTheEngine&) = delete;

  void set_velocity(const Eigen::Vector2d& velocity) { dBodySetLinearVel(body_, velocity.x(), velocity.y(), 0); }
  void set_spin(double speed) { dBodySetAngularVel(body_, 0, 0, speed); }
  void step(const Eigen::Vector2d& force) {
    dBodyAddForce(body_, force.x(), force.y(), 0);
    friction_of_contacts_.begin_step();
    dSpaceCollide(space_, this,
                  [](void* self, dGeomID a, dGeomID b) { static_cast<PlateInTheEngine*>(self)->collide(a, b); });
    dWorldStep(world_, step_s);
    friction_of_contacts_.end_step();
    dJointGroupEmpty(contacts_);
  }
  [[nodiscard]] Eigen::Vector2d velocity() const {
    const dReal* velocity = dBodyGetLinearVel(body_);
    return {velocity[0], velocity[1]};
  }
  [[nodiscard]] double spin() const { return dBodyGetAngularVel(body_)[2]; }

 private:
  void collide(dGeomID a, dGeomID b) {
    std::array<dContact, 8> points{};
    const int count = dCollide(a, b, 8, &points[0].geom, sizeof(dContact));
    friction_of_contacts_.begin_pair(a, b, ContactFriction::Between::robot_and_world);
    for (int i = 0; i < count; ++i) {
      dContact& point = points[static_cast<std::size_t>(i)];
      friction_of_contacts_.set_surface(point, friction_);
      const dJointID joint = dJointCreateContact(world_, contacts_, &point);
      dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
      friction_of_contacts_.observe(joint);
    }
  }

  double friction_;
  ContactFriction friction_of_contacts_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID contacts_ = nullptr;
  dGeomID floor_ = nullptr;
  dGeomID plate_ = nullptr;
  dBodyID body_ = nullptr;
};

/// The velocity of a point mass of 1 kg after a time, by Coulomb's law in small steps.
Eigen::Vector2d coulomb(Eigen::Vector2d velocity, double friction, const Eigen::Vector2d& force, double seconds) {
  constexpr int steps = 100'000;
  for (int i = 0; i < steps; ++i) {
    velocity += seconds / steps * (force - friction * gravity * velocity.normalized());
  }
  return velocity;
}

TEST(ContactFriction, OfAPlateThatSlidesGivesWayToAForceFromItsSide) {
  constexpr double friction = 0.3;
  constexpr double seconds = 0.3;
  for (const double heading : {0.0, 20.0, 45.0, 110.0}) {
    const Eigen::Rotation2Dd turn(heading * degree);
    const Eigen::Vector2d velocity = turn * Eigen::Vector2d(1.5, 0.0);
    const Eigen::Vector2d force = turn * Eigen::Vector2d(0.0, 0.6 * friction * gravity);  // less than the friction
    PlateInTheEngine plate(friction);
    for (int i = 0; i < 100; ++i) {
      plate.step({0, 0});
    }
    plate.set_velocity(velocity);
    for (long i = 0; i < std::lround(seconds / step_s); ++i) {
      plate.step(force);
    }
    const Eigen::Vector2d expected = coulomb(velocity, friction, force, seconds);
    EXPECT_GT((turn.inverse() * expected).y(), 0.2) << "the plate turns from its line";
    EXPECT_LT((plate.velocity() - expected).norm(), 0.02 * expected.norm()) << "heading " << heading;
  }
}

TEST(ContactFriction, OfAPlateThatSlidesAndSpinsIsTheSameForEveryHeading) {
  Eigen::Vector2d expected = Eigen::Vector2d::Zero();
  for (const double heading : {0.0, 30.0, 45.0}) {
    PlateInTheEngine plate(0.3);
    for (int i = 0; i < 100; ++i) {
      plate.step({0, 0});
    }
    const Eigen::Rotation2Dd turn(heading * degree);
    plate.set_velocity(turn * Eigen::Vector2d(1.0, 0.0));
    plate.set_spin(20.0);
    for (int i = 0; i < 150; ++i) {
      plate.step({0, 0});
    }
    const Eigen::Vector2d velocity = turn.inverse() * plate.velocity();
    if (heading == 0.0) {
      expected = velocity;
      EXPECT_GT(expected.x(), 0.3);
    }
    // The plate itself has another heading to its path, so its corners touch elsewhere.
    EXPECT_LT((velocity - expected).norm(), 0.03) << "heading " << heading;
  }
}

}  // namespace
}  // namespace proleg::sim
