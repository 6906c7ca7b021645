// The worst case of the bus, from the bits of frames as ISO 11898-1 counts them.

#include "shared/canopen/robot_configuration.hpp"

#include <gtest/gtest.h>

#include "robot.hpp"

namespace proleg::canopen {
namespace {

/// Number of bits of a frame with `bytes` of data and the most stuff bits, with its interframe space. The 34 bits and
/// the data from start of frame to the end of the CRC sequence can be stuffed: at worst a stuff bit follows every
/// fourth of them but the first. The other 13 bits are not stuffed: CRC delimiter, acknowledgement, end of frame and
/// interframe space.
constexpr unsigned worst_bits(unsigned bytes) { return 34 + 8 * bytes + (34 + 8 * bytes - 1) / 4 + 13; }

KernelConfiguration robot(unsigned joints, std::uint32_t tick_us = 10'000) {
  return test::one_slot(test::algorithm(test::coupled), joints, tick_us);
}

TEST(BusLoad, CountsEveryFrameOfATickAtItsLongest) {
  for (unsigned joints = 1; joints <= 64; ++joints) {
    for (const std::uint32_t tick_us : {1'000U, 4'000U, 10'000U}) {
      for (const unsigned period : {10U, 100U}) {
        const double bits = joints * worst_bits(8) + worst_bits(1) + worst_bits(8) / 10.0 +
                            static_cast<double>(joints * worst_bits(6)) / period;
        const double permille = bits * 1000 / tick_us;
        const std::uint32_t load = worst_bus_load_permille(robot(joints, tick_us), period);
        EXPECT_GE(load, permille);
        EXPECT_LT(load, permille + 2'001.0 / tick_us + 1) << "rounded up";
      }
    }
  }
}

TEST(BusLoad, MonitoringGivesWayOnlyWhereTheRobotHasNoRoomForIt) {
  EXPECT_EQ(monitoring_period(robot(5)), 10U);
  EXPECT_EQ(monitoring_period(robot(57)), 10U);
  EXPECT_EQ(worst_bus_load_permille(robot(57), 10), 843U);
  EXPECT_EQ(monitoring_period(robot(58)), 100U);
  EXPECT_EQ(worst_bus_load_permille(robot(60)), 825U);
  EXPECT_LE(worst_bus_load_permille(robot(61)), max_bus_load_permille);
  EXPECT_GT(worst_bus_load_permille(robot(62)), max_bus_load_permille) << "refused: docs/protocol.md";
}

TEST(BusLoad, SecondFramesCount) {
  KernelConfiguration configuration = robot(5);
  configuration.slots[1] = {&test::algorithm(test::extended), JointMask(0b10110)};
  EXPECT_EQ(worst_bus_load_permille(configuration), worst_bus_load_permille(robot(5)) + 3 * worst_bits(8) / 10);
}

}  // namespace
}  // namespace proleg::canopen
