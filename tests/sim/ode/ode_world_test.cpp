#include "sim/ode/ode_world.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <array>
#include <cmath>
#include <numbers>
#include <thread>
#include <vector>

#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim {
namespace {

TEST(World, StartsWithTheLinksWhereTheModelPutsThem) {
  RobotModel robot = chain(3);
  robot.links[1].mass.center = {0.001, 0.002, 0.003};
  EnvironmentModel environment;
  environment.robot_pose = {{1, 2, 3},
                            Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()))};
  const std::unique_ptr<World> world = make_ode_world(robot, environment, step_s, Stepper::direct);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Pose expected = environment.robot_pose * robot.links[i].pose;
    EXPECT_LT((world->link_pose(i).position - expected.position).norm(), 1e-12) << "link " << i;
    EXPECT_LT(world->link_pose(i).orientation.angularDistance(expected.orientation), 1e-7) << "link " << i;
  }
}

TEST(World, ALinkInTheAirFallsFreely) {
  const std::unique_ptr<World> world = make_ode_world(chain(1), EnvironmentModel{}, step_s, Stepper::direct);
  constexpr double seconds = 0.5;
  run(*world, seconds);
  // Semi-implicit Euler falls g t^2 / 2 + g t h / 2.
  EXPECT_NEAR(world->center_of_mass().z(), -gravity * seconds * (seconds + step_s) / 2, 1e-9);
}

TEST(World, ALinkOnTheGroundStaysOnIt) {
  const std::unique_ptr<World> world = make_ode_world(chain(1), flat_ground(0.5, 0.02), step_s, Stepper::direct);
  run(*world, 1.0);
  EXPECT_NEAR(world->center_of_mass().z(), 0.02, 1e-3);
  EXPECT_EQ(world->contact_count(), 4U);
  EXPECT_NE(world->link_contacts(0), 0U);
}

/// Towards -y, after the link has come to lie flat.
double sliding_acceleration(World& world) {
  constexpr double interval = 0.5;
  run(world, 0.2);
  const double before = world.center_of_mass().y();
  run(world, interval);
  const double middle = world.center_of_mass().y();
  run(world, interval);
  return -(world.center_of_mass().y() - 2 * middle + before) / (interval * interval);
}

class Slope : public testing::TestWithParam<double> {};

TEST_P(Slope, ALinkSlidesWithTheAccelerationThatCoulombFrictionLeaves) {
  const double friction = GetParam();
  const double angle = 25.0 * std::numbers::pi / 180.0;
  EnvironmentModel environment = flat_ground(friction, 0.02);
  environment.gravity = {0, -gravity * std::sin(angle), -gravity * std::cos(angle)};
  const std::unique_ptr<World> world = make_ode_world(chain(1), environment, step_s, Stepper::direct);
  const double acceleration = sliding_acceleration(*world);
  const double expected = std::max(0.0, gravity * (std::sin(angle) - friction * std::cos(angle)));
  EXPECT_NEAR(acceleration, expected, 0.03 * gravity);
}

INSTANTIATE_TEST_SUITE_P(Friction, Slope, testing::Values(0.0, 0.1, 0.3, 0.6, 1.0));

TEST(World, FrictionOfTwoSurfacesIsTheGeometricMean) {
  RobotModel robot = chain(1);
  robot.links[0].geometries[0].friction = 0.9;
  EnvironmentModel environment = flat_ground(0.1, 0.02);  // mean 0.3
  environment.gravity = {0, -4.0, -9.0};                  // needs 0.444
  const std::unique_ptr<World> world = make_ode_world(robot, environment, step_s, Stepper::direct);
  EXPECT_NEAR(sliding_acceleration(*world), 4.0 - 0.3 * 9.0, 0.3);
}

TEST(World, FrictionOfTwoSurfacesWithoutOneIsTheEnvironments) {
  for (const double friction : {0.1, 0.3}) {
    EnvironmentModel environment = flat_ground(0.0, 0.02);
    environment.objects[0].geometries[0].friction.reset();
    environment.unspecified_friction = friction;
    environment.gravity = {0, -4.0, -9.0};
    const std::unique_ptr<World> world = make_ode_world(chain(1), environment, step_s, Stepper::direct);
    EXPECT_NEAR(sliding_acceleration(*world), 4.0 - friction * 9.0, 0.3);
  }
}

TEST(World, APositiveJointAngleRaisesTheLinkInFront) {
  EnvironmentModel weightless;
  weightless.gravity.setZero();
  const std::unique_ptr<World> world = make_ode_world(chain(2), weightless, step_s, Stepper::direct);
  world->set_joint_speed(0, 1.0);
  run(*world, 0.5);
  EXPECT_NEAR(world->joint_angle(0), 0.5, 0.01);
  const Eigen::Vector3d head_direction = world->link_pose(0).orientation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d tail_direction = world->link_pose(1).orientation * Eigen::Vector3d::UnitY();
  EXPECT_GT(head_direction.z(), 0.1);
  EXPECT_LT(tail_direction.z(), -0.1);
  EXPECT_NEAR(std::acos(head_direction.dot(tail_direction)), world->joint_angle(0), 1e-6);
}

TEST(World, AMotorDoesNotExceedItsTorque) {
  // A joint in the middle of two 100 mm links on its feet would have to lift 0.1 kg at 50 mm: 0.049 Nm.
  for (const double torque : {0.01, 0.2}) {
    RobotModel robot = chain(2);
    robot.joints[0].max_torque = torque;
    const std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.5, 0.02), step_s, Stepper::direct);
    run(*world, 0.2);
    world->set_joint_speed(0, 1.0);
    run(*world, 0.5);
    if (torque < 0.049) {
      EXPECT_LT(world->joint_angle(0), 0.05) << "torque " << torque;
    } else {
      EXPECT_GT(world->joint_angle(0), 0.3) << "torque " << torque;
    }
  }
}

TEST(World, AJointStopsAtItsLimits) {
  EnvironmentModel weightless;
  weightless.gravity.setZero();
  RobotModel robot = chain(2);
  robot.joints[0].lower_limit = -0.2;
  const std::unique_ptr<World> world = make_ode_world(robot, weightless, step_s, Stepper::direct);
  world->set_joint_speed(0, -2.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(0), -0.2, 0.02);
}

// A robot without power, whose joints stand at 0, where a stop is.
TEST(World, LimpJointsThatStartAtAStopLieOnTheGround) {
  for (const auto& [lower, upper] : {std::pair(0.0, 1.5), std::pair(-1.5, 0.0), std::pair(0.0, 0.0)}) {
    for (const std::size_t limited : {0U, 1U, 2U}) {
      RobotModel robot = chain(4);
      robot.joints[limited].lower_limit = lower;
      robot.joints[limited].upper_limit = upper;
      const std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.5, 0.02), step_s, Stepper::direct);
      for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        world->set_joint_torque(joint, 0);
      }
      run(*world, 1.0);
      EXPECT_NEAR(world->center_of_mass().z(), 0.02, 0.002) << "joint " << limited << ", " << lower << " to " << upper;
      EXPECT_EQ(world->solver_messages(), 0U);
    }
  }
}

TEST(World, ASensorIsPressedWhereTheLinkTouches) {
  const std::unique_ptr<World> world = make_ode_world(chain(3), flat_ground(0.5, 0.02), step_s, Stepper::direct);
  run(*world, 0.2);
  for (std::size_t link = 0; link < 3; ++link) {
    EXPECT_EQ(world->link_contacts(link), 3U) << "lying flat, link " << link;
  }
  // Arch the middle: the head touches with its foremost edge, the tail with its rearmost, the middle link with none.
  for (int i = 0; i < 600; ++i) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      world->set_joint_speed(joint, 5.0 * (-0.5 - world->joint_angle(joint)));
    }
    world->step();
  }
  EXPECT_EQ(world->link_contacts(0), 2U);
  EXPECT_EQ(world->link_contacts(1), 0U);
  EXPECT_EQ(world->link_contacts(2), 1U);
}

TEST(World, TheContactForcesCarryTheRobot) {
  const RobotModel robot = chain(3);
  const std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.5, 0.02), step_s, Stepper::direct);
  EXPECT_EQ(world->contact_force(0), 0.0);
  run(*world, 1.0);
  for (std::size_t link = 0; link < 3; ++link) {
    EXPECT_GT(world->contact_force(link), 0.0) << "link " << link;
  }
  EXPECT_NEAR(world->contact_force(0) + world->contact_force(1) + world->contact_force(2), 0.3 * gravity, 0.01);
}

/// The sensors of the middle of three links when a small ball touches it. The ball just reaches the point `surface` of
/// the robot's frame, from the direction `outwards`; nothing moves.
std::uint8_t touched_by_a_ball(const RobotModel& robot, const Eigen::Vector3d& surface, const Eigen::Vector3d& outwards,
                               const Pose& robot_pose = {}) {
  constexpr double radius = 0.004;
  constexpr double depth = 0.0001;
  EnvironmentModel environment;
  environment.gravity.setZero();
  environment.robot_pose = robot_pose;
  StaticObject ball;
  Geometry geometry;
  geometry.shape = Shape::sphere;
  geometry.extents = {radius, 0, 0};
  ball.pose.position = robot_pose * Eigen::Vector3d(surface + (radius - depth) * outwards.normalized());
  ball.geometries.push_back(geometry);
  environment.objects.push_back(ball);
  const std::unique_ptr<World> world = make_ode_world(robot, environment, step_s, Stepper::direct);
  world->step();
  EXPECT_EQ(world->contact_count(), 1U) << surface.transpose();
  EXPECT_EQ(world->link_contacts(0), 0U);
  EXPECT_EQ(world->link_contacts(2), 0U);
  return world->link_contacts(1);
}

struct Touch {
  Eigen::Vector3d surface;   ///< m from the middle of a link of 40 x 80 x 40 mm, the head towards +y
  Eigen::Vector3d outwards;  ///< normal of the surface
  unsigned sensors;          ///< bit 0 rear, bit 1 front
};

std::vector<Touch> touches_all_around() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return {
      {{0, 0.03, -0.02}, -z, 2},
      {{0.01, -0.03, -0.02}, -z, 1},  // under it
      {{0, 0.03, 0.02}, z, 0},
      {{0, -0.03, 0.02}, z, 0},  // on its back
      {{0.02, 0.03, -0.01}, x, 0},
      {{-0.02, -0.03, -0.01}, -x, 0},
      {{0.02, 0.03, 0.01}, x, 0},  // its flanks
      {{0, 0.04, -0.01}, y, 2},
      {{0, -0.04, -0.01}, -y, 1},  // its ends, below the middle
      {{0, 0.04, 0.01}, y, 0},
      {{0, -0.04, 0.01}, -y, 0},  // and above
      {{0, 0.04, -0.02}, y - z, 2},
      {{0, -0.04, -0.02}, -y - z, 1},  // the lower edges at the ends
      {{0, 0.04, 0.02}, y + z, 0},     // an upper edge
      {{0.02, 0.03, -0.02}, 0.8 * x - z, 2},
      {{0.02, 0.03, -0.02}, x - 0.8 * z, 0},  // below and above 45 degrees of roll
      {{-0.02, -0.03, -0.02}, -0.8 * x - z, 1},
      {{-0.02, -0.03, -0.02}, -x - 0.8 * z, 0},
  };
}

TEST(World, SensorsLieUnderTheLinkAndIgnoreItsBackAndFlanks) {
  for (const Touch& touch : touches_all_around()) {
    EXPECT_EQ(touched_by_a_ball(chain(3), touch.surface + Eigen::Vector3d(0, -0.1, 0), touch.outwards), touch.sensors)
        << touch.surface.transpose() << " outwards " << touch.outwards.transpose();
  }
}

TEST(World, TheUndersideIsThatOfTheRobotsFileForEveryStartPose) {
  for (const double roll : {0.5, 1.5, 3.0}) {
    const Pose pose{{1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(roll, Eigen::Vector3d(1, 2, -1).normalized()))};
    for (const Touch& touch : touches_all_around()) {
      EXPECT_EQ(touched_by_a_ball(chain(3), touch.surface + Eigen::Vector3d(0, -0.1, 0), touch.outwards, pose),
                touch.sensors)
          << touch.surface.transpose() << " outwards " << touch.outwards.transpose();
    }
  }
}

TEST(World, TheUndersideDoesNotDependOnTheFrameOfTheLink) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(2.0, Eigen::Vector3d(3, -1, 2).normalized()));
  RobotModel robot = chain(3);
  Link& link = robot.links[1];
  link.pose.orientation = turned;
  link.mass.inertia = turned.conjugate() * link.mass.inertia * turned;
  link.geometries[0].pose.orientation = turned.conjugate();
  for (const Touch& touch : touches_all_around()) {
    EXPECT_EQ(touched_by_a_ball(robot, touch.surface + Eigen::Vector3d(0, -0.1, 0), touch.outwards), touch.sensors)
        << touch.surface.transpose() << " outwards " << touch.outwards.transpose();
  }
}

TEST(World, ARobotUprightInItsFileHasItsSensorsTowardsMinusY) {
  const Eigen::Quaterniond upright(
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));  // y to z, z to -y
  RobotModel robot = chain(3);
  for (Link& link : robot.links) {
    link.pose = Pose{{0, 0, 0}, upright} * link.pose;
  }
  for (Joint& joint : robot.joints) {
    joint.anchor = upright * joint.anchor;
  }
  const auto touched = [&](double y, double z) { return touched_by_a_ball(robot, {0, y, -0.1 + z}, {0, y, 0}); };
  EXPECT_EQ(touched(-0.02, 0.03), 2U);
  EXPECT_EQ(touched(-0.02, -0.03), 1U);
  EXPECT_EQ(touched(0.02, 0.03), 0U);
}

TEST(World, TheGroundPressesNoSensorOfARobotOnItsBackOrOnItsSide) {
  for (const double roll : {90.0, 180.0, 270.0}) {
    EnvironmentModel environment = flat_ground(0.5, 0.02);
    environment.robot_pose.orientation = Eigen::AngleAxisd(roll / 180 * std::numbers::pi, Eigen::Vector3d::UnitY());
    const std::unique_ptr<World> world = make_ode_world(chain(3), environment, step_s, Stepper::direct);
    run(*world, 0.2);
    EXPECT_GT(world->contact_count(), 0U);
    for (std::size_t link = 0; link < 3; ++link) {
      EXPECT_EQ(world->link_contacts(link), 0U) << "roll " << roll << ", link " << link;
    }
  }
}

TEST(World, ACylinderLiesAlongYAndASphereIsRound) {
  for (const Shape shape : {Shape::cylinder, Shape::sphere}) {
    RobotModel robot = chain(1);
    robot.links[0].geometries[0].shape = shape;
    robot.links[0].geometries[0].extents = {0.03, 0.1, 0};
    const std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.5, 0.05), step_s, Stepper::direct);
    run(*world, 2.0);
    EXPECT_NEAR(world->center_of_mass().z(), 0.03, 2e-3);
  }
}

/// Runs until the engine fails. With almost no inertia its direct solver fails one of its assertions.
void struggle() {
  RobotModel robot = chain(6);
  for (Link& link : robot.links) {
    link.mass.inertia = Eigen::Matrix3d::Identity() * 1e-200;
  }
  const std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.1, 0.026), step_s, Stepper::direct);
  for (int i = 0; i < 20'000; ++i) {
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
      world->set_joint_speed(joint, std::sin(0.006 * i + static_cast<double>(joint)));
    }
    world->step();
  }
}

TEST(World, AnErrorOfTheEngineIsThrownAndTheWorldCanBeDestroyed) {
  EXPECT_THROW(struggle(), PhysicsError);
  EXPECT_THROW(struggle(), PhysicsError) << "the first failure does not disturb the next world";
}

TEST(World, AnErrorOfTheEngineLeavesLessThanAKilobyte) {
  EXPECT_THROW(struggle(), PhysicsError);  // what is allocated once
  constexpr std::size_t failures = 20;
  const std::size_t before = mallinfo2().uordblks;
  for (std::size_t i = 0; i < failures; ++i) {
    EXPECT_THROW(struggle(), PhysicsError);
  }
  EXPECT_LT(mallinfo2().uordblks, before + failures * 1024);
}

TEST(World, ReturnsTheLowestPointOfItsEnvironment) {
  EXPECT_EQ(make_ode_world(chain(1), EnvironmentModel{}, step_s, Stepper::direct)->lowest_ground(), std::nullopt);
  EXPECT_DOUBLE_EQ(make_ode_world(chain(1), flat_ground(0.1, 0.026), step_s, Stepper::direct)->lowest_ground().value(),
                   -1.0);
}

TEST(World, SelfCollisionSeparatesLinksThatAreNotNeighbours) {
  for (const bool self_collision : {false, true}) {
    EnvironmentModel weightless;
    weightless.gravity.setZero();
    weightless.self_collision = self_collision;
    RobotModel robot = chain(3);
    for (Joint& joint : robot.joints) {
      joint.lower_limit = -3.0;
      joint.upper_limit = 3.0;
    }
    const std::unique_ptr<World> world = make_ode_world(robot, weightless, step_s, Stepper::direct);
    for (int i = 0; i < 4000; ++i) {
      world->set_joint_speed(0, 1.0);
      world->set_joint_speed(1, 1.0);
      world->step();
    }
    const double folded = world->joint_angle(0) + world->joint_angle(1);
    if (self_collision) {
      EXPECT_LT(folded, 5.2);
    } else {
      EXPECT_GT(folded, 5.8);
    }
  }
}

/// Bit pattern of a run that slips, bends and touches.
std::vector<double> wriggle() {
  const std::unique_ptr<World> world = make_ode_world(chain(4), flat_ground(0.2, 0.03), step_s, Stepper::direct);
  std::vector<double> trace;
  for (int i = 0; i < 1500; ++i) {
    for (std::size_t joint = 0; joint < 3; ++joint) {
      world->set_joint_speed(joint, 3.0 * std::sin(0.01 * i + static_cast<double>(joint)));
    }
    world->step();
    trace.push_back(world->center_of_mass().y());
  }
  return trace;
}

TEST(World, RepeatsToTheLastBitOnEveryThread) {
  const std::vector<double> expected = wriggle();
  std::array<std::vector<double>, 4> traces;
  std::vector<std::thread> threads;
  threads.reserve(traces.size());
  for (std::vector<double>& trace : traces) {
    threads.emplace_back([&trace] { trace = wriggle(); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::vector<double>& trace : traces) {
    EXPECT_EQ(trace, expected);
  }
}

TEST(World, TheIterativeStepperRepeatsToo) {
  const auto wriggle_iteratively = [] {
    const std::unique_ptr<World> world = make_ode_world(chain(10), flat_ground(0.2, 0.03), step_s, Stepper::iterative);
    for (int i = 0; i < 500; ++i) {
      world->set_joint_speed(static_cast<std::size_t>(i % 9), 2.0);
      world->step();
    }
    return world->center_of_mass();
  };
  EXPECT_EQ(wriggle_iteratively(), wriggle_iteratively());
}

}  // namespace
}  // namespace proleg::sim
