#include "host/robot/node_plan.hpp"

#include <gtest/gtest.h>

#include <array>

namespace proleg::host {
namespace {

canopen::LssAddress address_of(std::uint32_t serial) { return {1, 2, 3, serial}; }

std::vector<std::pair<std::uint32_t, unsigned>> planned(const std::vector<PlacedModule>& modules,
                                                        const std::vector<std::uint8_t>& nodes) {
  std::vector<std::pair<std::uint32_t, unsigned>> list;
  for (const canopen::RenumberedModule& module : plan_node_ids(modules, nodes)) {
    list.emplace_back(module.address.back(), module.node);
  }
  return list;
}
using Plan = std::vector<std::pair<std::uint32_t, unsigned>>;

TEST(NodePlan, ModulesInTheirPlacesKeepTheirNodeIds) {
  EXPECT_EQ(planned({{5, address_of(50), 0}, {7, address_of(70), 1}}, {5, 7}), Plan{});
}

TEST(NodePlan, ModulesTakeEachOthersNodeIds) {
  EXPECT_EQ(planned({{1, address_of(10), 1}, {2, address_of(20), 0}, {3, address_of(30), 2}}, {1, 2, 3}),
            (Plan{{10, 2}, {20, 1}}));
}

TEST(NodePlan, AModuleWithoutAJointMakesRoom) {
  // Node 1 is in the way; 2 is kept for a joint whose module is not on the bus.
  EXPECT_EQ(planned({{1, address_of(10), std::nullopt}, {3, address_of(30), 0}}, {1, 2}), (Plan{{10, 4}, {30, 1}}));
}

TEST(NodePlan, AModuleWithoutAJointThatIsNotInTheWayKeepsItsNodeId) {
  EXPECT_EQ(planned({{9, address_of(90), std::nullopt}, {1, address_of(10), 0}}, {1}), Plan{});
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
