// Oracles: mechanics of rigid bodies, and ODE where both engines must agree.

#include "sim/reduced/reduced_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/physics/physics_error.hpp"
#include "tests/sim/reduced/worlds.hpp"

namespace proleg::sim::reduced {
namespace {

std::unique_ptr<World> reduced_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_reduced_world(robot, environment, step_s, "test");
}

TEST(ReducedWorld, StartsWithTheLinksWhereTheModelPutsThem) {
  RobotModel robot = chain(3);
  robot.links[1].mass.center = {0, 0.002, 0.003};
  for (const double heading : {0.0, 0.3, 2.0, -1.234}) {
    EnvironmentModel environment;
    environment.robot_pose = {{1, 2, 3}, turn(heading, Eigen::Vector3d::UnitZ()) * turn(0.7, Eigen::Vector3d::UnitX())};
    const std::unique_ptr<World> world = reduced_world(robot, environment);
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      expect_near(world->link_pose(i), environment.robot_pose * robot.links[i].pose, 1e-7,
                  "heading " + std::to_string(heading) + ", link " + std::to_string(i));
    }
    EXPECT_EQ(world->joint_angle(0), 0.0);
    EXPECT_EQ(world->contact_count(), 0U);
  }
}

TEST(ReducedWorld, ALinkInTheAirFallsFreely) {
  const std::unique_ptr<World> world = reduced_world(chain(1), EnvironmentModel{});
  constexpr double seconds = 0.5;
  run(*world, seconds);
  // Semi-implicit Euler falls g t^2 / 2 + g t h / 2.
  EXPECT_NEAR(world->center_of_mass().z(), -gravity * seconds * (seconds + step_s) / 2, 1e-9);
  EXPECT_TRUE(world->is_slower_than(gravity * seconds * 1.001, 1e-9));
  EXPECT_FALSE(world->is_slower_than(gravity * seconds * 0.999, 1.0));
}

TEST(ReducedWorld, AJointThatTurnsMakesItsLinksNotSlow) {
  const std::unique_ptr<World> world = reduced_world(chain(2), weightless());
  EXPECT_TRUE(world->is_slower_than(1e-9, 1e-9));
  world->set_joint_speed(0, 1.0);
  run(*world, 0.1);
  EXPECT_TRUE(world->is_slower_than(1.0, 0.51)) << "each link turns at half the speed";
  EXPECT_FALSE(world->is_slower_than(1.0, 0.49));
}

TEST(ReducedWorld, TheContactsCarryExactlyTheWeight) {
  for (const std::size_t links : {1U, 2U, 6U}) {
    const std::unique_ptr<World> world = reduced_world(chain(links), flat_ground(0.5, 0.02));
    EXPECT_EQ(world->contact_force(0), 0.0);
    run(*world, 2.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < links; ++i) {
      EXPECT_GT(world->contact_force(i), 0.0) << "link " << i;
      EXPECT_EQ(world->link_contacts(i), links == 1 ? world->link_contacts(0) : 3U) << "link " << i;
      sum += world->contact_force(i);
    }
    const double weight = 0.1 * static_cast<double>(links) * gravity;
    EXPECT_NEAR(sum / weight, 1.0, 1e-6) << links << " links";
    EXPECT_NEAR(world->contact_sliding().normal_force, sum, 1e-9);
    EXPECT_LT(world->contact_sliding().force_times_speed, 1e-6 * weight);
    EXPECT_EQ(world->contact_count(), 2 * links);
    EXPECT_NEAR(world->center_of_mass().z(), 0.02, 1e-3);
    EXPECT_TRUE(world->is_slower_than(1e-4, 1e-3));
  }
}

/// Bends all joints to an angle, as a servo does, and holds them there.
void bend(World& world, std::size_t joints, double angle, double seconds) {
  for (long i = 0; i < std::lround(seconds / step_s); ++i) {
    for (std::size_t joint = 0; joint < joints; ++joint) {
      world.set_joint_speed(joint, 5.0 * (angle - world.joint_angle(joint)));
    }
    world.step();
  }
}

// An arch stands on the foremost edge of the head and on the rearmost edge of the tail.
TEST(ReducedWorld, TheCentreOfPressureIsBelowTheCentreOfMass) {
  RobotModel robot = chain(6);
  robot.links[1].mass.mass = 0.5;
  const std::unique_ptr<World> world = reduced_world(robot, flat_ground(0.5, 0.02));
  bend(*world, 5, -0.15, 4.0);
  ASSERT_TRUE(world->is_slower_than(1e-5, 1e-4));
  const double front = (world->link_pose(0) * Eigen::Vector3d(0, 0.04, -0.02)).y();
  const double rear = (world->link_pose(5) * Eigen::Vector3d(0, -0.04, -0.02)).y();
  for (std::size_t link = 1; link < 5; ++link) {
    EXPECT_EQ(world->contact_force(link), 0.0) << "link " << link;
  }
  const double weight = 1.0 * gravity;
  EXPECT_NEAR((world->contact_force(0) + world->contact_force(5)) / weight, 1.0, 1e-6);
  const double pressure = (world->contact_force(0) * front + world->contact_force(5) * rear) / weight;
  EXPECT_NEAR(pressure, world->center_of_mass().y(), 1e-5);
}

class ReducedSlope : public testing::TestWithParam<double> {};

TEST_P(ReducedSlope, ALinkSlidesWithTheAccelerationThatCoulombFrictionLeaves) {
  const double friction = GetParam();
  const double angle = 25.0 * std::numbers::pi / 180.0;
  EnvironmentModel environment = flat_ground(friction, 0.02);
  environment.gravity = {0, -gravity * std::sin(angle), -gravity * std::cos(angle)};
  const std::unique_ptr<World> world = reduced_world(chain(1), environment);
  run(*world, 0.2);
  const double start = world->center_of_mass().y();
  run(*world, 0.5);
  const double middle = world->center_of_mass().y();
  run(*world, 0.5);
  const double end = world->center_of_mass().y();
  const double expected = std::max(0.0, gravity * (std::sin(angle) - friction * std::cos(angle)));
  EXPECT_NEAR(-(end - 2 * middle + start) / 0.25, expected, 1e-4 * gravity);
  if (expected == 0.0) {
    EXPECT_NEAR(end, start, 1e-7) << "it stays";
  }
  const double normal = 0.1 * gravity * std::cos(angle);
  const double speed = -(end - middle) / 0.5 + expected * 0.25;
  EXPECT_NEAR(world->contact_sliding().normal_force, normal, 1e-3 * normal);
  EXPECT_NEAR(world->contact_sliding().force_times_speed, normal * speed, 0.01 * normal);
}

INSTANTIATE_TEST_SUITE_P(Friction, ReducedSlope, testing::Values(0.0, 0.1, 0.3, 0.6, 1.0));

// Down a slope without friction, then onto one that brakes.
TEST(ReducedWorld, ALinkStopsAfterTheDistanceThatCoulombFrictionNeeds) {
  constexpr double friction = 0.5;
  constexpr double drive = 2.0;  // m/s^2
  EnvironmentModel environment = flat_ground(0.0, 0.02);
  environment.objects.push_back(floor_with_friction(friction));
  environment.objects[0].pose.position.y() = 49.0;  // to y = -1
  environment.objects[1].pose.position.y() = -51.0;
  environment.gravity = {0, -drive, -gravity};
  const std::unique_ptr<World> world = reduced_world(chain(1), environment);
  const auto place = [&] { return -world->center_of_mass().y(); };
  while (place() < 1.05) {  // then all of it is on the floor that brakes
    world->step();
    ASSERT_LT(place(), 100.0);
  }
  const double before = place();
  world->step();
  const double speed = (place() - before) / step_s;
  EXPECT_GT(speed, 1.5);
  const double start = place();
  run(*world, 3.0);
  const double braking = friction * gravity - drive;
  // Steps of equal length h make the sum of speeds v h / 2 less than its integral.
  EXPECT_NEAR(place() - start, speed * speed / (2 * braking) - speed * step_s / 2, 2e-3);
  EXPECT_TRUE(world->is_slower_than(1e-6, 1e-6));
}

TEST(ReducedWorld, APositiveJointAngleRaisesTheLinkInFrontAsInOde) {
  for (const double heading : {0.0, 2.5}) {
    for (const double sign : {1.0, -1.0}) {
      EnvironmentModel environment = weightless();
      environment.robot_pose.orientation = turn(heading, Eigen::Vector3d::UnitZ());
      RobotModel robot = chain(3);
      robot.joints[1].axis *= sign;
      const std::unique_ptr<World> world = reduced_world(robot, environment);
      const std::unique_ptr<World> ode = ode_world(robot, environment);
      for (World* each : {world.get(), ode.get()}) {
        each->set_joint_speed(0, 1.0);
        each->set_joint_speed(1, 0.4);
        run(*each, 0.5);
      }
      EXPECT_NEAR(world->joint_angle(0), 0.5, 1e-9);
      EXPECT_NEAR(world->joint_angle(1), 0.2, 1e-9);
      EXPECT_GT((world->link_pose(0).orientation * Eigen::Vector3d::UnitY()).z(), 0.1);
      for (std::size_t link = 0; link < 3; ++link) {
        expect_near(world->link_pose(link), ode->link_pose(link), 2e-3, "link " + std::to_string(link));
      }
    }
  }
}

/// The last link is a heavy foot on the edge of a floor; the other ones reach out over the edge.
struct Arm {
  explicit Arm(std::size_t links) : robot(chain(links)), environment(flat_ground(1.0, 0.02)) {
    robot.links.back().mass.mass = 100.0;
    robot.links.back().mass.inertia *= 1000.0;
    environment.objects[0].pose.position.y() = robot.links.back().pose.position.y() + 0.01 - 50.0;
  }
  RobotModel robot;
  EnvironmentModel environment;
};

TEST(ReducedWorld, AMotorGivesTheTorqueThatHoldsItsLinkAsInOde) {
  Arm arm(2);
  const std::unique_ptr<World> world = reduced_world(arm.robot, arm.environment);
  const std::unique_ptr<World> ode = ode_world(arm.robot, arm.environment);
  EXPECT_EQ(world->motor_torque(0), 0.0);
  run(*world, 1.0);
  run(*ode, 1.0);
  EXPECT_NEAR(world->motor_torque(0), 0.1 * gravity * 0.05, 1e-4);
  EXPECT_NEAR(world->motor_torque(0), ode->motor_torque(0), 1e-3);
}

TEST(ReducedWorld, AMotorDoesNotExceedItsTorque) {
  // The arm takes 0.049 Nm.
  for (const double torque : {0.04, 0.06}) {
    Arm arm(2);
    arm.robot.joints[0].max_torque = torque;
    const std::unique_ptr<World> world = reduced_world(arm.robot, arm.environment);
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

TEST(ReducedWorld, AJammedJointStaysAndALimpOneFallsToItsStop) {
  Arm arm(2);
  const std::unique_ptr<World> world = reduced_world(arm.robot, arm.environment);
  world->set_joint_torque(0, 40.0);
  world->set_joint_speed(0, 0.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(0), 0.0, 1e-6);
  world->set_joint_torque(0, 0.0);
  for (int i = 0; i < 3000; ++i) {
    world->step();
    EXPECT_GT(world->joint_angle(0), -1.005);
    EXPECT_EQ(world->motor_torque(0), 0.0);
  }
  EXPECT_NEAR(world->joint_angle(0), -1.0, 1e-3);
}

TEST(ReducedWorld, AJointStopsAtItsLimits) {
  RobotModel robot = chain(3);
  robot.joints[0].lower_limit = -0.2;
  robot.joints[1].axis = -Eigen::Vector3d::UnitX();
  robot.joints[1].upper_limit = 0.3;
  const std::unique_ptr<World> world = reduced_world(robot, weightless());
  for (int i = 0; i < 1000; ++i) {
    world->set_joint_speed(0, -2.0);
    world->set_joint_speed(1, 2.0);
    world->step();
    EXPECT_GE(world->joint_angle(0), -0.2 - 1e-8);
    EXPECT_LE(world->joint_angle(1), 0.3 + 1e-8);
  }
  EXPECT_NEAR(world->joint_angle(0), -0.2, 1e-8);
  EXPECT_NEAR(world->joint_angle(1), 0.3, 1e-8);
}

// A robot without power, whose joints stand at 0, where a stop is.
TEST(ReducedWorld, LimpJointsThatStartAtAStopLieOnTheGround) {
  for (const auto& [lower, upper] : {std::pair(0.0, 1.5), std::pair(-1.5, 0.0), std::pair(0.0, 0.0)}) {
    for (const std::size_t limited : {0U, 1U, 2U}) {
      RobotModel robot = chain(4);
      robot.joints[limited].lower_limit = lower;
      robot.joints[limited].upper_limit = upper;
      const std::unique_ptr<World> world = reduced_world(robot, flat_ground(0.5, 0.02));
      for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        world->set_joint_torque(joint, 0);
      }
      run(*world, 1.0);
      EXPECT_NEAR(world->center_of_mass().z(), 0.02, 0.002) << "joint " << limited << ", " << lower << " to " << upper;
      EXPECT_EQ(world->solver_messages(), 0U);
    }
  }
}

TEST(ReducedWorld, ASensorIsPressedWhereTheLinkTouches) {
  const std::unique_ptr<World> world = reduced_world(chain(3), flat_ground(0.5, 0.02));
  EXPECT_EQ(world->link_contacts(0), 0U) << "before the first step";
  run(*world, 0.2);
  for (std::size_t link = 0; link < 3; ++link) {
    EXPECT_EQ(world->link_contacts(link), 3U) << "lying flat, link " << link;
  }
  bend(*world, 2, -0.5, 0.6);
  EXPECT_EQ(world->link_contacts(0), 2U);
  EXPECT_EQ(world->link_contacts(1), 0U);
  EXPECT_EQ(world->link_contacts(2), 1U);
}

/// The sensors of the middle of three links when a bar across the robot touches it. The bar just reaches the point y, z
/// of the link, from the direction `outwards`; nothing moves.
std::uint8_t touched_by_a_bar(bool is_reduced, double y, double z, const Eigen::Vector3d& outwards) {
  constexpr double half_side = 0.004;
  constexpr double depth = 0.0001;
  EnvironmentModel environment = weightless();
  StaticObject bar = floor_with_friction(0.5);
  bar.pose.position = Eigen::Vector3d(0, y - 0.1, z) + (half_side - depth) * outwards;
  bar.geometries[0].extents = {1.0, half_side, half_side};
  environment.objects.push_back(bar);
  const std::unique_ptr<World> world = (is_reduced ? reduced_world : ode_world)(chain(3), environment);
  world->step();
  EXPECT_GT(world->contact_count(), 0U);
  EXPECT_EQ(world->link_contacts(0), 0U);
  EXPECT_EQ(world->link_contacts(2), 0U);
  return world->link_contacts(1);
}

TEST(ReducedWorld, SensorsLieUnderTheLinkAndIgnoreItsBackAsInOde) {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  struct Touch {
    double y;
    double z;
    Eigen::Vector3d outwards;
    unsigned sensors;
  };
  for (const Touch& touch :
       {Touch{0.03, -0.02, -up, 2}, Touch{-0.03, -0.02, -up, 1}, Touch{0.03, 0.02, up, 0}, Touch{-0.03, 0.02, up, 0},
        Touch{0.04, -0.01, forward, 2}, Touch{-0.04, -0.01, -forward, 1}, Touch{0.04, 0.01, forward, 0},
        Touch{-0.04, 0.01, -forward, 0}}) {
    for (const bool is_reduced : {true, false}) {
      EXPECT_EQ(touched_by_a_bar(is_reduced, touch.y, touch.z, touch.outwards), touch.sensors)
          << (is_reduced ? "reduced" : "ode") << ", " << touch.y << ' ' << touch.z;
    }
  }
}

TEST(ReducedWorld, TheGroundPressesNoSensorOfARobotOnItsBack) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.robot_pose.orientation = turn(std::numbers::pi, Eigen::Vector3d::UnitY());
  const std::unique_ptr<World> world = reduced_world(chain(3), environment);
  run(*world, 0.2);
  EXPECT_EQ(world->contact_count(), 6U);
  for (std::size_t link = 0; link < 3; ++link) {
    EXPECT_EQ(world->link_contacts(link), 0U) << "link " << link;
  }
}

TEST(ReducedWorld, SelfCollisionSeparatesLinksThatAreNotNeighbours) {
  for (const bool self_collision : {false, true}) {
    EnvironmentModel environment = weightless();
    environment.self_collision = self_collision;
    RobotModel robot = chain(3);
    for (Joint& joint : robot.joints) {
      joint.lower_limit = -3.0;
      joint.upper_limit = 3.0;
    }
    const std::unique_ptr<World> world = reduced_world(robot, environment);
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

/// A step of a run that bends, slips and touches.
void wriggle(World& world, std::size_t joints, int step) {
  for (std::size_t joint = 0; joint < joints; ++joint) {
    world.set_joint_speed(joint, 3.0 * std::sin(0.01 * step + static_cast<double>(joint)));
  }
  world.step();
}

TEST(ReducedWorld, ARobotIsMovedAsARigidBodyAndGoesOnAsBefore) {
  for (const double heading : {0.4, std::numbers::pi / 2, -3.0}) {
    const Pose motion{{0.3, -0.2, 0.05}, turn(heading, Eigen::Vector3d::UnitZ())};
    const std::unique_ptr<World> moved = reduced_world(chain(4), flat_ground(0.5, 0.02));
    const std::unique_ptr<World> lifted = reduced_world(chain(4), flat_ground(0.5, 0.02));
    for (int i = 0; i < 300; ++i) {
      wriggle(*moved, 3, i);
      wriggle(*lifted, 3, i);
    }
    const Pose lift{{0, 0, 0.05}, Eigen::Quaterniond::Identity()};
    std::vector<Pose> poses;
    for (std::size_t link = 0; link < 4; ++link) {
      poses.push_back(moved->link_pose(link));
    }
    const double angle = moved->joint_angle(1);
    ASSERT_FALSE(moved->is_slower_than(1e-3, 1e-3));
    moved->move_robot(motion);
    lifted->move_robot(lift);
    EXPECT_EQ(moved->joint_angle(1), angle);
    EXPECT_TRUE(moved->is_slower_than(1e-12, 1e-12));
    const Pose between = motion * lift.inverse();
    for (std::size_t link = 0; link < 4; ++link) {
      const std::string name = "heading " + std::to_string(heading) + ", link " + std::to_string(link);
      expect_near(moved->link_pose(link), motion * poses[link], 1e-7, name);
      EXPECT_EQ(moved->link_contacts(link), 0U);
      EXPECT_EQ(moved->contact_force(link), 0.0);
    }
    for (int i = 300; i < 600; ++i) {  // it falls, lands, and crawls
      wriggle(*moved, 3, i);
      wriggle(*lifted, 3, i);
    }
    EXPECT_GT(moved->contact_count(), 0U);
    for (std::size_t link = 0; link < 4; ++link) {
      expect_near(moved->link_pose(link), between * lifted->link_pose(link), 1e-5,
                  "at the end, heading " + std::to_string(heading) + ", link " + std::to_string(link));
    }
  }
}

TEST(ReducedWorld, MotorsGoOnAfterAMoveAsInOde) {
  const RobotModel robot = chain(2);
  for (const bool is_reduced : {true, false}) {
    const std::unique_ptr<World> world = (is_reduced ? reduced_world : ode_world)(robot, weightless());
    world->set_joint_speed(0, 1.0);
    run(*world, 0.1);
    world->move_robot({{1, 1, 1}, turn(0.5, Eigen::Vector3d::UnitZ())});
    run(*world, 0.1);
    EXPECT_NEAR(world->joint_angle(0), 0.2, 1e-3) << (is_reduced ? "reduced" : "ode");
  }
}

TEST(ReducedWorld, AMoveThatTheEngineRefusesChangesNothing) {
  const std::unique_ptr<World> world = reduced_world(chain(3), flat_ground(0.5, 0.02));
  run(*world, 0.1);
  const std::vector<double> before = world->state();
  EXPECT_THROW(world->move_robot({{0, 0, 1}, turn(0.5, Eigen::Vector3d::UnitY())}), InputError);
  EXPECT_EQ(world->state(), before);
  run(*world, 0.1);
  EXPECT_NEAR(world->center_of_mass().z(), 0.02, 1e-3);
}

TEST(ReducedWorld, AWorldThatExplodesIsAnError) {
  EnvironmentModel environment;
  environment.gravity.z() = -1e298;
  const std::unique_ptr<World> world = make_reduced_world(chain(2), environment, 1e4, "test");
  world->step();
  EXPECT_THROW(run(*world, 1.0), PhysicsError);
  EXPECT_FALSE(std::isfinite(world->center_of_mass().z())) << "it can be read";
}

TEST(ReducedWorld, ReturnsTheLowestPointOfItsEnvironmentAsOde) {
  EnvironmentModel beside = flat_ground(0.1, 0.026);
  beside.objects[0].pose.position.x() = 51.0;
  for (const EnvironmentModel& environment : {EnvironmentModel{}, flat_ground(0.1, 0.026), beside}) {
    EXPECT_EQ(reduced_world(chain(1), environment)->lowest_ground(), ode_world(chain(1), environment)->lowest_ground());
  }
}

TEST(ReducedWorld, RepeatsToTheLastBit) {
  const auto trace = [] {
    const std::unique_ptr<World> world = reduced_world(chain(4), flat_ground(0.2, 0.03));
    std::vector<double> states;
    for (int i = 0; i < 500; ++i) {
      wriggle(*world, 3, i);
      const std::vector<double> state = world->state();
      states.insert(states.end(), state.begin(), state.end());
    }
    return states;
  };
  EXPECT_EQ(trace(), trace());
}

TEST(ReducedWorld, TheSameMotionElsewhereHasAnotherState) {
  std::set<std::vector<double>> states;
  for (const double heading : {0.0, std::numbers::pi / 2, std::numbers::pi}) {
    for (const double sideways : {0.0, 0.25}) {
      EnvironmentModel environment = weightless();
      const Eigen::Quaterniond turned = turn(heading, Eigen::Vector3d::UnitZ());
      environment.robot_pose = {turned * Eigen::Vector3d(sideways, 0.0, 0.0), turned};
      states.insert(reduced_world(chain(3), environment)->state());
    }
  }
  EXPECT_EQ(states.size(), 6U);
}

}  // namespace
}  // namespace proleg::sim::reduced
