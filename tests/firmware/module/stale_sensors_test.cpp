// Sensors that give no new readings: over-current would not be noticed.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::PowerState;
using test::node;

class StaleSensors : public testing::Test {
 protected:
  StaleSensors() {
    robot.set_up_and_start();
    robot.enable(0);
    robot.run(9);
  }
  void stall() { robot.it().meters.readings.are_new = false; }
  void work() { robot.it().meters.readings.are_new = true; }

  test::TestModule robot;
};

TEST_F(StaleSensors, AreAFaultAtTheFifthReadingAndNotSooner) {
  stall();
  robot.run(10, 13);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_TRUE(robot.emergencies().empty());
  robot.run(14, 14);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  // CiA 402: 5210, measurement circuit. Error register: generic, device profile.
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::sensors_failed, 0x21, 0}}));
}

TEST_F(StaleSensors, ForAShorterTimeAreNone) {
  for (std::uint32_t tick = 10; tick < 60; tick += 5) {
    stall();
    robot.run(tick, tick + 3);
    work();
    robot.run(tick + 4, tick + 4);
  }
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(StaleSensors, KeepTheFaultUntilTheyMeasureAndAHostClearsIt) {
  stall();
  robot.run(10, 14);
  ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0080), AbortCode::none);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  work();
  robot.run(15, 16);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_EQ(robot.emergencies().size(), 2U);
  EXPECT_EQ(robot.emergencies().back(), (Emergency{node, EmergencyCode::none, 0, 0x5210}));
  ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0000), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0080), AbortCode::none);
  robot.enable(0);
}

TEST_F(StaleSensors, DoNotAddToTheTimeOfAnOverCurrent) {
  robot.it().meters.readings.current_ma = 5'000;
  robot.run(10, 57);
  stall();
  robot.run(58, 61);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled) << "48 readings above the limit";
}

}  // namespace
}  // namespace proleg
