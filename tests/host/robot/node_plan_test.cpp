#include "host/robot/node_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

namespace proleg::host {
namespace {

canopen::LssAddress address_of(std::uint32_t serial) { return {1, 2, 3, serial}; }

using Plan = std::vector<std::pair<std::uint32_t, unsigned>>;

Plan planned(const std::vector<PlacedModule>& modules, const std::vector<std::uint8_t>& nodes,
             const std::vector<std::uint8_t>& others = {}) {
  Plan list;
  const auto steps = plan_node_ids(modules, nodes, others);
  EXPECT_TRUE(steps.has_value());
  for (const canopen::RenumberedModule& module : steps.value_or(std::vector<canopen::RenumberedModule>{})) {
    list.emplace_back(module.address.back(), module.node);
  }
  return list;
}

TEST(NodePlan, ModulesInTheirPlacesKeepTheirNodeIds) {
  EXPECT_EQ(planned({{5, address_of(50), 0}, {7, address_of(70), 1}}, {5, 7}), Plan{});
}

TEST(NodePlan, ModulesThatExchangeTheirNodeIdsNeedAThirdOne) {
  EXPECT_EQ(planned({{1, address_of(10), 1}, {2, address_of(20), 0}, {3, address_of(30), 2}}, {1, 2, 3}, {4}),
            (Plan{{10, 5}, {20, 1}, {10, 2}}));
}

TEST(NodePlan, AChainOfModulesBeginsAtItsFreeEnd) {
  EXPECT_EQ(planned({{1, address_of(10), 0}, {2, address_of(20), 1}}, {2, 3}), (Plan{{20, 3}, {10, 2}}));
}

TEST(NodePlan, AModuleWithoutAJointMakesRoom) {
  // Node 1 is in the way; 2 is kept for a joint whose module is not on the bus, 4 is another node.
  EXPECT_EQ(planned({{1, address_of(10), std::nullopt}, {3, address_of(30), 0}}, {1, 2}, {4}),
            (Plan{{10, 5}, {30, 1}}));
}

TEST(NodePlan, AModuleWithoutAJointThatIsNotInTheWayKeepsItsNodeId) {
  EXPECT_EQ(planned({{9, address_of(90), std::nullopt}, {1, address_of(10), 0}}, {1}), Plan{});
}

TEST(NodePlan, TwoModulesOfOneJointAreRefused) {
  const std::vector<PlacedModule> modules{{1, address_of(10), 0}, {2, address_of(20), 0}};
  EXPECT_FALSE(plan_node_ids(modules, std::vector<std::uint8_t>{1, 2}, {}).has_value());
}

TEST(NodePlan, NoNodeIdIsStoredTwiceWhereverItEnds) {
  constexpr unsigned seed = 305;
  constexpr unsigned runs = 2'000;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::vector<std::uint8_t> all(126);
  std::iota(all.begin(), all.end(), std::uint8_t{1});
  for (unsigned run = 0; run < runs; ++run) {
    const std::size_t joints = 1 + random() % 20;
    const std::size_t extra = random() % 4;
    std::shuffle(all.begin(), all.begin() + 30, random);  // so that they meet
    const std::vector<std::uint8_t> nodes(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(joints));
    const std::vector<std::uint8_t> others(all.begin() + 28, all.begin() + 30);
    std::shuffle(all.begin(), all.begin() + 28, random);
    std::vector<PlacedModule> modules;
    std::vector<unsigned> places(joints);
    std::iota(places.begin(), places.end(), 0U);
    std::shuffle(places.begin(), places.end(), random);
    for (std::size_t i = 0; i < joints + extra; ++i) {
      const bool is_placed = i < joints && random() % 8 != 0;
      modules.push_back(
          {all[i], address_of(static_cast<std::uint32_t>(i)), is_placed ? std::optional(places[i]) : std::nullopt});
    }
    const auto steps = plan_node_ids(modules, nodes, others);
    ASSERT_TRUE(steps.has_value());
    std::map<std::uint32_t, unsigned> flash;
    for (const PlacedModule& module : modules) {
      flash[module.address.back()] = module.node;
    }
    for (const canopen::RenumberedModule& step : *steps) {
      flash[step.address.back()] = step.node;
      std::set<unsigned> ids(others.begin(), others.end());
      for (const auto& [serial, node] : flash) {
        ASSERT_TRUE(ids.insert(node).second) << "node id " << node << " twice, run " << run;
      }
    }
    for (const PlacedModule& module : modules) {
      if (module.joint) {
        ASSERT_EQ(flash[module.address.back()], nodes[*module.joint]);
      } else {
        ASSERT_EQ(std::ranges::count(nodes, flash[module.address.back()]), 0);
      }
    }
  }
}

TEST(NodePlan, FreshModulesGetFreeNodeIdsThoseOfTheRobotFirst) {
  const std::array<std::uint8_t, 3> nodes{4, 2, 9};
  const std::array<std::uint32_t, 3> serials{0, 77, 0};
  const std::array<std::uint8_t, 2> taken{4, 1};
  const auto entries = free_node_ids(nodes, serials, taken);
  ASSERT_GE(entries.size(), 4U);
  EXPECT_EQ(entries[0].node, 2);
  EXPECT_EQ(entries[0].serial, 77U);
  EXPECT_EQ(entries[1].node, 9);
  EXPECT_EQ(entries[1].serial, 0U);
  EXPECT_EQ(entries[2].node, 3);
  EXPECT_EQ(entries[3].node, 5);
  EXPECT_EQ(entries.size(), 126U - 2U);
}

}  // namespace
}  // namespace proleg::host
