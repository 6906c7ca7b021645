// A chip that is too hot: its program and its measurements cannot be trusted for long.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::PowerState;
using test::node;

class OverTemperature : public testing::Test {
 protected:
  OverTemperature() {
    robot.set_up_and_start();
    robot.enable(0);
    robot.run(9);
  }
  void heat(std::int8_t temperature_c) { robot.it().meters.readings.temperature_c = temperature_c; }

  test::TestModule robot;
};

TEST_F(OverTemperature, IsAFaultAtTheNextReading) {
  heat(94);
  robot.run(10, 20);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  heat(95);
  robot.run(21, 22);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  // CiA 301: 4210, device temperature. Error register: generic, temperature.
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::over_temperature, 0x09, 0}}));
}

TEST_F(OverTemperature, LastsUntilTheChipIsTenDegreesCoolerAndTheHostClearsTheFault) {
  heat(120);
  robot.run(10, 11);
  for (const std::int8_t temperature : {std::int8_t{94}, std::int8_t{85}}) {
    heat(temperature);
    robot.run(robot.kernel().tick(), robot.kernel().tick() + 2);
    ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0080), AbortCode::none);
    EXPECT_EQ(robot.module().power(), PowerState::fault);
    ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0000), AbortCode::none);
  }
  heat(84);
  robot.run(robot.kernel().tick(), robot.kernel().tick() + 2);
  EXPECT_EQ(robot.emergencies().back(), (Emergency{node, EmergencyCode::none, 0, 0x4210}));
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  ASSERT_EQ(robot.bus.write(node, object::controlword, 0x0080), AbortCode::none);
  robot.enable(0);
}

}  // namespace
}  // namespace proleg
