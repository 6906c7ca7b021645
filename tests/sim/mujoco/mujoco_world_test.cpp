// Oracles: mechanics of rigid bodies, and ODE where both engines must agree.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/ode/ode_world.hpp"
#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/small_world.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim::mujoco {
namespace {

std::unique_ptr<World> mujoco_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_mujoco_world(robot, environment, step_s, "test");
}
std::unique_ptr<World> ode_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::direct);
}

EnvironmentModel weightless() {
  EnvironmentModel environment;
  environment.gravity.setZero();
  return environment;
}

Eigen::Quaterniond turn(double rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, axis.normalized()));
}

void expect_near(const Pose& pose, const Pose& expected, double tolerance, const std::string& name) {
  EXPECT_LT((pose.position - expected.position).norm(), tolerance) << name;
  EXPECT_LT(pose.orientation.angularDistance(expected.orientation), tolerance) << name;
}

TEST(MujocoWorld, StartsWithTheLinksWhereTheModelPutsThem) {
  RobotModel robot = chain(3);
  robot.links[1].mass.center = {0.001, 0.002, 0.003};
  robot.links[2].pose.orientation = turn(0.4, {1, 2, 3});
  EnvironmentModel environment;
  environment.robot_pose = {{1, 2, 3}, turn(1.2, {3, -1, 2})};
  const std::unique_ptr<World> world = mujoco_world(robot, environment);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Pose pose = environment.robot_pose * robot.links[i].pose;
    expect_near(world->link_pose(i), pose, 1e-9, "link " + std::to_string(i));
    center += pose * robot.links[i].mass.center / 3.0;
  }
  EXPECT_LT((world->center_of_mass() - center).norm(), 1e-9);
  EXPECT_EQ(world->joint_angle(0), 0.0);
  EXPECT_EQ(world->contact_count(), 0U);
  EXPECT_EQ(world->motor_torque(0), 0.0);
}

TEST(MujocoWorld, ALinkInTheAirFallsFreelyAndKeepsItsEnergy) {
  for (const Integrator integrator : {Integrator::implicit, Integrator::euler}) {
    const std::unique_ptr<World> world = make_mujoco_world(chain(1), EnvironmentModel{}, step_s, "test", integrator);
    const double energy = world->energy();
    constexpr double seconds = 0.5;
    run(*world, seconds);
    // Semi-implicit Euler falls g t^2 / 2 + g t h / 2.
    EXPECT_NEAR(world->center_of_mass().z(), -gravity * seconds * (seconds + step_s) / 2, 1e-9);
    EXPECT_NEAR(world->energy(), energy, 0.1 * gravity * gravity * seconds * step_s / 2 + 1e-9);
    EXPECT_TRUE(world->is_slower_than(gravity * seconds * 1.001, 1e-9));
    EXPECT_FALSE(world->is_slower_than(gravity * seconds * 0.999, 1.0));
  }
}

TEST(MujocoWorld, AJointThatTurnsMakesItsLinksNotSlow) {
  const std::unique_ptr<World> world = mujoco_world(chain(2), weightless());
  EXPECT_TRUE(world->is_slower_than(1e-9, 1e-9));
  world->set_joint_speed(0, 1.0);
  run(*world, 0.1);
  EXPECT_TRUE(world->is_slower_than(1.0, 0.51)) << "each link turns at half the speed";
  EXPECT_FALSE(world->is_slower_than(1.0, 0.49));
  // Their middles hardly move.
  const double inertia = 0.1 / 12.0 * (0.08 * 0.08 + 0.04 * 0.04);  // of a box
  EXPECT_NEAR(world->energy() / (2 * 0.5 * inertia * 0.5 * 0.5), 1.0, 0.02);
}

TEST(MujocoWorld, TheContactsCarryTheWeight) {
  for (const Shape shape : {Shape::box, Shape::sphere, Shape::cylinder}) {
    RobotModel robot = chain(3);
    for (Link& link : robot.links) {
      link.geometries[0].shape = shape;
      link.geometries[0].extents = {0.02, 0.04, 0.02};
    }
    const std::unique_ptr<World> world = mujoco_world(robot, flat_ground(0.5, 0.02));
    EXPECT_EQ(world->contact_force(0), 0.0);
    run(*world, 2.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += world->contact_force(i);
    }
    EXPECT_NEAR(sum / (0.3 * gravity), 1.0, 1e-3);
    EXPECT_NEAR(world->contact_sliding().normal_force, sum, 1e-9);
    EXPECT_NEAR(world->center_of_mass().z(), 0.02, 1e-3);
    EXPECT_TRUE(world->is_slower_than(1e-3, 1e-2)) << static_cast<int>(shape);
  }
}

class MujocoLoads : public testing::TestWithParam<double> {
 protected:
  double heading_ = GetParam() * std::numbers::pi / 180.0;
  Eigen::Vector2d direction_{std::cos(heading_), std::sin(heading_)};

  /// A flat link on the ground, pulled sideways.
  [[nodiscard]] std::unique_ptr<World> pulled(double friction, double load) const {
    RobotModel plate;
    plate.links.push_back(box_link(0, {0.05, 0.03, 0.005}, 1.0));
    EnvironmentModel environment = flat_ground(friction, 0.005);
    environment.gravity.head<2>() = load * direction_;
    return mujoco_world(plate, environment);
  }
};

TEST_P(MujocoLoads, AboveTheFrictionAccelerateTheRobotByTheDifference) {
  constexpr double load = 4.0;
  for (const double friction : {0.0, 0.1, 0.3, 0.39}) {
    const std::unique_ptr<World> world = pulled(friction, load);
    const auto after = [&](double seconds) -> Eigen::Vector2d {
      run(*world, seconds);
      return world->center_of_mass().head<2>();
    };
    const Eigen::Vector2d start = after(0.2);
    const Eigen::Vector2d middle = after(0.4);
    const Eigen::Vector2d acceleration = (after(0.4) - 2.0 * middle + start) / (0.4 * 0.4);
    const double expected = load - friction * gravity;
    EXPECT_NEAR(acceleration.dot(direction_), expected, 0.02) << "friction " << friction;
    EXPECT_LT((acceleration - acceleration.dot(direction_) * direction_).norm(), 0.02) << "friction " << friction;
  }
}

TEST_P(MujocoLoads, BelowTheFrictionDoNotMoveTheRobot) {
  for (const double share : {0.5, 0.95}) {
    constexpr double friction = 0.4;
    const std::unique_ptr<World> world = pulled(friction, share * friction * gravity);
    run(*world, 0.2);
    const Eigen::Vector3d start = world->center_of_mass();
    run(*world, 1.0);
    EXPECT_LT((world->center_of_mass() - start).norm(), 1e-3) << share << " of the friction";
  }
}

INSTANTIATE_TEST_SUITE_P(Headings, MujocoLoads, testing::Values(0.0, 10.0, 30.0, 45.0, 90.0, 200.0));

TEST(MujocoWorld, FrictionTakesTheEnergyThatASlidingLinkLoses) {
  EnvironmentModel environment = flat_ground(0.3, 0.02);
  environment.gravity.y() = -5.0;
  const std::unique_ptr<World> world = mujoco_world(chain(1), environment);
  run(*world, 0.5);
  const double before = world->energy();
  double taken = 0.0;
  for (int i = 0; i < 500; ++i) {
    world->step();
    taken += world->contact_sliding().friction_power * step_s;
  }
  EXPECT_GT(taken, 0.1);
  EXPECT_NEAR(before - world->energy(), taken, 0.03 * taken);
  EXPECT_EQ(world->contact_count(), 4U) << "a link that slides touches the ground in every step";
}

TEST(MujocoWorld, APositiveJointAngleRaisesTheLinkInFrontAsInOde) {
  EnvironmentModel environment = weightless();
  environment.robot_pose.orientation = turn(2.5, {0, 0, 1});
  RobotModel robot = chain(3);
  robot.joints[1].axis = Eigen::Vector3d(1, 0, 1).normalized();
  const std::unique_ptr<World> world = mujoco_world(robot, environment);
  const std::unique_ptr<World> ode = ode_world(robot, environment);
  for (World* each : {world.get(), ode.get()}) {
    each->set_joint_speed(0, 1.0);
    each->set_joint_speed(1, 0.4);
    run(*each, 0.5);
  }
  EXPECT_NEAR(world->joint_angle(0), 0.5, 1e-3);
  EXPECT_NEAR(world->joint_angle(1), 0.2, 1e-3);
  EXPECT_GT((world->link_pose(0).orientation * Eigen::Vector3d::UnitY()).z(), 0.1);
  for (std::size_t link = 0; link < 3; ++link) {
    expect_near(world->link_pose(link), ode->link_pose(link), 3e-3, "link " + std::to_string(link));
  }
}

/// The last link is a heavy foot on the edge of a floor; the other one reaches out over the edge.
struct Arm {
  explicit Arm() : robot(chain(2)), environment(flat_ground(1.0, 0.02)) {
    robot.links.back().mass.mass = 100.0;
    robot.links.back().mass.inertia *= 1000.0;
    environment.objects[0].pose.position.y() = robot.links.back().pose.position.y() + 0.01 - 50.0;
  }
  RobotModel robot;
  EnvironmentModel environment;
};

TEST(MujocoWorld, AMotorGivesTheTorqueThatHoldsItsLink) {
  const Arm arm;
  const std::unique_ptr<World> world = mujoco_world(arm.robot, arm.environment);
  run(*world, 1.0);
  EXPECT_NEAR(world->motor_torque(0), 0.1 * gravity * 0.05, 1e-3);
}

TEST(MujocoWorld, AMotorDoesNotExceedItsTorque) {
  // The arm takes 0.049 Nm.
  for (const double torque : {0.04, 0.06}) {
    Arm arm;
    arm.robot.joints[0].max_torque = torque;
    const std::unique_ptr<World> world = mujoco_world(arm.robot, arm.environment);
    for (int i = 0; i < 1000; ++i) {
      world->set_joint_speed(0, 0.5);
      world->step();
      EXPECT_LE(std::abs(world->motor_torque(0)), torque);
    }
    if (torque < 0.049) {
      EXPECT_LT(world->joint_angle(0), -0.5);
    } else {
      EXPECT_GT(world->joint_angle(0), 0.3);
    }
  }
}

TEST(MujocoWorld, AJammedJointStaysAndALimpOneFallsToItsStop) {
  const Arm arm;
  const std::unique_ptr<World> world = mujoco_world(arm.robot, arm.environment);
  world->set_joint_torque(0, 40.0);
  world->set_joint_speed(0, 0.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(0), 0.0, 1e-2);
  world->set_joint_torque(0, 0.0);
  for (int i = 0; i < 3000; ++i) {
    world->step();
    EXPECT_GT(world->joint_angle(0), -1.02) << "at most the way of a step";
    EXPECT_EQ(world->motor_torque(0), 0.0);
  }
  EXPECT_NEAR(world->joint_angle(0), -1.0, 1e-3);
}

TEST(MujocoWorld, AJointStopsAtItsLimitsAlsoIfTheyAreEqual) {
  RobotModel robot = chain(4);
  robot.joints[0].lower_limit = -0.2;
  robot.joints[1].axis = -Eigen::Vector3d::UnitX();
  robot.joints[1].upper_limit = 0.3;
  robot.joints[2].lower_limit = robot.joints[2].upper_limit = 0.0;
  const std::unique_ptr<World> world = mujoco_world(robot, weightless());
  for (int i = 0; i < 1000; ++i) {
    world->set_joint_speed(0, -2.0);
    world->set_joint_speed(1, 2.0);
    world->set_joint_speed(2, 2.0);
    world->step();
  }
  EXPECT_NEAR(world->joint_angle(0), -0.2, 2e-3);
  EXPECT_NEAR(world->joint_angle(1), 0.3, 2e-3);
  EXPECT_NEAR(world->joint_angle(2), 0.0, 2e-3);
}

/// The sensors of the middle of three links when a small ball touches it. The ball just reaches the point `surface` of
/// the link, from the direction `outwards`; nothing moves.
std::uint8_t touched_by_a_ball(const Eigen::Vector3d& surface, const Eigen::Vector3d& outwards) {
  constexpr double radius = 0.004;
  constexpr double depth = 0.0001;
  EnvironmentModel environment = weightless();
  StaticObject ball;
  Geometry geometry;
  geometry.shape = Shape::sphere;
  geometry.extents = {radius, 0, 0};
  ball.pose.position = Eigen::Vector3d(0, -0.1, 0) + surface + (radius - depth) * outwards;
  ball.geometries.push_back(geometry);
  environment.objects.push_back(ball);
  const std::unique_ptr<World> world = mujoco_world(chain(3), environment);
  world->step();
  EXPECT_EQ(world->contact_count(), 1U) << surface.transpose();
  EXPECT_EQ(world->link_contacts(0), 0U);
  EXPECT_EQ(world->link_contacts(2), 0U);
  return world->link_contacts(1);
}

TEST(MujocoWorld, SensorsLieUnderTheLinkAndIgnoreItsBackAndFlanks) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  EXPECT_EQ(touched_by_a_ball({0, 0.03, -0.02}, -z), 2U);
  EXPECT_EQ(touched_by_a_ball({0.01, -0.03, -0.02}, -z), 1U);
  EXPECT_EQ(touched_by_a_ball({0, 0.03, 0.02}, z), 0U);
  EXPECT_EQ(touched_by_a_ball({0.02, 0.03, -0.01}, x), 0U);
  EXPECT_EQ(touched_by_a_ball({0, 0.04, -0.01}, y), 2U);
  EXPECT_EQ(touched_by_a_ball({0, -0.04, -0.01}, -y), 1U);
  EXPECT_EQ(touched_by_a_ball({0, 0.04, 0.01}, y), 0U);
}

TEST(MujocoWorld, SelfCollisionSeparatesLinksThatAreNotNeighbours) {
  for (const bool self_collision : {false, true}) {
    EnvironmentModel environment = weightless();
    environment.self_collision = self_collision;
    RobotModel robot = chain(3);
    for (Joint& joint : robot.joints) {
      joint.lower_limit = -3.0;
      joint.upper_limit = 3.0;
    }
    const std::unique_ptr<World> world = mujoco_world(robot, environment);
    for (int i = 0; i < 4000; ++i) {
      world->set_joint_speed(0, 1.0);
      world->set_joint_speed(1, 1.0);
      world->step();
    }
    const double folded = world->joint_angle(0) + world->joint_angle(1);
    if (self_collision) {
      EXPECT_LT(folded, 5.2);
      EXPECT_GT(world->contact_force(0), 0.0);
      EXPECT_NEAR(world->contact_force(0), world->contact_force(2), 1e-9) << "action and reaction";
      EXPECT_EQ(world->contact_force(1), 0.0);
      EXPECT_EQ(world->contact_sliding().normal_force, 0.0) << "not with the environment";
      EXPECT_EQ(world->link_contacts(0), 0U);
    } else {
      EXPECT_GT(folded, 5.8);
    }
  }
}

// MuJoCo's issue 3476: of two boxes whose faces just meet it sometimes reports a contact as deep as a box.
TEST(MujocoWorld, ALinkWhoseFaceJustMeetsAnotherBoxIsNotThrownAway) {
  std::mt19937_64 random(1);
  const auto draw = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  EnvironmentModel environment = weightless();
  StaticObject terrace = floor_with_friction(0.5);
  terrace.geometries[0].extents = {1.0, 0.6, 0.015};
  terrace.pose.position = {0, 0.6, -0.015};
  environment.objects.push_back(terrace);
  const std::unique_ptr<World> world = mujoco_world(chain(1), environment);
  for (int i = 0; i < 20'000; ++i) {
    // A place in the front of the link, 40 mm from its middle, is at the upper edge of the terrace.
    const Eigen::Vector3d front(0, 0.04 + draw(-2e-4, 2e-4), draw(-0.019, 0.019));
    const Eigen::Quaterniond tilt = turn(draw(-0.05, 0.05), {1, 0, 0});
    world->move_robot(Pose{-(tilt * front), tilt} * world->link_pose(0).inverse());
    world->step();
    ASSERT_TRUE(world->is_slower_than(1.0, 50.0)) << "place " << i;
  }
}

/// A step of a run that bends, slips and touches.
void wriggle(World& world, std::size_t joints, int step) {
  for (std::size_t joint = 0; joint < joints; ++joint) {
    world.set_joint_speed(joint, 3.0 * std::sin(0.01 * step + static_cast<double>(joint)));
  }
  world.step();
}

TEST(MujocoWorld, ARobotIsMovedAsARigidBodyAndRests) {
  const Pose motion{{0.3, -0.2, 0.05}, turn(0.4, {0, 0, 1})};
  const std::unique_ptr<World> world = mujoco_world(chain(4), flat_ground(0.5, 0.02));
  for (int i = 0; i < 300; ++i) {
    wriggle(*world, 3, i);
  }
  std::vector<Pose> poses;
  for (std::size_t link = 0; link < 4; ++link) {
    poses.push_back(world->link_pose(link));
  }
  const double angle = world->joint_angle(1);
  ASSERT_FALSE(world->is_slower_than(1e-3, 1e-3));
  world->move_robot(motion);
  EXPECT_EQ(world->joint_angle(1), angle);
  EXPECT_TRUE(world->is_slower_than(1e-12, 1e-12));
  for (std::size_t link = 0; link < 4; ++link) {
    expect_near(world->link_pose(link), motion * poses[link], 1e-9, "link " + std::to_string(link));
    EXPECT_EQ(world->link_contacts(link), 0U);
    EXPECT_EQ(world->contact_force(link), 0.0);
  }
  for (int i = 300; i < 600; ++i) {
    wriggle(*world, 3, i);
  }
  EXPECT_GT(world->contact_count(), 0U) << "it fell and lies on the ground";
}

TEST(MujocoWorld, RepeatsToTheLastBit) {
  const auto end = [] {
    const std::unique_ptr<World> world = mujoco_world(chain(4), flat_ground(0.3, 0.02));
    for (int i = 0; i < 1000; ++i) {
      wriggle(*world, 3, i);
    }
    return world->center_of_mass();
  };
  EXPECT_EQ(end(), end());
}

TEST(MujocoWorld, AWorldThatExplodesIsAnError) {
  const std::unique_ptr<World> world = mujoco_world(chain(2), weightless());
  world->set_joint_speed(0, std::nan(""));
  EXPECT_THROW(run(*world, 0.1), PhysicsError);
  EXPECT_THROW(world->step(), PhysicsError) << "and stays one";
}

TEST(MujocoWorld, AnErrorOfTheEngineDoesNotEndTheProcess) {
  const std::unique_ptr<World> world = mujoco_world(chain(1), weightless());
  EXPECT_EQ(message_of<PhysicsError>([] { mju_error("no more memory"); }), "MuJoCo reports: no more memory");
}

TEST(MujocoWorld, WhatMujocoRefusesIsNamedInOneLine) {
  RobotModel robot = chain(1);
  robot.links[0].mass.inertia = Eigen::Vector3d(1e-5, 1e-5, 1e-3).asDiagonal();  // of no body
  const std::string message = message_of<InputError>([&] { static_cast<void>(mujoco_world(robot, weightless())); });
  EXPECT_TRUE(message.starts_with("test: found ")) << message;
  EXPECT_NE(message.find("inertia"), std::string::npos) << message;
  EXPECT_NE(message.find("--engine ode"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(MujocoWorld, RefusesByNameWhatItDoesNotHave) {
  const auto refusal = [](const EnvironmentModel& environment) {
    return message_of<InputError>([&] { static_cast<void>(mujoco_world(chain(1), environment)); });
  };
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.objects[0].name = "hills";
  const auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh->triangles = {{0, 1, 2}};
  environment.objects[0].geometries[0].mesh = mesh;
  environment.objects[0].geometries[0].shape = Shape::surface;
  EXPECT_NE(refusal(environment).find("found object 'hills' with a triangle mesh, expected what MuJoCo has"),
            std::string::npos);
}

MovingObject box_object(const Eigen::Vector3d& position, double mass) {
  const Link link = box_link(0.0, {0.05, 0.05, 0.05}, mass);
  MovingObject object{"box", {}, link.mass, link.geometries, {}};
  object.pose.position = position;
  return object;
}

std::vector<Pose> objects_of(const World& world, std::size_t count) {
  std::vector<Pose> poses(count);
  world.read_objects(poses);
  return poses;
}

TEST(MujocoWorld, ObjectsThatMoveRestStackAndBearWhatLiesOnThem) {
  EnvironmentModel environment = flat_ground(0.5, 0.12);
  environment.moving_objects.push_back(box_object({0, 0, 0.05}, 0.3));
  environment.moving_objects.push_back(box_object({1, 0, 0.05}, 0.3));
  environment.moving_objects.push_back(box_object({1, 0, 0.15}, 0.3));
  const std::unique_ptr<World> world = mujoco_world(chain(1), environment);
  EXPECT_LT((objects_of(*world, 3)[2].position - Eigen::Vector3d(1, 0, 0.15)).norm(), 1e-9);
  run(*world, 1.0);
  EXPECT_NEAR(world->center_of_mass().z(), 0.12, 1e-3) << "the robot lies on the first";
  EXPECT_NEAR(world->contact_force(0), 0.1 * gravity, 0.02);
  EXPECT_NE(world->link_contacts(0), 0U);
  EXPECT_NEAR(objects_of(*world, 3)[2].position.z(), 0.15, 1e-3);
  EXPECT_TRUE(world->is_slower_than(1e-3, 1e-2));
}

TEST(MujocoWorld, AnObjectThatFallsIsNotAtRestAndAMoveOfTheRobotLeavesItAlone) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({1, 0, 1.0}, 0.3));
  const std::unique_ptr<World> world = mujoco_world(chain(2), environment);
  run(*world, 0.2);
  EXPECT_FALSE(world->is_slower_than(1e-3, 1e-2));
  world->move_robot({{0, 0.1, 0}, Eigen::Quaterniond::Identity()});
  run(*world, 0.1);
  EXPECT_NEAR(objects_of(*world, 1)[0].position.z(), 1.0 - gravity * 0.3 * 0.3 / 2, 3e-3);
}

TEST(MujocoWorld, ABoxRestsOnAHeightFieldAtItsHeightAndASphereRollsDownItsSlope) {
  const auto field_of = [](auto height_at) {
    HeightField field{.columns = 21, .rows = 31, .half_x = 1.0, .half_y = 1.5, .heights = {}};
    for (int row = 0; row < 31; ++row) {
      for (int column = 0; column < 21; ++column) {
        field.heights.push_back(height_at(-1.0 + 0.1 * column, -1.5 + 0.1 * row));
      }
    }
    EnvironmentModel environment = flat_ground(1.0, 0.0);
    environment.objects[0].pose = {};
    Geometry& geometry = environment.objects[0].geometries[0];
    geometry.shape = Shape::height_field;
    geometry.heights = std::make_shared<const HeightField>(field);
    const auto mesh = std::make_shared<TriangleMesh>();
    mesh->vertices = {{-1, -1.5, 0}};
    geometry.mesh = mesh;
    return environment;
  };
  EnvironmentModel level = field_of([](double x, double y) { return x > 0.95 && y > 1.45 ? 0.5 : 0.25; });
  level.robot_pose.position.z() = 0.28;
  const std::unique_ptr<World> box = mujoco_world(chain(1), level);
  run(*box, 1.0);
  EXPECT_NEAR(box->center_of_mass().z(), 0.27, 1e-3);
  EnvironmentModel slope = field_of([](double /*x*/, double y) { return 0.2 * y; });
  slope.robot_pose.position.z() = 0.06;
  RobotModel robot = chain(1);
  robot.links[0].geometries[0].shape = Shape::sphere;
  robot.links[0].geometries[0].extents.x() = 0.05;
  const std::unique_ptr<World> sphere = mujoco_world(robot, slope);
  run(*sphere, 0.7);
  EXPECT_LT(sphere->center_of_mass().y(), -0.1) << "down, towards -y";
  EXPECT_NEAR(sphere->center_of_mass().x(), 0.0, 0.02);
}

TEST(MujocoWorld, AConvexMeshRestsAndSlidesAsTheBoxThatItIs) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.gravity = gravity * Eigen::Vector3d(std::sin(0.6), 0.0, -std::cos(0.6));
  RobotModel robot = chain(1);
  const std::unique_ptr<World> box = mujoco_world(robot, environment);
  Geometry& geometry = robot.links[0].geometries[0];
  const auto mesh = std::make_shared<TriangleMesh>();
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        mesh->vertices.emplace_back(geometry.extents.cwiseProduct(Eigen::Vector3d(x, y, z)));
      }
    }
  }
  geometry.shape = Shape::hull;
  geometry.mesh = mesh;
  const std::unique_ptr<World> hull = mujoco_world(robot, environment);
  run(*box, 0.5);
  run(*hull, 0.5);
  EXPECT_NEAR(hull->center_of_mass().x(), box->center_of_mass().x(), 0.01);
  EXPECT_NEAR(hull->center_of_mass().z(), 0.02, 1e-3);
  EXPECT_GT(box->center_of_mass().x(), 0.1);
}

TEST(MujocoWorld, ReturnsTheLowestPointOfItsEnvironmentAsOde) {
  for (const EnvironmentModel& environment : {EnvironmentModel{}, flat_ground(0.1, 0.026)}) {
    EXPECT_EQ(mujoco_world(chain(1), environment)->lowest_ground(), ode_world(chain(1), environment)->lowest_ground());
  }
}

}  // namespace
}  // namespace proleg::sim::mujoco
