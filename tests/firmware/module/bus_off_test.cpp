// A module that goes bus-off stops its servo, recovers after pauses that grow, and reports it.

#include "firmware/module/timeouts.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::PowerState;
using test::node;
constexpr Microseconds ms = 1'000;

class BusOff : public testing::Test {
 protected:
  static constexpr Microseconds second = 1'000'000;

  BusOff() { robot.set_up_and_start(); }

  /// Makes the controller bus-off and returns the time.
  Microseconds leave_bus() {
    const Microseconds now = robot.bus.now();
    robot.it().recoveries.clear();
    robot.it().bus_off(now);
    return now;
  }
  void return_to_bus() { robot.it().bus_back(robot.bus.now()); }
  /// Pauses between `start` and the requests to recover [ms].
  [[nodiscard]] std::vector<Microseconds> pauses(Microseconds start) {
    std::vector<Microseconds> found;
    for (const Microseconds time : robot.it().recoveries) {
      EXPECT_EQ((time - start) % ms, 0U);
      found.push_back((time - start) / ms);
      start = time;
    }
    return found;
  }

  test::TestModule robot;
};

TEST_F(BusOff, TheControllerIsAskedAfterPausesThatDoubleUpToASecond) {
  const Microseconds off = leave_bus();
  robot.bus.run_until(off + 10 * ms - 1);
  EXPECT_TRUE(robot.it().recoveries.empty());
  robot.bus.run_until(off + 4 * second);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{10, 20, 40, 80, 160, 320, 640, 1000, 1000}));
  EXPECT_TRUE(robot.module().is_bus_off());
}

TEST_F(BusOff, PausesContinueToGrowIfItGoesBusOffAgainSoon) {
  Microseconds off = leave_bus();
  robot.bus.run_until(off + 12 * ms);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{10}));
  return_to_bus();
  const Microseconds back = robot.bus.now();
  robot.bus.run_until(back + 10 * second - 1);
  EXPECT_EQ(robot.it().recoveries.size(), 1U) << "a controller that is back is not asked";
  off = leave_bus();
  robot.bus.run_until(off + 61 * ms);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{20, 40}));
}

TEST_F(BusOff, TenSecondsOnTheBusMakeThePausesShortAgain) {
  Microseconds off = leave_bus();
  robot.bus.run_until(off + second);
  return_to_bus();
  robot.bus.run_for(10 * second);
  off = leave_bus();
  robot.bus.run_until(off + 31 * ms);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{10, 20}));
}

TEST_F(BusOff, AResetMakesThePausesShortAgain) {
  Microseconds off = leave_bus();
  robot.bus.run_until(off + second);
  robot.it().power_on(robot.bus.now());
  EXPECT_FALSE(robot.module().is_bus_off());
  const std::size_t asked = robot.it().recoveries.size();
  robot.bus.run_for(3 * second);
  EXPECT_EQ(robot.it().recoveries.size(), asked);
  off = leave_bus();
  robot.bus.run_until(off + 11 * ms);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{10}));
}

TEST_F(BusOff, TheServoGoesToTheSafePoseAndStaysThere) {
  robot.enable(0);
  robot.run(20);
  ASSERT_TRUE(robot.it().is_pulsing());
  leave_bus();
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  robot.bus.run_for(2 * second);
  EXPECT_TRUE(robot.it().is_pulsing());
  EXPECT_EQ(robot.it().pulses.back().width, servo_center);
  return_to_bus();
  robot.bus.run_for(second);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active) << "a person decides";
}

TEST_F(BusOff, PendingFramesAreDroppedAndNoneIsHandedOver) {
  robot.bus.write(node, canopen::object::heartbeat_period, 10);
  robot.bus.run_for(15 * ms);
  // The module has more answers than the bus has time for.
  CanFrame request{static_cast<std::uint16_t>(canopen::identifier::sdo_request + node), 8, {0x40, 0x00, 0x10, 0x00}};
  for (int i = 0; i < 10; ++i) {
    robot.it().receive(robot.bus.now(), request);
  }
  ASSERT_EQ(robot.it().pending.size(), 1U) << "the others wait in the queue";
  const std::uint32_t dropped = robot.module().dropped_frames();
  leave_bus();
  robot.bus.run_for(100 * ms);
  EXPECT_TRUE(robot.it().pending.empty());
  EXPECT_GE(robot.module().dropped_frames(), dropped + 9) << "heartbeats";
  const std::size_t before = robot.bus.log.size();
  return_to_bus();
  robot.bus.run_for(8 * ms);
  ASSERT_GT(robot.bus.log.size(), before);
  for (std::size_t i = before; i < robot.bus.log.size(); ++i) {
    const unsigned base = robot.bus.log[i].frame.identifier - unsigned{node};
    EXPECT_TRUE(base == canopen::identifier::emergency || base == canopen::identifier::heartbeat) << "no old answers";
  }
}

TEST_F(BusOff, ItReportsTheTimeOffWhenItIsBackAndTheEndTenSecondsLater) {
  robot.bus.run_for(ms);
  leave_bus();
  robot.bus.run_for(31 * ms);
  EXPECT_TRUE(robot.emergencies().empty());
  return_to_bus();
  robot.bus.run_for(ms);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::bus_off_recovered, 0x11, 31}));
  EXPECT_EQ(static_cast<unsigned>(EmergencyCode::bus_off_recovered), 0x8140U) << "CiA 301, table 26";
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0x11U) << "communication";
  robot.bus.run_for(10 * second);
  ASSERT_EQ(robot.emergencies().size(), 2U);
  EXPECT_EQ(robot.emergencies()[1], (Emergency{node, EmergencyCode::none, 0, 0x8140}));
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0U);
}

TEST_F(BusOff, ASecondBusOffOrAReturnWithoutOneChangesNothing) {
  return_to_bus();
  robot.bus.run_for(ms);
  EXPECT_TRUE(robot.emergencies().empty());
  const Microseconds off = leave_bus();
  robot.bus.run_for(5 * ms);
  robot.it().bus_off(robot.bus.now());
  robot.bus.run_until(off + 31 * ms);
  EXPECT_EQ(pauses(off), (std::vector<Microseconds>{10, 20}));
  return_to_bus();
  return_to_bus();
  robot.bus.run_for(ms);
  EXPECT_EQ(robot.emergencies().size(), 1U);
}

TEST_F(BusOff, TheModuleJoinsAgainAtTheNextTick) {
  robot.run(19);
  leave_bus();
  robot.bus.run_for(200 * ms);
  return_to_bus();
  robot.tick(40);
  robot.run(40, 42);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.kernel().tick(), 43U);
}

TEST(BusOffOfTheProducer, ATickZeroThatWasLostIsSentAgain) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.it().receive(robot.bus.now(), {static_cast<std::uint16_t>(canopen::identifier::sdo_request + node),
                                       8,
                                       {0x23, 0x05, 0x10, 0x00, 0x80, 0x00, 0x00, 0x40}});
  robot.it().poll(robot.bus.now());
  ASSERT_EQ(robot.it().pending.size(), 2U) << "the answer and TICK 0";
  robot.it().bus_off(robot.bus.now());
  robot.bus.run_for(50 * ms);
  EXPECT_TRUE(robot.it().pending.empty());
  const std::size_t before = robot.bus.log.size();
  robot.it().bus_back(robot.bus.now());
  robot.bus.run_for(100 * ms);
  const auto ticks = robot.bus.sent(canopen::identifier::tick, before);
  const auto syncs = robot.bus.sent(canopen::identifier::sync, before);
  ASSERT_FALSE(ticks.empty());
  EXPECT_EQ(canopen::decode_tick(ticks[0].frame)->tick, 0U);
  ASSERT_GE(syncs.size(), 9U);
  EXPECT_EQ(syncs[0].frame, canopen::encode_sync(0));
  EXPECT_GT(syncs[0].time, ticks[0].time);
}

TEST(BusOffOfTheProducer, TheRobotContinuesAtTheTicksThatItCounted) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.produce_sync();
  robot.run_syncs(15);
  const Microseconds sync = robot.bus.sent(canopen::identifier::sync).back().time;
  const std::uint32_t tick = robot.kernel().tick() - 1;
  robot.it().bus_off(robot.bus.now());
  robot.bus.run_for(125 * ms);
  robot.it().bus_back(robot.bus.now());
  robot.bus.run_for(200 * ms);
  const Microseconds last = robot.bus.sent(canopen::identifier::sync).back().time;
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.kernel().tick() - 1, tick + (last - sync + 5 * ms) / (10 * ms));
}

class BusOffBeforeBootUp : public testing::Test {
 protected:
  BusOffBeforeBootUp() {
    board.node = node;
    board.reset_cause = firmware::ResetCause::watchdog;
    module = &bus.add(board);
    module->power_on(0);
  }
  void expect_a_boot_up_from(Microseconds back) {
    bus.run_until(back);
    EXPECT_TRUE(bus.log.empty());
    module->bus_back(back);
    bus.run_until(back + 10 * ms);
    ASSERT_EQ(bus.log.size(), 2U);
    EXPECT_EQ(bus.log[0].frame, encode(canopen::Heartbeat{node, canopen::NmtState::boot_up}));
    EXPECT_EQ(bus.emergencies(node), (std::vector{Emergency{node, EmergencyCode::watchdog_reset, 0, 0}}));
    EXPECT_EQ(module->module.state(), canopen::NmtState::pre_operational);
  }

  test::TestBus bus;
  firmware::ModuleIdentity board;
  test::ModuleNode* module = nullptr;
};

TEST_F(BusOffBeforeBootUp, TheBootUpMessageWaits) {
  module->bus_off(100);
  expect_a_boot_up_from(60 * ms);
}

TEST_F(BusOffBeforeBootUp, ABootUpMessageThatWasLostIsRepeated) {
  const Microseconds boot_up = module->next_deadline();
  module->poll(boot_up);
  ASSERT_EQ(module->pending.size(), 1U);
  module->bus_off(boot_up);
  expect_a_boot_up_from(60 * ms);
}

}  // namespace
}  // namespace proleg
