#include "sim/reduced/reduced_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim::reduced {
namespace {

std::unique_ptr<World> reduced_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_reduced_world(robot, environment, step_s, "test");
}

const Engine planar_engine{.name = "Planar",
                           .make = reduced_world,
                           .is_planar = true,
                           .contacts_of_a_box = 2,
                           .position = 1e-7,
                           .weight = 1e-6,
                           .rest = 1e-7,
                           .sliding = 1e-4,
                           .joint = 1e-9,
                           .stop = 1e-8,
                           .torque = 1e-4};

INSTANTIATE_TEST_SUITE_P(Reduced, WorldContract, testing::Values(planar_engine), engine_name);
INSTANTIATE_TEST_SUITE_P(Reduced, SelfCollision, testing::Values(planar_engine), engine_name);
INSTANTIATE_TEST_SUITE_P(Reduced, SeveralObjects, testing::Values(planar_engine), engine_name);
INSTANTIATE_TEST_SUITE_P(Reduced, TouchingBoxes, testing::Values(planar_engine), engine_name);
INSTANTIATE_TEST_SUITE_P(Reduced, PulledPlate, testing::Combine(testing::Values(planar_engine), headings),
                         engine_and_heading);

TEST(ReducedWorld, AMovedRobotGoesOnAsItDoesElsewhere) {
  for (const double heading : {0.4, std::numbers::pi / 2, -3.0}) {
    const Pose motion{{0.3, -0.2, 0.05}, turn(heading, Eigen::Vector3d::UnitZ())};
    const Pose lift{{0, 0, 0.05}, Eigen::Quaterniond::Identity()};
    const std::unique_ptr<World> moved = reduced_world(chain(4), flat_ground(0.5, 0.02));
    const std::unique_ptr<World> lifted = reduced_world(chain(4), flat_ground(0.5, 0.02));
    for (int i = 0; i < 600; ++i) {
      if (i == 300) {  // it falls, lands, and crawls
        moved->move_robot(motion);
        lifted->move_robot(lift);
      }
      wriggle(*moved, 3, i);
      wriggle(*lifted, 3, i);
    }
    EXPECT_GT(moved->contact_count(), 0U);
    const Pose between = motion * lift.inverse();
    for (std::size_t link = 0; link < 4; ++link) {
      expect_near(moved->link_pose(link), between * lifted->link_pose(link), 1e-5, 1e-5,
                  "heading " + std::to_string(heading) + ", link " + std::to_string(link));
    }
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
