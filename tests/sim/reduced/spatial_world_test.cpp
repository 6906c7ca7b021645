// Chains whose joints have different axes. Oracles: mechanics of rigid bodies, the engine of chains in a plane, and
// ODE.

#include "sim/reduced/reduced_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/chain_batch.hpp"
#include "sim/reduced/robot_chain.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim::reduced {
namespace {

std::unique_ptr<World> spatial_world(const RobotModel& robot, const EnvironmentModel& environment) {
  SpatialChain chain = make_spatial_chain(robot, environment, step_s, "test");
  auto batch = std::make_shared<ChainBatch<Spatial>>(std::span(&chain, 1));
  return make_world({&robot, &environment, step_s, "test"}, std::move(chain), std::move(batch), 0);
}

const Engine spatial_engine{.name = "Spatial",
                            .make = spatial_world,
                            .position = 1e-7,
                            .rest = 1e-4,
                            .sliding = 1e-4,
                            .joint = 1e-9,
                            .stop = 1e-6};

INSTANTIATE_TEST_SUITE_P(Spatial, WorldContract, testing::Values(spatial_engine), engine_name);
INSTANTIATE_TEST_SUITE_P(Spatial, PulledPlate, testing::Combine(testing::Values(spatial_engine), headings),
                         engine_and_heading);

/// Every second joint turns about z.
RobotModel snake(std::size_t links) {
  RobotModel robot = chain(links);
  for (std::size_t joint = 1; joint < robot.joints.size(); joint += 2) {
    robot.joints[joint].axis = Eigen::Vector3d::UnitZ();
  }
  return robot;
}

/// A gait of a snake: waves of both kinds of joints.
void drive(World& world, std::size_t joints, double seconds, double amplitude, double phase) {
  for (std::size_t joint = 0; joint < joints; ++joint) {
    const double angle = amplitude * std::sin(2.0 * std::numbers::pi * seconds + phase * static_cast<double>(joint) +
                                              (joint % 2 == 1 ? 1.0 : 0.0));
    const double speed = 20.0 * (angle - world.joint_angle(joint));
    world.set_joint_speed(joint, std::clamp(speed, -4.5, 4.5));
  }
}

TEST(SpatialWorld, AMotorTurnsTheLinkInFrontAboutTheAxis) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, 2, -2)}) {
    RobotModel robot = chain(2);
    robot.joints[0].axis = axis.normalized();
    const std::unique_ptr<World> world = spatial_world(robot, weightless());
    world->set_joint_speed(0, 1.5);
    run(*world, 0.4);
    EXPECT_NEAR(world->joint_angle(0), 0.6, 1e-9);
    const Pose rear = world->link_pose(1);
    const Pose front = rear.inverse() * world->link_pose(0);
    EXPECT_LT(front.orientation.angularDistance(turn(0.6, axis)), 1e-6);
    const Eigen::Vector3d anchor = robot.joints[0].anchor;
    const Eigen::Vector3d in_front = world->link_pose(0) * (anchor - robot.links[0].pose.position);
    const Eigen::Vector3d in_rear = rear * (anchor - robot.links[1].pose.position);
    EXPECT_LT((in_front - in_rear).norm(), 1e-9) << "the links stay together";
  }
}

TEST(SpatialWorld, MotorsAloneNeitherMoveTheCentreNorChangeTheAngularMomentum) {
  const RobotModel robot = snake(5);
  const EnvironmentModel environment = weightless();
  SpatialChain chain = make_spatial_chain(robot, environment, step_s, "test");
  const auto batch = std::make_shared<ChainBatch<Spatial>>(std::span(&chain, 1));
  const std::unique_ptr<World> world = make_world({&robot, &environment, step_s, "test"}, chain, batch, 0);
  const Eigen::Vector3d before = world->center_of_mass();
  for (int step = 0; step < 2000; ++step) {
    drive(*world, 4, step * step_s, 0.6, 0.9);
    world->step();
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    double magnitude = 0.0;
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const ChainBatch<Spatial>::LinkMotion motion = batch->link_motion(0, i);
      const ChainBatch<Spatial>::LinkPlace place = batch->link_place(0, i);
      const Eigen::Vector3d position(place.position.x, place.position.y, place.position.z);
      const Eigen::Vector3d velocity(motion.velocity.x, motion.velocity.y, motion.velocity.z);
      const Eigen::Vector3d own(motion.angular_momentum.x, motion.angular_momentum.y, motion.angular_momentum.z);
      const Eigen::Vector3d part = own + chain.masses[i] * (position - before).cross(velocity);
      momentum += part;
      magnitude += part.norm();
    }
    // The places are those after the step, the velocities those of the step: an error of the first order in the step.
    ASSERT_LT(momentum.norm(), 0.02 * magnitude + 1e-9) << step;
  }
  EXPECT_LT((world->center_of_mass() - before).norm(), 1e-12);
}

TEST(SpatialWorld, ATumblingBodyKeepsItsEnergy) {
  // Two links whose joint cannot turn are one body. It falls on the edge of the floor, tumbles over it and falls on.
  RobotModel robot = chain(2);
  robot.joints[0].lower_limit = 0.0;
  robot.joints[0].upper_limit = 0.0;
  EnvironmentModel environment;
  environment.objects.push_back(floor_with_friction(0.5));
  environment.objects[0].geometries[0].extents = {0.5, 0.5, 0.005};
  environment.objects[0].pose.position = {-0.49, 0.46, -0.005};
  environment.robot_pose = {{0, 0, 0.1}, turn(0.5, {1, 1, 0.3})};
  const std::unique_ptr<World> world = spatial_world(robot, environment);
  bool touched = false;
  int steps = 0;
  while (world->center_of_mass().z() > -0.1 && steps < 3000) {
    world->step();
    touched = touched || world->contact_count() > 0;
    ++steps;
  }
  ASSERT_TRUE(touched);
  ASSERT_LT(steps, 3000) << "it fell over the edge";
  ASSERT_FALSE(world->is_slower_than(100.0, 1.0)) << "it tumbles";
  const double energy = world->energy();
  constexpr double seconds = 0.5;
  run(*world, seconds);
  // What semi-implicit Euler loses in a free fall, see WorldContract.
  const double lost = 0.2 * gravity * gravity * seconds * step_s / 2;
  EXPECT_NEAR(world->energy(), energy - lost, 0.005 * energy);
}

TEST(SpatialWorld, AMotorGivesNoMoreThanItsTorque) {
  // It must lift a link of 0.1 kg at a lever of 50 mm: 0.049 Nm.
  RobotModel robot = snake(3);
  robot.joints[0].max_torque = 0.02;
  const std::unique_ptr<World> world = spatial_world(robot, flat_ground(0.5, 0.02));
  for (int step = 0; step < 1000; ++step) {
    world->set_joint_speed(0, 1.0);
    world->step();
    EXPECT_LE(std::abs(world->motor_torque(0)), 0.02);
  }
  EXPECT_NEAR(world->joint_angle(0), 0.0, 0.01);
  world->set_joint_torque(0, 1.0);
  run(*world, 0.3);
  EXPECT_NEAR(world->joint_angle(0), 0.3, 0.02);
  EXPECT_NEAR(world->motor_torque(0), 0.1 * gravity * 0.05 * std::cos(0.3), 0.005);
}

TEST(SpatialWorld, AJointStaysWithinItsStops) {
  RobotModel robot = snake(3);
  robot.joints[1].lower_limit = -0.2;
  robot.joints[1].upper_limit = 0.3;
  const std::unique_ptr<World> world = spatial_world(robot, flat_ground(0.5, 0.02));
  world->set_joint_speed(1, 4.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(1), 0.3, 1e-6);
  world->set_joint_speed(1, -4.0);
  run(*world, 1.0);
  EXPECT_NEAR(world->joint_angle(1), -0.2, 1e-6);
}

TEST(SpatialWorld, MovesAsTheChainInAPlaneIfAllAxesAreParallel) {
  const RobotModel robot = chain(5);
  const EnvironmentModel environment = flat_ground(0.4, 0.02);
  const std::unique_ptr<World> world = spatial_world(robot, environment);
  const std::unique_ptr<World> planar = make_reduced_world(robot, environment, step_s, "test");
  for (int step = 0; step < 3000; ++step) {
    for (World* each : {world.get(), planar.get()}) {
      drive(*each, 4, step * step_s, 0.5, 1.2);
      each->step();
    }
  }
  const Eigen::Vector3d start(0, -0.2, 0.02);
  const double distance = (planar->center_of_mass() - start).norm();
  ASSERT_GT(distance, 0.1);
  EXPECT_LT((world->center_of_mass() - planar->center_of_mass()).norm(), 0.05 * distance);
}

TEST(SpatialWorld, ASnakeGoesWhereItGoesInOde) {
  // Gaits in which the robot does not tip over: whether it does may depend on the step even in one engine.
  for (const double phase : {0.7, -1.1}) {
    const RobotModel robot = snake(6);
    const EnvironmentModel environment = flat_ground(0.3, 0.02);
    const std::unique_ptr<World> world = spatial_world(robot, environment);
    const std::unique_ptr<World> ode = ode_world(robot, environment);
    const Eigen::Vector3d start = ode->center_of_mass();
    for (int step = 0; step < 4000; ++step) {
      for (World* each : {world.get(), ode.get()}) {
        drive(*each, 5, step * step_s, 0.3, phase);
        each->step();
      }
    }
    const double distance = (ode->center_of_mass() - start).norm();
    ASSERT_GT(distance, 0.05);
    EXPECT_LT((world->center_of_mass() - ode->center_of_mass()).norm(), 0.1 * distance) << phase;
  }
}

TEST(SpatialWorld, FailsInOneLineWhenLinksTouchThatAreNotNeighbours) {
  RobotModel robot = snake(6);
  for (Joint& joint : robot.joints) {
    joint.axis = Eigen::Vector3d(0.01, 0, 1).normalized();
    joint.upper_limit = 3.0;
  }
  EnvironmentModel environment = flat_ground(0.1, 0.02);
  const auto roll_up = [&] {
    const std::unique_ptr<World> world = spatial_world(robot, environment);
    for (int step = 0; step < 3000; ++step) {
      for (std::size_t joint = 0; joint < 5; ++joint) {
        world->set_joint_speed(joint, 1.0);
      }
      world->step();
    }
  };
  EXPECT_NO_THROW(roll_up()) << "they may pass through each other";
  environment.self_collision = true;
  try {
    roll_up();
    FAIL() << "no message";
  } catch (const PhysicsError& error) {
    EXPECT_NE(std::string(error.what()).find("touch each other"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("--engine ode"), std::string::npos) << error.what();
  }
}

TEST(SpatialWorld, RefusesByNameWhatItDoesNotHave) {
  const auto message = [](const RobotModel& robot, const EnvironmentModel& environment) -> std::string {
    try {
      static_cast<void>(make_reduced_world(robot, environment, step_s, "file.xml"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const EnvironmentModel ground = flat_ground(0.3, 0.02);
  EXPECT_EQ(message(snake(3), ground), "");
  EnvironmentModel environment = ground;
  environment.objects.push_back(floor_with_friction(0.5));
  environment.objects.back().name = "step";
  EXPECT_NE(message(snake(3), environment).find("a second object, 'step'"), std::string::npos);
  environment = ground;
  environment.objects[0].name = "ramp";
  environment.objects[0].pose.orientation = turn(0.1, Eigen::Vector3d::UnitX());
  EXPECT_NE(message(snake(3), environment).find("object 'ramp', which is not level"), std::string::npos);
  environment = ground;
  environment.objects[0].name = "ball";
  environment.objects[0].geometries[0].shape = Shape::sphere;
  EXPECT_NE(message(snake(3), environment).find("object 'ball' with a sphere"), std::string::npos);
  environment.objects[0].geometries[0].shape = Shape::surface;
  EXPECT_NE(message(snake(3), environment).find("object 'ball' with a triangle mesh"), std::string::npos);
  environment = ground;
  environment.moving_objects.push_back({"crate", {}, {}, {}, {}});
  EXPECT_NE(message(snake(3), environment).find("object 'crate', which moves"), std::string::npos);
  RobotModel robot = snake(3);
  robot.links[1].name = "Seg";
  robot.links[1].geometries[0].shape = Shape::cylinder;
  EXPECT_NE(message(robot, ground).find("link 'Seg' with a cylinder"), std::string::npos);
}

TEST(SpatialWorld, OneThatBreaksDownFailsInOneLineAndTouchesNoOther) {
  const RobotModel robot = snake(4);
  const EnvironmentModel ground = flat_ground(0.4, 0.02);
  EnvironmentModel broken = ground;
  broken.gravity.y() = std::numeric_limits<double>::infinity();
  const std::vector<WorldInput> inputs{
      {&robot, &ground, step_s, "test"}, {&robot, &broken, step_s, "test"}, {&robot, &ground, step_s, "test"}};
  ReducedWorlds together(inputs);
  const std::vector<std::unique_ptr<World>> worlds = together.take_worlds();
  const std::unique_ptr<World> alone = make_reduced_world(robot, ground, step_s, "test");
  for (int step = 0; step < 100; ++step) {
    together.step();
    alone->step();
    EXPECT_THROW(worlds[1]->step(), PhysicsError) << step;
  }
  for (const std::size_t i : {0U, 2U}) {
    EXPECT_NO_THROW(worlds[i]->step());
    EXPECT_EQ(worlds[i]->state(), alone->state()) << i;
  }
}

TEST(SpatialWorld, MakesItsStepsTogetherWithChainsInAPlane) {
  const RobotModel robots[] = {chain(3), snake(4), chain(3), snake(4)};
  const EnvironmentModel environment = flat_ground(0.4, 0.02);
  std::vector<WorldInput> inputs;
  for (const RobotModel& robot : robots) {
    inputs.push_back({&robot, &environment, step_s, "test"});
  }
  ReducedWorlds together(inputs);
  const std::vector<std::unique_ptr<World>> worlds = together.take_worlds();
  std::vector<std::unique_ptr<World>> alone;
  for (const RobotModel& robot : robots) {
    alone.push_back(make_reduced_world(robot, environment, step_s, "test"));
  }
  for (int step = 0; step < 300; ++step) {
    for (std::size_t i = 0; i < worlds.size(); ++i) {
      drive(*worlds[i], inputs[i].robot->joints.size(), step * step_s, 0.5, static_cast<double>(i));
      drive(*alone[i], inputs[i].robot->joints.size(), step * step_s, 0.5, static_cast<double>(i));
      alone[i]->step();
    }
    together.step();
  }
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    EXPECT_EQ(worlds[i]->state(), alone[i]->state()) << i;
  }
}

/// The bits of the states of worlds that are driven differently.
std::vector<std::vector<double>> states(std::size_t worlds, const ChainKernel* kernel, std::size_t batch_size) {
  RobotModel robot = snake(6);
  robot.joints[1].max_torque = 0.05;  // too weak at times
  robot.joints[2].max_torque = 0.03;
  std::vector<std::vector<double>> result;
  for (std::size_t first = 0; first < worlds; first += batch_size) {
    std::vector<EnvironmentModel> environments;
    for (std::size_t i = first; i < std::min(worlds, first + batch_size); ++i) {
      environments.push_back(flat_ground(0.1 * static_cast<double>(i), 0.02 + 0.005 * static_cast<double>(i % 3)));
      environments.back().robot_pose.orientation = turn(static_cast<double>(i), {1, 2, static_cast<double>(i)});
      environments.back().robot_pose.position.z() += 0.2;
    }
    std::vector<WorldInput> inputs;
    for (const EnvironmentModel& environment : environments) {
      inputs.push_back({&robot, &environment, step_s, "test"});
    }
    ReducedWorlds together(inputs, kernel);
    const std::vector<std::unique_ptr<World>> made = together.take_worlds();
    for (int step = 0; step < 800; ++step) {
      for (std::size_t i = 0; i < made.size(); ++i) {
        drive(*made[i], 5, step * step_s, 0.7, 0.3 * static_cast<double>(first + i));
      }
      together.step();
      for (const std::unique_ptr<World>& world : made) {
        world->step();
      }
    }
    for (const std::unique_ptr<World>& world : made) {
      result.push_back(world->state());
    }
  }
  return result;
}

TEST(SpatialWorld, GivesTheSameBitsWithEachKernelAndInEachCompany) {
  constexpr std::size_t worlds = 11;
  const auto expected = states(worlds, supported_kernels().front(), 1);
  for (const ChainKernel* kernel : supported_kernels()) {
    for (const std::size_t batch_size : {1U, 3U, 11U}) {
      const auto found = states(worlds, kernel, batch_size);
      for (std::size_t i = 0; i < worlds; ++i) {
        for (std::size_t k = 0; k < expected[i].size(); ++k) {
          ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i][k]), std::bit_cast<std::uint64_t>(expected[i][k]))
              << kernel->instructions << ", batches of " << batch_size << ", world " << i << ", number " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace proleg::sim::reduced
