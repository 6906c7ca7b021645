#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <random>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/world_contract.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim::mujoco {
namespace {

std::unique_ptr<World> mujoco_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_mujoco_world(robot, environment, step_s, "test");
}
std::unique_ptr<World> euler_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_mujoco_world(robot, environment, step_s, "test", Integrator::euler);
}

const Engine implicit{
    .name = "Implicit", .make = mujoco_world, .position = 1e-9, .rotation = 1e-9, .step_force = 2.0, .stop = 2e-3};
const Engine euler{
    .name = "Euler", .make = euler_world, .position = 1e-9, .rotation = 1e-9, .step_force = 2.0, .stop = 2e-3};

// Without TouchingBoxes: of two boxes MuJoCo also reports a corner of one that does not touch the other.
INSTANTIATE_TEST_SUITE_P(Mujoco, WorldContract, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, RoundShapes, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, SelfCollision, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, SeveralObjects, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, ConvexMeshes, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, HeightFields, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, MovingObjects, testing::Values(implicit, euler), engine_name);
INSTANTIATE_TEST_SUITE_P(Mujoco, PulledPlate, testing::Combine(testing::Values(implicit, euler), headings),
                         engine_and_heading);

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

}  // namespace
}  // namespace proleg::sim::mujoco
