// A supply voltage that is too low takes the power from the servo.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::PowerState;
using test::node;

class Supply : public testing::Test {
 protected:
  Supply() {
    robot.set_up_and_start();
    robot.enable(0);
    robot.run(9);
    EXPECT_TRUE(robot.it().is_pulsing());
  }
  void command(std::uint16_t controlword) {
    ASSERT_EQ(robot.bus.write(node, object::controlword, controlword), AbortCode::none);
  }
  void drop() { robot.it().supply_low(robot.bus.now()); }
  void recover() { robot.it().supply_good(robot.bus.now()); }

  test::TestModule robot;
};

TEST_F(Supply, ThatIsTooLowStopsThePulsesAtOnceAndIsReported) {
  drop();
  EXPECT_FALSE(robot.it().is_pulsing());
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  robot.bus.run_for(1'000);
  // CiA 402: 3220. Error register: generic, voltage (CiA 301, 7.5.2.2).
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0}}));
  drop();
  robot.run(10, 20);
  EXPECT_EQ(robot.emergencies().size(), 1U) << "reported once";
  EXPECT_EQ(robot.kernel().tick(), 21U) << "the gait is computed";
}

TEST_F(Supply, ThatIsTooLowKeepsTheFaultWhateverTheHostCommands) {
  drop();
  for (const std::uint16_t controlword : std::array<std::uint16_t, 4>{0x0080, 0x0006, 0x0007, 0x000F}) {
    command(controlword);
    EXPECT_EQ(robot.module().power(), PowerState::fault);
  }
  robot.run(10, 20);
  EXPECT_FALSE(robot.it().is_pulsing());
}

TEST_F(Supply, ThatIsGoodAgainIsReportedAndPulsesNeedADecision) {
  drop();
  robot.run(10, 12);
  recover();
  robot.run(13, 20);
  EXPECT_EQ(robot.emergencies(), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0},
                                              Emergency{node, EmergencyCode::none, 0, 0x3220}}));
  EXPECT_EQ(robot.module().power(), PowerState::fault);
  EXPECT_FALSE(robot.it().is_pulsing());
  command(0x0080);
  robot.enable(0);
  robot.run(21, 22);
  EXPECT_TRUE(robot.it().is_pulsing());
}

TEST_F(Supply, ThatIsTooLowDuringAResetOfTheNodeIsReportedAfterTheBootUpMessage) {
  drop();
  robot.bus.run_for(1'000);
  const std::size_t before = robot.bus.log.size();
  robot.command(canopen::NmtCommand::reset_node);
  robot.bus.run_for(50'000);
  EXPECT_EQ(robot.emergencies(before), (std::vector{Emergency{node, EmergencyCode::supply_low, 0x05, 0}}));
  const auto boot_up = robot.bus.sent(canopen::identifier::heartbeat + node, before);
  const auto emergency = robot.bus.sent(canopen::identifier::emergency + node, before);
  ASSERT_EQ(boot_up.size(), 1U);
  EXPECT_LT(boot_up[0].time, emergency[0].time);
  EXPECT_EQ(robot.module().power(), PowerState::fault);
}

TEST(SupplyAtTheStart, ThatRisesBeforeTheBootUpMessageIsNoFault) {
  test::TestModule robot;
  robot.it().power_on(0);
  robot.it().supply_low(10);
  robot.it().supply_good(20);
  robot.bus.run_for(50'000);
  EXPECT_EQ(robot.bus.sent(canopen::identifier::heartbeat + node).size(), 1U);
  EXPECT_TRUE(robot.emergencies().empty());
  EXPECT_EQ(robot.module().power(), PowerState::switch_on_disabled);
}

}  // namespace
}  // namespace proleg
