#include "sim/ode/ode_world.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>

#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim {
namespace {

std::unique_ptr<World> iterative_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::iterative);
}

const Engine direct{.name = "Direct", .make = ode_world, .position = 1e-12, .stop = 2.1e-3};
const Engine iterative{.name = "Iterative", .make = iterative_world};

INSTANTIATE_TEST_SUITE_P(Ode, WorldContract, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, RoundShapes, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, SelfCollision, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, SeveralObjects, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, ConvexMeshes, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, HeightFields, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, MovingObjects, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, TouchingBoxes, testing::Values(direct), engine_name);
INSTANTIATE_TEST_SUITE_P(Ode, PulledPlate, testing::Combine(testing::Values(direct, iterative), headings),
                         engine_and_heading);

/// Runs until the engine fails. With almost no inertia its direct solver fails one of its assertions.
void struggle() {
  RobotModel robot = chain(6);
  for (Link& link : robot.links) {
    link.mass.inertia = Eigen::Matrix3d::Identity() * 1e-200;
  }
  const std::unique_ptr<World> world = ode_world(robot, flat_ground(0.1, 0.026));
  for (int i = 0; i < 20'000; ++i) {
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
      world->set_joint_speed(joint, std::sin(0.006 * i + static_cast<double>(joint)));
    }
    world->step();
  }
}

TEST(OdeWorld, AnErrorOfTheEngineIsThrownAndTheWorldCanBeDestroyed) {
  EXPECT_THROW(struggle(), PhysicsError);
  EXPECT_THROW(struggle(), PhysicsError) << "the first failure does not disturb the next world";
}

TEST(OdeWorld, AnErrorOfTheEngineLeavesLessThanAKilobyte) {
  EXPECT_THROW(struggle(), PhysicsError);  // what is allocated once
  constexpr std::size_t failures = 20;
  const std::size_t before = mallinfo2().uordblks;
  for (std::size_t i = 0; i < failures; ++i) {
    EXPECT_THROW(struggle(), PhysicsError);
  }
  EXPECT_LT(mallinfo2().uordblks, before + failures * 1024);
}

TEST(OdeWorld, TheIterativeStepperRepeatsToo) {
  const auto wriggle_iteratively = [] {
    const std::unique_ptr<World> world = iterative_world(chain(10), flat_ground(0.2, 0.03));
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
