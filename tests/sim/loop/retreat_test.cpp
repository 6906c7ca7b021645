// The wall of sim/scenarios/retreat.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "shared/gait/declaration.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {
namespace {

/// Place of the head along the way, m, after each tick, and whether the wave ran backwards then.
struct Way {
  std::vector<double> head;
  std::vector<bool> retreats;
};

Way crawl(const Scenario& scenario, double seconds) {
  Simulation simulation(scenario);
  Way way;
  const int number = find_internal_value(scenario.kernel.slots[0].algorithm->declaration(), "retreat_ticks");
  while (simulation.time_s() < seconds - 1e-9) {
    simulation.advance();
    way.head.push_back(simulation.plant().link_poses()[0].position.y());
    way.retreats.push_back(simulation.chain().kernel(0).internal_value(0, 0, static_cast<unsigned>(number)) > 0);
  }
  return way;
}

TEST(Retreat, TheRobotTurnsBackAtTheWallAndTriesAgain) {
  const Way way = crawl(shipped("retreat/wall"), 30);
  const auto first = std::ranges::find(way.retreats, true);
  ASSERT_NE(first, way.retreats.end()) << "it never touched the wall";
  const auto touch = static_cast<std::size_t>(first - way.retreats.begin());
  EXPECT_GT(touch, 200U) << "the floor does not press the bumper";
  const double at_wall = way.head[touch];
  EXPECT_GT(at_wall - way.head.front(), 0.25) << "the wall is 0.39 m before the bumper";
  const auto end = std::find(first, way.retreats.end(), false);
  ASSERT_NE(end, way.retreats.end()) << "the retreat ends";
  const auto back = static_cast<std::size_t>(end - way.retreats.begin());
  EXPECT_GE(back - touch, 400U);
  EXPECT_LT(way.head[back], at_wall - 0.1) << "it crawled back";
  EXPECT_GT(*std::max_element(way.head.begin() + static_cast<std::ptrdiff_t>(back), way.head.end()),
            way.head[back] + 0.1)
      << "and comes again";
}

TEST(Retreat, WithoutTheStimulusTheRobotStaysAtTheWall) {
  Scenario scenario = shipped("retreat/wall");
  const auto& declaration = scenario.kernel.slots[0].algorithm->declaration();
  for (Setting& setting : scenario.settings) {
    if (setting.number == find_parameter(declaration, "retreat")) {
      setting.value = 0;
    }
  }
  const Way way = crawl(scenario, 25);
  EXPECT_EQ(std::ranges::count(way.retreats, true), 0);
  EXPECT_LT(*std::ranges::max_element(way.head) - way.head.front(), 0.45);
  EXPECT_GT(way.head.back(), *std::ranges::max_element(way.head) - 0.1);
}

}  // namespace
}  // namespace proleg::sim
