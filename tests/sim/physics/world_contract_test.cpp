#include "tests/sim/physics/world_contract.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <thread>

namespace proleg::sim {

// An engine that lacks a feature does not run the cases of it.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RoundShapes);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SelfCollision);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SeveralObjects);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(TouchingBoxes);

namespace {

constexpr double pi = std::numbers::pi;

/// A chain as the engine can have it: unless it is planar, every second joint turns about z.
RobotModel bending_chain(const Engine& engine, std::size_t links) {
  RobotModel robot = chain(links);
  for (std::size_t joint = 1; joint < robot.joints.size() && !engine.is_planar; joint += 2) {
    robot.joints[joint].axis = Eigen::Vector3d::UnitZ();
  }
  return robot;
}

TEST_P(WorldContract, StartsWithTheLinksWhereTheModelPutsThem) {
  RobotModel robot = bending_chain(GetParam(), 4);
  robot.links[1].mass.center = {0, 0.002, 0.003};
  std::vector<Eigen::Quaterniond> orientations;
  for (const double heading : {0.0, 0.3, 2.0, -1.234}) {
    orientations.push_back(turn(heading, Eigen::Vector3d::UnitZ()) * turn(0.7, Eigen::Vector3d::UnitX()));
  }
  if (!GetParam().is_planar) {
    robot.links[1].mass.center.x() = 0.001;
    robot.links[2].pose.orientation = turn(0.4, {1, 2, 3});
    orientations.push_back(turn(0.7, {1, 2, 3}));
    orientations.push_back(turn(1.2, {3, -1, 2}));
  }
  for (std::size_t start = 0; start < orientations.size(); ++start) {
    EnvironmentModel environment;
    environment.robot_pose = {{1, 2, 3}, orientations[start]};
    const std::unique_ptr<World> world = make(robot, environment);
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const Pose pose = environment.robot_pose * robot.links[i].pose;
      expect_near(world->link_pose(i), pose, GetParam().position, GetParam().rotation,
                  "start " + std::to_string(start) + ", link " + std::to_string(i));
      center += pose * robot.links[i].mass.center / 4.0;
    }
    EXPECT_LT((world->center_of_mass() - center).norm(), GetParam().position) << "start " << start;
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
      EXPECT_EQ(world->joint_angle(joint), 0.0);
      EXPECT_EQ(world->motor_torque(joint), 0.0);
    }
    EXPECT_EQ(world->contact_count(), 0U);
  }
}

TEST_P(WorldContract, ALinkInTheAirFallsFreelyAndKeepsItsEnergy) {
  const std::unique_ptr<World> world = make(chain(1), EnvironmentModel{});
  const double energy = world->energy();
  constexpr double seconds = 0.5;
  run(*world, seconds);
  // Semi-implicit Euler falls g t^2 / 2 + g t h / 2.
  EXPECT_NEAR(world->center_of_mass().z(), -gravity * seconds * (seconds + step_s) / 2, 1e-9);
  EXPECT_NEAR(world->energy(), energy, 0.1 * gravity * gravity * seconds * step_s / 2 + 1e-9);
  EXPECT_TRUE(world->is_slower_than(gravity * seconds * 1.001, 1e-9));
  EXPECT_FALSE(world->is_slower_than(gravity * seconds * 0.999, 1.0));
}

TEST_P(WorldContract, AJointThatTurnsMakesItsLinksNotSlow) {
  const std::unique_ptr<World> world = make(chain(2), weightless());
  EXPECT_TRUE(world->is_slower_than(1e-9, 1e-9));
  world->set_joint_speed(0, 1.0);
  run(*world, 0.1);
  EXPECT_TRUE(world->is_slower_than(1.0, 0.51)) << "each link turns at half the speed";
  EXPECT_FALSE(world->is_slower_than(1.0, 0.49));
  // Their middles hardly move.
  const double inertia = 0.1 / 12.0 * (0.08 * 0.08 + 0.04 * 0.04);  // of a box
  EXPECT_NEAR(world->energy() / (2 * 0.5 * inertia * 0.5 * 0.5), 1.0, 0.02);
}

/// Lets a robot of links of 0.1 kg, whose middles are 20 mm above the ground, come to rest there.
void expect_to_carry_the_weight(const Engine& engine, const RobotModel& robot, double heading) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.robot_pose.orientation = turn(heading, Eigen::Vector3d::UnitZ());
  const std::unique_ptr<World> world = engine.make(robot, environment);
  const std::size_t links = robot.links.size();
  for (std::size_t link = 0; link < links; ++link) {
    EXPECT_EQ(world->contact_force(link), 0.0) << "before the first step";
    EXPECT_EQ(world->link_contacts(link), 0U) << "before the first step";
  }
  run(*world, 2.0);
  double sum = 0.0;
  for (std::size_t link = 0; link < links; ++link) {
    sum += world->contact_force(link);
  }
  const double weight = 0.1 * static_cast<double>(links) * gravity;
  EXPECT_NEAR(sum / weight, 1.0, engine.weight);
  EXPECT_NEAR(world->contact_sliding().normal_force, sum, 1e-9);
  EXPECT_LT(world->contact_sliding().force_times_speed, engine.rest * weight);
  EXPECT_NEAR(world->center_of_mass().z(), 0.02, 1e-3);
  EXPECT_TRUE(world->is_slower_than(engine.rest, 10 * engine.rest));
  if (robot.links[0].geometries[0].shape == Shape::box) {
    EXPECT_EQ(world->contact_count(), engine.contacts_of_a_box * links);
    for (std::size_t link = 0; link < links; ++link) {
      EXPECT_GT(world->contact_force(link), 0.0) << "link " << link;
      EXPECT_EQ(world->link_contacts(link), links == 1 ? 2U : 3U) << "link " << link << ": one alone has no front half";
    }
  }
}

TEST_P(WorldContract, TheContactsCarryTheWeight) {
  for (const std::size_t links : {1U, 2U, 3U, 6U}) {
    for (const double heading : {0.0, 0.6}) {
      SCOPED_TRACE(std::to_string(links) + " links, heading " + std::to_string(heading));
      expect_to_carry_the_weight(GetParam(), bending_chain(GetParam(), links), heading);
    }
  }
}

TEST_P(RoundShapes, TheContactsCarryTheWeight) {
  for (const Shape shape : {Shape::sphere, Shape::cylinder}) {
    SCOPED_TRACE(static_cast<int>(shape));
    RobotModel robot = chain(3);
    for (Link& link : robot.links) {
      link.geometries[0].shape = shape;
      link.geometries[0].extents = {0.02, 0.04, 0.02};
    }
    expect_to_carry_the_weight(GetParam(), robot, 0.0);
  }
}

TEST_P(RoundShapes, ACylinderLiesAlongYAndASphereIsRound) {
  for (const Shape shape : {Shape::cylinder, Shape::sphere}) {
    RobotModel robot = chain(1);
    robot.links[0].geometries[0].shape = shape;
    robot.links[0].geometries[0].extents = {0.03, 0.1, 0};
    const std::unique_ptr<World> world = make(robot, flat_ground(0.5, 0.05));
    run(*world, 2.0);
    EXPECT_NEAR(world->center_of_mass().z(), 0.03, 2e-3);
  }
}

// An arch stands on the foremost edge of the head and on the rearmost edge of the tail.
TEST_P(WorldContract, TheCentreOfPressureIsBelowTheCentreOfMass) {
  RobotModel robot = chain(6);
  robot.links[1].mass.mass = 0.5;
  const std::unique_ptr<World> world = make(robot, flat_ground(0.5, 0.02));
  bend(*world, 5, -0.15, 4.0);
  ASSERT_TRUE(world->is_slower_than(GetParam().rest, 10 * GetParam().rest));
  const double front = (world->link_pose(0) * Eigen::Vector3d(0, 0.04, -0.02)).y();
  const double rear = (world->link_pose(5) * Eigen::Vector3d(0, -0.04, -0.02)).y();
  for (std::size_t link = 1; link < 5; ++link) {
    EXPECT_EQ(world->contact_force(link), 0.0) << "link " << link;
  }
  const double weight = 1.0 * gravity;
  EXPECT_NEAR((world->contact_force(0) + world->contact_force(5)) / weight, 1.0, GetParam().weight);
  const double pressure = (world->contact_force(0) * front + world->contact_force(5) * rear) / weight;
  EXPECT_NEAR(pressure, world->center_of_mass().y(), 0.5 * GetParam().weight);
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

TEST_P(WorldContract, ALinkSlidesWithTheAccelerationThatCoulombFrictionLeaves) {
  const double angle = 25.0 / 180.0 * pi;
  for (const double friction : {0.0, 0.1, 0.3, 0.6, 1.0}) {
    SCOPED_TRACE(friction);
    EnvironmentModel environment = flat_ground(friction, 0.02);
    environment.gravity = {0, -gravity * std::sin(angle), -gravity * std::cos(angle)};
    const std::unique_ptr<World> world = make(chain(1), environment);
    const double expected = std::max(0.0, gravity * (std::sin(angle) - friction * std::cos(angle)));
    EXPECT_NEAR(sliding_acceleration(*world), expected, GetParam().sliding * gravity);
    const double normal = 0.1 * gravity * std::cos(angle);
    constexpr int steps = 500;
    const double start = world->center_of_mass().y();
    double mean = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double before = world->center_of_mass().y();
      world->step();
      const double speed = (before - world->center_of_mass().y()) / step_s;
      const ContactSliding sliding = world->contact_sliding();
      ASSERT_NEAR(sliding.normal_force, normal, GetParam().step_force * normal);
      ASSERT_NEAR(sliding.force_times_speed, normal * speed, 10 * GetParam().step_force * normal);
      mean += sliding.normal_force / steps;
    }
    EXPECT_NEAR(mean, normal, 3e-3 * normal);
    if (expected == 0.0) {
      EXPECT_NEAR(world->center_of_mass().y(), start, steps * step_s * GetParam().rest) << "it stays";
    }
  }
}

TEST_P(WorldContract, FrictionOfTwoSurfacesIsTheGeometricMean) {
  RobotModel robot = chain(1);
  robot.links[0].geometries[0].friction = 0.9;
  EnvironmentModel environment = flat_ground(0.1, 0.02);  // mean 0.3
  environment.gravity = {0, -4.0, -9.0};                  // needs 0.444
  const std::unique_ptr<World> world = make(robot, environment);
  EXPECT_NEAR(sliding_acceleration(*world), 4.0 - 0.3 * 9.0, GetParam().sliding * gravity);
}

TEST_P(WorldContract, FrictionOfTwoSurfacesWithoutOneIsTheEnvironments) {
  for (const double friction : {0.1, 0.3}) {
    EnvironmentModel environment = flat_ground(0.0, 0.02);
    environment.objects[0].geometries[0].friction.reset();
    environment.unspecified_friction = friction;
    environment.gravity = {0, -4.0, -9.0};
    const std::unique_ptr<World> world = make(chain(1), environment);
    EXPECT_NEAR(sliding_acceleration(*world), 4.0 - friction * 9.0, GetParam().sliding * gravity);
  }
}

TEST_P(WorldContract, FrictionTakesTheEnergyThatASlidingLinkLoses) {
  EnvironmentModel environment = flat_ground(0.3, 0.02);
  environment.gravity.y() = -5.0;
  const std::unique_ptr<World> world = make(chain(1), environment);
  run(*world, 0.5);
  const double before = world->energy();
  double taken = 0.0;
  for (int i = 0; i < 500; ++i) {
    world->step();
    taken += world->contact_sliding().friction_power * step_s;
  }
  EXPECT_GT(taken, 0.1);
  EXPECT_NEAR(before - world->energy(), taken, 0.03 * taken);
  EXPECT_EQ(world->contact_count(), GetParam().contacts_of_a_box)
      << "a link that slides touches the ground in every step";
}

/// A plate and its load, in m/s^2. In a planar engine the plate points to where it is pulled.
std::unique_ptr<World> pulled(const Engine& engine, double friction, double load, double heading) {
  RobotModel plate;
  plate.links.push_back(box_link(0, {0.05, 0.03, 0.005}, 0.1));
  EnvironmentModel environment = flat_ground(friction, 0.005);
  environment.gravity += load * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
  if (engine.is_planar) {
    environment.robot_pose.orientation = turn(heading - pi / 2, Eigen::Vector3d::UnitZ());
  }
  return engine.make(plate, environment);
}

TEST_P(PulledPlate, AcceleratesByWhatItsLoadIsAboveTheFriction) {
  const auto& [engine, heading_deg] = GetParam();
  const double heading = heading_deg / 180 * pi;
  const Eigen::Vector2d direction(std::cos(heading), std::sin(heading));
  constexpr double load = 4.0;
  for (const double friction : {0.0, 0.1, 0.3, 0.39}) {
    const std::unique_ptr<World> world = pulled(engine, friction, load, heading);
    const auto after = [&](double seconds) -> Eigen::Vector2d {
      run(*world, seconds);
      return world->center_of_mass().head<2>();
    };
    const Eigen::Vector2d start = after(0.2);
    const Eigen::Vector2d middle = after(0.4);
    const Eigen::Vector2d acceleration = (after(0.4) - 2.0 * middle + start) / (0.4 * 0.4);
    const double expected = load - friction * gravity;
    EXPECT_NEAR(acceleration.dot(direction), expected, 0.02) << "friction " << friction;
    EXPECT_LT((acceleration - acceleration.dot(direction) * direction).norm(), 0.02) << "friction " << friction;
  }
}

TEST_P(PulledPlate, StaysIfItsLoadIsBelowTheFriction) {
  const auto& [engine, heading_deg] = GetParam();
  for (const double share : {0.5, 0.97}) {
    constexpr double friction = 0.4;
    const std::unique_ptr<World> world = pulled(engine, friction, share * friction * gravity, heading_deg / 180 * pi);
    run(*world, 0.2);
    const Eigen::Vector3d start = world->center_of_mass();
    run(*world, 1.0);
    EXPECT_LT((world->center_of_mass() - start).norm(), 1e-3) << share << " of the friction";
  }
}

// Down a slope without friction, then onto one that brakes.
TEST_P(SeveralObjects, ALinkStopsAfterTheDistanceThatCoulombFrictionNeeds) {
  constexpr double friction = 0.5;
  constexpr double drive = 2.0;  // m/s^2
  EnvironmentModel environment = flat_ground(0.0, 0.02);
  environment.objects.push_back(floor_with_friction(friction));
  environment.objects[0].pose.position.y() = 49.0;  // to y = -1
  environment.objects[1].pose.position.y() = -51.0;
  environment.gravity = {0, -drive, -gravity};
  const std::unique_ptr<World> world = make(chain(1), environment);
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

TEST_P(WorldContract, APositiveJointAngleRaisesTheLinkInFront) {
  const std::unique_ptr<World> world = make(chain(2), weightless());
  world->set_joint_speed(0, 1.0);
  run(*world, 0.5);
  EXPECT_NEAR(world->joint_angle(0), 0.5, GetParam().joint);
  const Eigen::Vector3d head_direction = world->link_pose(0).orientation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d tail_direction = world->link_pose(1).orientation * Eigen::Vector3d::UnitY();
  EXPECT_GT(head_direction.z(), 0.1);
  EXPECT_LT(tail_direction.z(), -0.1);
  EXPECT_NEAR(std::acos(head_direction.dot(tail_direction)), world->joint_angle(0), 1e-6);
}

TEST_P(WorldContract, JointsMoveTheLinksAsInOde) {
  std::vector<Eigen::Vector3d> axes{Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
  if (!GetParam().is_planar) {
    axes.push_back(Eigen::Vector3d(1, 0, 1).normalized());
  }
  for (const double heading : {0.0, 2.5}) {
    for (const Eigen::Vector3d& axis : axes) {
      EnvironmentModel environment = weightless();
      environment.robot_pose.orientation = turn(heading, Eigen::Vector3d::UnitZ());
      RobotModel robot = chain(3);
      robot.joints[1].axis = axis;
      const std::unique_ptr<World> world = make(robot, environment);
      const std::unique_ptr<World> ode = ode_world(robot, environment);
      for (World* each : {world.get(), ode.get()}) {
        each->set_joint_speed(0, 1.0);
        each->set_joint_speed(1, 0.4);
        run(*each, 0.5);
      }
      EXPECT_NEAR(world->joint_angle(0), 0.5, GetParam().joint);
      EXPECT_NEAR(world->joint_angle(1), 0.2, GetParam().joint);
      for (std::size_t link = 0; link < 3; ++link) {
        expect_near(world->link_pose(link), ode->link_pose(link), 2e-3, 2e-3, "link " + std::to_string(link));
      }
    }
  }
}

/// The last link is a heavy foot at the edge of a floor; the other one reaches out over the edge. To hold it the motor
/// needs 0.049 Nm.
struct Arm {
  Arm() : robot(chain(2)), environment(flat_ground(1.0, 0.02)) {
    robot.links.back().mass.mass = 100.0;
    robot.links.back().mass.inertia *= 1000.0;
    robot.links.back().geometries[0].extents.y() = 0.008;
    environment.objects[0].pose.position.y() = robot.links.back().pose.position.y() + 0.01 - 50.0;
  }
  RobotModel robot;
  EnvironmentModel environment;
};

TEST_P(WorldContract, AMotorGivesTheTorqueThatHoldsItsLink) {
  const Arm arm;
  const std::unique_ptr<World> world = make(arm.robot, arm.environment);
  EXPECT_EQ(world->motor_torque(0), 0.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->motor_torque(0), 0.1 * gravity * 0.05, GetParam().torque);
}

TEST_P(WorldContract, AMotorDoesNotExceedItsTorque) {
  for (const double torque : {0.04, 0.06}) {
    Arm arm;
    arm.robot.joints[0].max_torque = torque;
    const std::unique_ptr<World> world = make(arm.robot, arm.environment);
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

TEST_P(WorldContract, AJammedJointStaysAndALimpOneFallsToItsStop) {
  const Arm arm;
  const std::unique_ptr<World> world = make(arm.robot, arm.environment);
  world->set_joint_torque(0, 40.0);
  world->set_joint_speed(0, 0.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(0), 0.0, 5 * GetParam().stop);
  world->set_joint_torque(0, 0.0);
  for (int i = 0; i < 3000; ++i) {
    world->step();
    EXPECT_GT(world->joint_angle(0), -1.005 - 7 * GetParam().stop) << "at most the way of a step";
    EXPECT_EQ(world->motor_torque(0), 0.0);
  }
  EXPECT_NEAR(world->joint_angle(0), -1.0, 1e-3);
}

TEST_P(WorldContract, AJointStopsAtItsLimitsAlsoIfTheyAreEqual) {
  RobotModel robot = chain(4);
  robot.joints[0].lower_limit = -0.2;
  robot.joints[1].axis = -Eigen::Vector3d::UnitX();
  robot.joints[1].upper_limit = 0.3;
  robot.joints[2].lower_limit = robot.joints[2].upper_limit = 0.0;
  const std::unique_ptr<World> world = make(robot, weightless());
  for (int i = 0; i < 1000; ++i) {
    world->set_joint_speed(0, -2.0);
    world->set_joint_speed(1, 2.0);
    world->set_joint_speed(2, 2.0);
    world->step();
    EXPECT_GE(world->joint_angle(0), -0.2 - GetParam().stop);
    EXPECT_LE(world->joint_angle(1), 0.3 + GetParam().stop);
  }
  EXPECT_NEAR(world->joint_angle(0), -0.2, GetParam().stop);
  EXPECT_NEAR(world->joint_angle(1), 0.3, GetParam().stop);
  EXPECT_NEAR(world->joint_angle(2), 0.0, GetParam().stop);
}

// A robot without power, whose joints stand at 0, where a stop is.
TEST_P(WorldContract, LimpJointsThatStartAtAStopLieOnTheGround) {
  for (const auto& [lower, upper] : {std::pair(0.0, 1.5), std::pair(-1.5, 0.0), std::pair(0.0, 0.0)}) {
    for (const std::size_t limited : {0U, 1U, 2U}) {
      RobotModel robot = chain(4);
      robot.joints[limited].lower_limit = lower;
      robot.joints[limited].upper_limit = upper;
      const std::unique_ptr<World> world = make(robot, flat_ground(0.5, 0.02));
      for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        world->set_joint_torque(joint, 0);
      }
      run(*world, 1.0);
      EXPECT_NEAR(world->center_of_mass().z(), 0.02, 0.002) << "joint " << limited << ", " << lower << " to " << upper;
      EXPECT_EQ(world->solver_messages(), 0U);
    }
  }
}

TEST_P(WorldContract, ASensorIsPressedWhereTheLinkTouches) {
  const std::unique_ptr<World> world = make(chain(3), flat_ground(0.5, 0.02));
  run(*world, 0.2);
  for (std::size_t link = 0; link < 3; ++link) {
    EXPECT_EQ(world->link_contacts(link), 3U) << "lying flat, link " << link;
  }
  // Arch the middle: the head touches with its foremost edge, the tail with its rearmost, the middle link with none.
  bend(*world, 2, -0.5, 0.6);
  EXPECT_EQ(world->link_contacts(0), 2U);
  EXPECT_EQ(world->link_contacts(1), 0U);
  EXPECT_EQ(world->link_contacts(2), 1U);
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

constexpr double ball_radius = 0.004;

/// An object that just reaches the point `surface` of the robot's frame, from the direction `outwards`: a ball, or a
/// bar across the robot. Nothing moves.
EnvironmentModel touching(const Touch& touch, Shape shape, const Pose& robot_pose = {}) {
  constexpr double depth = 0.0001;
  EnvironmentModel environment = weightless();
  environment.robot_pose = robot_pose;
  StaticObject object;
  Geometry geometry;
  geometry.shape = shape;
  geometry.extents = {shape == Shape::box ? 1.0 : ball_radius, ball_radius, ball_radius};
  object.pose.position =
      robot_pose * Eigen::Vector3d(touch.surface + (ball_radius - depth) * touch.outwards.normalized());
  object.geometries.push_back(geometry);
  environment.objects.push_back(object);
  return environment;
}

/// Expects the right sensors of the middle of three links, and none of the others.
void expect_touch(const Engine& engine, const RobotModel& robot, Touch touch, Shape shape,
                  const Pose& robot_pose = {}) {
  touch.surface += Eigen::Vector3d(0, -0.1, 0);
  const std::unique_ptr<World> world = engine.make(robot, touching(touch, shape, robot_pose));
  world->step();
  EXPECT_GT(world->contact_count(), 0U) << touch.surface.transpose();
  if (shape == Shape::sphere) {
    EXPECT_EQ(world->contact_count(), 1U) << touch.surface.transpose();
  }
  EXPECT_EQ(world->link_contacts(0), 0U) << touch.surface.transpose();
  EXPECT_EQ(world->link_contacts(1), touch.sensors)
      << touch.surface.transpose() << " outwards " << touch.outwards.transpose();
  EXPECT_EQ(world->link_contacts(2), 0U) << touch.surface.transpose();
}

TEST_P(TouchingBoxes, PressTheSensorsUnderTheLinkAndNoneOnItsBack) {
  for (const Touch& touch : touches_all_around()) {
    if (touch.outwards.x() == 0.0 && touch.outwards.squaredNorm() == 1.0) {  // a bar touches no edge, and no flank
      expect_touch(GetParam(), chain(3), touch, Shape::box);
    }
  }
}

TEST_P(RoundShapes, SensorsLieUnderTheLinkAndIgnoreItsBackAndFlanks) {
  for (const Touch& touch : touches_all_around()) {
    expect_touch(GetParam(), chain(3), touch, Shape::sphere);
  }
}

TEST_P(RoundShapes, TheUndersideIsThatOfTheRobotsFileForEveryStartPose) {
  for (const double roll : {0.5, 1.5, 3.0}) {
    for (const Touch& touch : touches_all_around()) {
      expect_touch(GetParam(), chain(3), touch, Shape::sphere, {{1, 2, 3}, turn(roll, {1, 2, -1})});
    }
  }
}

TEST_P(RoundShapes, TheUndersideDoesNotDependOnTheFrameOfTheLink) {
  const Eigen::Quaterniond turned = turn(2.0, {3, -1, 2});
  RobotModel robot = chain(3);
  Link& link = robot.links[1];
  link.pose.orientation = turned;
  link.mass.inertia = turned.conjugate() * link.mass.inertia * turned;
  link.geometries[0].pose.orientation = turned.conjugate();
  for (const Touch& touch : touches_all_around()) {
    expect_touch(GetParam(), robot, touch, Shape::sphere);
  }
}

TEST_P(RoundShapes, ARobotUprightInItsFileHasItsSensorsTowardsMinusY) {
  const Eigen::Quaterniond upright = turn(pi / 2, Eigen::Vector3d::UnitX());  // y to z, z to -y
  RobotModel robot = chain(3);
  for (Link& link : robot.links) {
    link.pose = Pose{{0, 0, 0}, upright} * link.pose;
  }
  for (Joint& joint : robot.joints) {
    joint.anchor = upright * joint.anchor;
  }
  const Eigen::Vector3d middle(0, 0.1, -0.1);  // of the middle link, from where that of a flat robot is
  expect_touch(GetParam(), robot, {middle + Eigen::Vector3d(0, -0.02, 0.03), {0, -1, 0}, 2}, Shape::sphere);
  expect_touch(GetParam(), robot, {middle + Eigen::Vector3d(0, -0.02, -0.03), {0, -1, 0}, 1}, Shape::sphere);
  expect_touch(GetParam(), robot, {middle + Eigen::Vector3d(0, 0.02, 0.03), {0, 1, 0}, 0}, Shape::sphere);
}

TEST_P(WorldContract, TheGroundPressesNoSensorOfARobotOnItsBackOrOnItsSide) {
  for (const double roll : {180.0, 90.0, 270.0}) {
    EnvironmentModel environment = flat_ground(0.5, 0.02);
    environment.robot_pose.orientation = turn(roll / 180 * pi, Eigen::Vector3d::UnitY());
    const std::unique_ptr<World> world = make(chain(3), environment);
    run(*world, 0.2);
    EXPECT_EQ(world->contact_count(), 3 * GetParam().contacts_of_a_box);
    for (std::size_t link = 0; link < 3; ++link) {
      EXPECT_EQ(world->link_contacts(link), 0U) << "roll " << roll << ", link " << link;
    }
    if (GetParam().is_planar) {
      return;  // it has no robots on their sides
    }
  }
}

TEST_P(SelfCollision, SeparatesLinksThatAreNotNeighbours) {
  for (const bool self_collision : {false, true}) {
    EnvironmentModel environment = weightless();
    environment.self_collision = self_collision;
    RobotModel robot = chain(3);
    for (Joint& joint : robot.joints) {
      joint.lower_limit = -3.0;
      joint.upper_limit = 3.0;
    }
    const std::unique_ptr<World> world = make(robot, environment);
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

TEST_P(WorldContract, ARobotIsMovedAsARigidBodyAndRests) {
  std::vector<Pose> motions;
  for (const double heading : {0.4, pi / 2, -3.0}) {
    motions.push_back({{0.3, -0.2, 0.05}, turn(heading, Eigen::Vector3d::UnitZ())});
  }
  if (!GetParam().is_planar) {
    motions.push_back({{1, 2, 0.5}, turn(1.0, {1, 2, 3})});
  }
  for (const Pose& motion : motions) {
    const std::unique_ptr<World> world = make(bending_chain(GetParam(), 4), flat_ground(0.5, 0.02));
    for (int i = 0; i < 300; ++i) {
      wriggle(*world, 3, i);
    }
    std::vector<Pose> poses(4);
    world->read_links(poses);
    const double angle = world->joint_angle(1);
    ASSERT_FALSE(world->is_slower_than(1e-3, 1e-3));
    world->move_robot(motion);
    EXPECT_EQ(world->joint_angle(1), angle);
    EXPECT_TRUE(world->is_slower_than(1e-12, 1e-12));
    for (std::size_t link = 0; link < 4; ++link) {
      expect_near(world->link_pose(link), motion * poses[link], GetParam().position, GetParam().rotation,
                  "link " + std::to_string(link));
      EXPECT_EQ(world->link_contacts(link), 0U);
      EXPECT_EQ(world->contact_force(link), 0.0);
    }
    for (int i = 300; i < 900; ++i) {
      wriggle(*world, 3, i);
    }
    EXPECT_GT(world->contact_count(), 0U) << "it fell and lies on the ground";
  }
}

TEST_P(WorldContract, MotorsGoOnAfterAMove) {
  const std::unique_ptr<World> world = make(chain(2), weightless());
  world->set_joint_speed(0, 1.0);
  run(*world, 0.1);
  world->move_robot({{1, 1, 1}, turn(0.5, Eigen::Vector3d::UnitZ())});
  run(*world, 0.1);
  EXPECT_NEAR(world->joint_angle(0), 0.2, 1e-3);
}

TEST_P(WorldContract, ReturnsTheLowestPointOfItsEnvironment) {
  EXPECT_EQ(make(chain(1), EnvironmentModel{})->lowest_ground(), std::nullopt);
  EnvironmentModel beside = flat_ground(0.1, 0.026);
  beside.objects[0].pose.position.x() = 51.0;
  for (const EnvironmentModel& environment : {flat_ground(0.1, 0.026), beside}) {
    EXPECT_EQ(make(chain(1), environment)->lowest_ground(), -1.0);
  }
}

/// Numbers of a run that slips, bends and touches.
std::vector<double> trace(const Engine& engine) {
  const std::unique_ptr<World> world = engine.make(bending_chain(engine, 4), flat_ground(0.2, 0.03));
  std::vector<double> numbers;
  for (int i = 0; i < 1500; ++i) {
    wriggle(*world, 3, i);
    const Eigen::Vector3d center = world->center_of_mass();
    numbers.insert(numbers.end(), center.begin(), center.end());
    const std::vector<double> state = world->state();
    numbers.insert(numbers.end(), state.begin(), state.end());
  }
  return numbers;
}

TEST_P(WorldContract, RepeatsToTheLastBitOnEveryThread) {
  const std::vector<double> expected = trace(GetParam());
  std::array<std::vector<double>, 4> traces;
  std::vector<std::thread> threads;
  threads.reserve(traces.size());
  for (std::vector<double>& found : traces) {
    threads.emplace_back([&found, &engine = GetParam()] { found = trace(engine); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::vector<double>& found : traces) {
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace proleg::sim
