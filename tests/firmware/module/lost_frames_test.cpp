// Received frames that were lost because there was no room.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::Emergency;
using canopen::EmergencyCode;
using test::node;

class LostFrames : public testing::Test {
 protected:
  LostFrames() { robot.boot(); }
  void lose(std::uint32_t count) {
    robot.it().frames_lost(robot.bus.now(), count);
    robot.bus.run_for(1'000);
  }
  test::TestModule robot;
};

TEST_F(LostFrames, AreReportedWithTheirNumberAndCanBeRead) {
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x200B, 1}), 0U);
  lose(3);
  // CiA 301, table 26: 8110, CAN overrun (objects lost).
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, static_cast<EmergencyCode>(0x8110), 0, 3}}));
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x200B, 1}), 3U);
}

TEST_F(LostFrames, AreReportedOnceASecondAtMost) {
  lose(1);
  lose(2);
  constexpr Microseconds second = 1'000'000;
  robot.bus.run_for(second);
  lose(300);
  ASSERT_EQ(robot.emergencies().size(), 2U);
  EXPECT_EQ(robot.emergencies()[1].detail, 300U);
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x200B, 1}), 300U);
}

TEST_F(LostFrames, BeforeTheBootUpMessageAreCountedOnly) {
  test::TestModule other;
  other.it().power_on(0);
  other.it().frames_lost(10, 5);
  other.bus.run_for(50'000);
  EXPECT_TRUE(other.emergencies().empty());
  EXPECT_EQ(other.bus.value(node, canopen::Address{0x200B, 1}), 5U);
}

}  // namespace
}  // namespace proleg
