#include "shared/canopen/robot_configuration.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

#include "robot.hpp"

namespace proleg::canopen {
namespace {

/// A robot with the memory for its span.
struct Robot {
  [[nodiscard]] std::uint32_t crc() {
    configuration.kernel.joint_count = static_cast<std::uint8_t>(nodes.size());
    configuration.nodes = nodes;
    return configuration_crc(configuration);
  }

  std::vector<std::uint8_t> nodes;
  RobotConfiguration configuration{};
};

TEST(ConfigurationCrc, CoversTheDocumentedBytes) {
  Robot robot{{3, 7, 1, 126, 12}};
  robot.configuration.kernel.seed = 0x0123456789ABCDEF;
  robot.configuration.robot_id = 7;
  robot.configuration.kernel.slots[0] = {&test::algorithm(test::coupled), JointMask(0x1F)};
  robot.configuration.kernel.slots[1] = {&test::algorithm(test::sinusoidal), JointMask(0b00110)};
  robot.configuration.kernel.slots[2] = {nullptr, JointMask(0b1)};
  // zlib's crc32 of the 60 bytes that Python's struct.pack makes of these numbers: "<BIIQH", four times "<BQ", nodes.
  EXPECT_EQ(robot.crc(), 0xBED05E06U);
}

TEST(ConfigurationCrc, ChangesWithEverythingThatModulesMustAgreeOn) {
  Robot robot{{13, 12, 11}};
  robot.configuration.kernel.slots[0] = {&test::algorithm(test::coupled), JointMask(0b111)};
  const std::uint32_t crc = robot.crc();
  std::set<std::uint32_t> crcs{crc};
  const auto expect_other = [&](const std::function<void(Robot&)>& change) {
    Robot other = robot;
    change(other);
    EXPECT_TRUE(crcs.insert(other.crc()).second);
  };
  expect_other([](Robot& r) { r.configuration.kernel.tick_period_us = 10'001; });
  expect_other([](Robot& r) { r.configuration.servo_period_us = 3'000; });
  expect_other([](Robot& r) { r.configuration.kernel.seed = 2; });
  expect_other([](Robot& r) { r.configuration.kernel.seed = 1ULL << 32U; });
  expect_other([](Robot& r) { r.configuration.robot_id = 2; });
  expect_other([](Robot& r) { r.configuration.kernel.slots[0].group = JointMask(0b011); });
  expect_other([](Robot& r) { r.configuration.kernel.slots[0].algorithm = &test::algorithm(test::extended); });
  expect_other([](Robot& r) { std::swap(r.configuration.kernel.slots[0], r.configuration.kernel.slots[3]); });
  expect_other([](Robot& r) { std::swap(r.nodes[0], r.nodes[2]); });
  Robot same = robot;
  same.configuration.kernel.slots[1].group = JointMask(0b1);  // an empty slot has no group
  EXPECT_EQ(same.crc(), crc);
}

}  // namespace
}  // namespace proleg::canopen
