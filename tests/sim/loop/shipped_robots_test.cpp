// The robots of sim/scenarios/robots, each with its gait: they move.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

Scenario shipped_robot(const std::string& file, double seconds) {
  DiskFiles files;
  Scenario scenario = read_scenario(source_path("/sim/scenarios/robots/" + file), files);
  EXPECT_TRUE(scenario.warnings.empty()) << file << ": " << scenario.warnings.front();
  scenario.duration_s = seconds;
  return scenario;
}

/// m, of a run.
double displacement(const Scenario& scenario) {
  Simulation simulation(scenario);
  for (std::uint32_t tick = 0; tick < tick_count(scenario); ++tick) {
    simulation.advance();
  }
  return simulation.plant().displacement();
}

TEST(ShippedRobots, EachKindMoves) {
  for (const char* kind : {"cubo", "cube_chain", "y1", "snake"}) {
    constexpr double seconds = 10.0;
    EXPECT_GT(displacement(shipped_robot(std::string(kind) + "/robot.simulation.xml", seconds)), 0.3) << kind;
  }
}

TEST(ShippedRobots, TwentyLinksWithMeshesCrossAWorldOfMeshesAndPushItsObjects) {
  const Scenario scenario = shipped_robot("mesh_world/mesh_world.simulation.xml", 10.0);
  ASSERT_EQ(scenario.robot.links.size(), 20U);
  for (const Link& link : scenario.robot.links) {
    EXPECT_EQ(link.geometries.at(0).shape, Shape::hull) << link.name;
  }
  Simulation simulation(scenario);
  for (std::uint32_t tick = 0; tick < tick_count(scenario); ++tick) {
    simulation.advance();
  }
  EXPECT_GT(simulation.plant().displacement(), 0.5);
  const TickSample sample = simulation.sample();
  ASSERT_EQ(sample.object_poses.size(), 2U);
  const std::vector<MovingObject>& objects = scenario.environment.moving_objects;
  double way = 0.0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    way = std::max(way, (sample.object_poses[i].position - objects[i].pose.position).head<2>().norm());
  }
  EXPECT_GT(way, 0.02) << "the robot, or the slope, moved one of them";
}

}  // namespace
}  // namespace proleg::sim
