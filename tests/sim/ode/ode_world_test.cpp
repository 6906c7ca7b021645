#include "sim/ode/ode_world.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <ode/error.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "sim/ode/engine.hpp"
#include "sim/physics/physics_error.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim {
namespace {

std::unique_ptr<World> iterative_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::iterative);
}

constexpr std::size_t crawling_links = 13;

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

/// The positions of all links after some steps of a chain that falls and crawls, bit by bit.
std::vector<double> positions_after_steps(World& world, int steps) {
  std::vector<double> numbers;
  for (int i = 0; i < steps; ++i) {
    for (std::size_t joint = 0; joint < crawling_links - 1; ++joint) {
      world.set_joint_speed(joint, std::sin(0.03 * i + static_cast<double>(joint)));
    }
    world.step();
  }
  for (std::size_t link = 0; link < crawling_links; ++link) {
    const Pose pose = world.link_pose(link);
    numbers.insert(numbers.end(), {pose.position.x(), pose.position.y(), pose.position.z()});
  }
  return numbers;
}

std::unique_ptr<World> crawling_world() { return iterative_world(chain(crawling_links), flat_ground(0.5, 0.026)); }

TEST(OdeWorld, TheIterativeStepperRepeatsBesideAWorldThatIsSteppedInTurns) {
  const std::vector<double> alone = positions_after_steps(*crawling_world(), 300);
  const std::unique_ptr<World> first = crawling_world();
  const std::unique_ptr<World> second = crawling_world();
  positions_after_steps(*first, 7);
  positions_after_steps(*second, 100);
  const std::unique_ptr<World> third = crawling_world();  // made while others run
  EXPECT_EQ(positions_after_steps(*third, 300), alone);
  const std::vector<double> rest_alone = [] {
    const std::unique_ptr<World> world = crawling_world();
    positions_after_steps(*world, 7);
    return positions_after_steps(*world, 300);
  }();
  EXPECT_EQ(positions_after_steps(*first, 300), rest_alone);
  EXPECT_NE(rest_alone, alone) << "another run, so the comparison can fail";
}

TEST(OdeWorld, TheIterativeStepperRepeatsBesideWorldsOfOtherThreads) {
  const std::vector<double> alone = positions_after_steps(*crawling_world(), 1'000);
  std::array<std::vector<double>, 4> beside;
  std::vector<std::thread> threads;
  for (std::vector<double>& numbers : beside) {
    threads.emplace_back([&numbers] { numbers = positions_after_steps(*crawling_world(), 1'000); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const std::vector<double>& numbers : beside) {
    EXPECT_EQ(numbers, alone);
  }
}

TEST(OdeWorld, CountsTheMessagesOfItsOwnStepsOnly) {
  const std::unique_ptr<World> world = crawling_world();
  dMessage(0, "LCP internal error, s <= 0 (s=%g)", 0.5);  // as the step of another world on this thread gives it
  positions_after_steps(*world, 1);
  EXPECT_EQ(world->solver_messages(), 0U);
  std::thread([&world] {
    prepare_engine_for_this_thread();
    positions_after_steps(*world, 1);
    EXPECT_EQ(world->solver_messages(), 0U) << "made on a thread that had messages";
  }).join();
}

/// A child of fork() has the threads of its parent no more, whatever they were in the middle of.
TEST(OdeWorld, TheIterativeStepperWorksInAChildThatWasForkedDuringAStep) {
  std::atomic<bool> stops = false;
  std::thread beside([&stops] {
    const std::unique_ptr<World> world = crawling_world();
    while (!stops) {
      positions_after_steps(*world, 1);
    }
  });
  const std::vector<double> alone = positions_after_steps(*crawling_world(), 20);
  for (int i = 0; i < 20; ++i) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      alarm(600);  // the test ends if the child waits for ever
      _exit(positions_after_steps(*crawling_world(), 20) == alone ? 0 : 1);
    }
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  stops = true;
  beside.join();
}

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

TEST(StepBudget, PaysForManyContactPointsForAMomentAndForFewWithoutEnd) {
  StepBudget budget;
  for (int step = 0; step < 100'000; ++step) {
    ASSERT_TRUE(budget.take(static_cast<std::size_t>(StepBudget::lasting_points))) << step;
  }
  int direct_steps = 0;
  while (direct_steps < 1'000 && budget.take(128)) {
    ++direct_steps;
  }
  EXPECT_GE(direct_steps, 1) << "a robot on 32 feet that is put on the floor";
  EXPECT_LE(direct_steps, 20) << "less than a fiftieth of a second";
  int until_direct = 0;
  while (until_direct < 10'000 && !budget.take(20)) {
    ++until_direct;
  }
  EXPECT_LE(until_direct, 500) << "as soon as contact points are few";
}

/// Links on eight feet, each with four contact points on a floor.
RobotModel on_many_feet(std::size_t links) {
  RobotModel robot = chain(links);
  for (Link& link : robot.links) {
    Geometry foot = link.geometries.front();
    foot.extents = {0.004, 0.004, 0.02};
    link.geometries.clear();
    for (int i = 0; i < 8; ++i) {
      foot.pose.position = {i % 2 == 0 ? -0.015 : 0.015, -0.03 + 0.02 * (i / 2), 0.0};
      link.geometries.push_back(foot);
    }
  }
  return robot;
}

TEST(OdeWorld, OfFewLinksTakesTheIterativeStepperOnlyWhileContactPointsAreMany) {
  const auto after = [](const RobotModel& robot, int steps) {
    std::unique_ptr<World> world = make_ode_world(robot, flat_ground(0.5, 0.026), step_s, Stepper::automatic);
    for (int i = 0; i < steps; ++i) {
      world->step();
    }
    return world;
  };
  const std::unique_ptr<World> few = after(chain(4), 1'000);
  EXPECT_GT(few->contact_count(), 0U);
  EXPECT_EQ(relieved_steps(*few), 0U);
  const std::unique_ptr<World> many = after(on_many_feet(4), 1'000);
  EXPECT_GT(relieved_steps(*many), 500U);
  EXPECT_LT(relieved_steps(*many), 1'000U) << "it falls onto the floor in direct steps";
  const std::unique_ptr<World> exact =
      make_ode_world(on_many_feet(4), flat_ground(0.5, 0.026), step_s, Stepper::direct);
  for (int i = 0; i < 100; ++i) {
    exact->step();
  }
  EXPECT_GT(exact->contact_count(), 100U);
  EXPECT_EQ(relieved_steps(*exact), 0U) << "who names a stepper gets it";
  EXPECT_NEAR(many->center_of_mass().z(), exact->center_of_mass().z(), 1e-4) << "it rests at the same height";
}

}  // namespace
}  // namespace proleg::sim
