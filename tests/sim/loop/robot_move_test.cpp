#include "sim/scenario/robot_move.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

Scenario moved(const std::string& word, const std::string& name = "travelling_wave/uniform") {
  Scenario scenario = shipped(name);
  add_move(scenario, word);
  return scenario;
}

void advance_to(Simulation& simulation, std::uint32_t tick) {
  while (simulation.tick() < tick) {
    simulation.advance();
  }
}

double heading_of(const Pose& pose) {
  const Eigen::Vector3d forward = pose.orientation * Eigen::Vector3d::UnitY();
  return std::atan2(forward.y(), forward.x()) * 180.0 / std::numbers::pi;
}

TEST(RobotMove, IsARigidMotionOfTheWholeRobot) {
  const Scenario scenario = moved("0.5,-1,0.2,30@100");
  const Scenario unmoved = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  Simulation other(unmoved);
  advance_to(simulation, 100);
  advance_to(other, 100);
  simulation.apply_moves();
  const auto before = other.plant().link_poses();
  const auto after = simulation.plant().link_poses();
  EXPECT_LT((after[0].position - Eigen::Vector3d(0.5, -1.0, 0.2)).norm(), 1e-9);
  EXPECT_NEAR(heading_of(after[0]) - heading_of(before[0]), 30.0, 1e-6);
  for (std::size_t link = 1; link < before.size(); ++link) {
    const Pose relative_before = before[0].inverse() * before[link];
    const Pose relative_after = after[0].inverse() * after[link];
    EXPECT_LT((relative_after.position - relative_before.position).norm(), 1e-9);
    EXPECT_LT(relative_after.orientation.angularDistance(relative_before.orientation), 1e-7);
  }
  EXPECT_TRUE(simulation.plant().world().is_slower_than(1e-12, 1e-12));
}

TEST(RobotMove, TakesEffectAtItsTickAndNotBefore) {
  const Scenario scenario = moved("0.5,-1,0.05,30@100");
  const Scenario unmoved = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  Simulation other(unmoved);
  advance_to(simulation, 100);
  advance_to(other, 100);
  EXPECT_EQ(simulation.plant().link_poses()[0].position, other.plant().link_poses()[0].position);
  simulation.advance();
  EXPECT_NEAR(simulation.plant().link_poses()[0].position.x(), 0.5, 0.02);
}

TEST(RobotMove, DoesNotCountAsCrawling) {
  const Scenario scenario = moved("3,-2,0.03,140@500");
  const Scenario unmoved = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  Simulation other(unmoved);
  advance_to(simulation, 1000);
  advance_to(other, 1000);
  // The same gait on the same flat ground.
  EXPECT_NEAR(simulation.plant().displacement(), other.plant().displacement(), 0.05 * other.plant().displacement());
}

TEST(RobotMove, PutsARobotInTheGroundOnTopOfIt) {
  for (const char* name : {"travelling_wave/uniform", "obstacle/plain"}) {
    const Scenario scenario = moved("0.1,0.3,-0.2,0@50", name);
    Simulation simulation(scenario);
    advance_to(simulation, 50);
    simulation.apply_moves();
    for (const Pose& pose : simulation.plant().link_poses()) {
      EXPECT_GT(pose.position.z(), 0.0);
    }
    EXPECT_NO_THROW(advance_to(simulation, 300));
  }
}

TEST(RobotMove, ToWhereTheRobotCannotBeIsRefused) {
  for (const char* word : {"1000,0,0,0@0", "0,0,50,0@0", "0,0,-5,0@0"}) {
    const Scenario scenario = moved(word);
    Simulation simulation(scenario);
    EXPECT_THROW(simulation.apply_moves(), InputError) << word;
    EXPECT_FALSE(simulation.was_moved());
  }
}

TEST(RobotMove, IsReadAsItIsWritten) {
  Scenario scenario = shipped("travelling_wave/uniform");
  for (const char* word : {"0.1,0.2,0.05,30@120", "-1e-3,2,3,-360@0", "0,0,0,0@1.5s", "7,8,9,10@120"}) {
    add_move(scenario, word);
  }
  ASSERT_EQ(scenario.moves.size(), 4U);
  EXPECT_EQ(move_text(scenario.moves[0]), "-0.001,2,3,-360@0");
  EXPECT_EQ(move_text(scenario.moves[1]), "0.1,0.2,0.05,30@120");
  EXPECT_EQ(move_text(scenario.moves[2]), "7,8,9,10@120");
  EXPECT_EQ(move_text(scenario.moves[3]), "0,0,0,0@150");
}

TEST(RobotMove, ABadWordIsRefusedAndChangesNothing) {
  Scenario scenario = shipped("travelling_wave/uniform");
  for (const char* word : {"", "1,2,3,4", "1,2,3@5", "1,2,3,4,5@6", "1,2,3,nan@5", "inf,0,0,0@5", "1,2,3,400@5",
                           "20000,0,0,0@5", "1,2,3,4@", "1,2,3,4@-1", "1,2,3,4@5@6", "1,,3,4@5", " 1,2,3,4@5"}) {
    EXPECT_THROW(add_move(scenario, word), InputError) << word;
  }
  EXPECT_TRUE(scenario.moves.empty());
}

}  // namespace
}  // namespace proleg::sim
