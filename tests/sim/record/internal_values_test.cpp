#include "sim/record/recorded_run.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "shared/gait/registry.hpp"

namespace proleg::sim {
namespace {

using ValueIndex = std::array<unsigned, 3>;  // slot, joint, number

TEST(InternalValues, AreOrderedBySlotThenJointThenNumber) {
  KernelConfiguration configuration;
  configuration.joint_count = 3;
  configuration.slots[1] = {find_algorithm("PatternGenerator_coupled_oscillator"), JointMask(0b101)};
  configuration.slots[2] = {find_algorithm("PatternGenerator_sinusoidal"), JointMask(0b010)};
  ASSERT_NE(configuration.slots[1].algorithm, nullptr);
  ASSERT_NE(configuration.slots[2].algorithm, nullptr);
  const auto count = [&](unsigned slot) {
    return configuration.slots[slot].algorithm->declaration().internal_values.size();
  };
  std::vector<ValueIndex> expected;
  for (const auto& [slot, joint] : {std::pair{1U, 0U}, {1U, 2U}, {2U, 1U}}) {
    for (unsigned number = 0; number < count(slot); ++number) {
      expected.push_back({slot, joint, number});
    }
  }
  std::vector<ValueIndex> found;
  for_each_internal_value(configuration, [&](unsigned slot, unsigned joint, unsigned number) {
    found.push_back({slot, joint, number});
  });
  EXPECT_EQ(found, expected);
  EXPECT_GT(count(1), 1U);
}

}  // namespace
}  // namespace proleg::sim
