// SYNC and TICK as a module receives them: the start, missed and repeated ones, and how it joins a robot that moves.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::AbortCode;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using test::node;
constexpr std::uint16_t state_identifier = canopen::identifier::state_frame + node;

class Sync : public testing::Test {
 protected:
  Sync() {
    robot.set_up_and_start();
    robot.enable(0);
    EXPECT_EQ(reference.configure(robot.setup.kernel, 0), Status::ok);
  }

  /// The set-point after SYNC `tick` of a kernel that has missed nothing.
  std::int32_t expected_setpoint(std::uint32_t tick) {
    while (reference.tick() <= tick) {
      reference.advance();
    }
    return reference.setpoint(0);
  }
  void expect_unmoved() {
    const std::size_t pulses = robot.it().pulse_count();
    robot.bus.run_for(100'000);
    EXPECT_EQ(robot.it().pulse_count(), pulses);
    EXPECT_FALSE(robot.it().is_pulsing());
    EXPECT_FALSE(robot.module().synchronised());
  }
  /// Expects that the joint does not follow the gait: it moves to the safe pose and stays there.
  void expect_quick_stop() {
    EXPECT_FALSE(robot.module().synchronised());
    EXPECT_EQ(robot.module().power(), canopen::PowerState::quick_stop_active);
    robot.bus.run_for(1'020'000);
    EXPECT_EQ(robot.it().pulses.back().width, servo_center);
    const std::size_t pulses = robot.it().pulse_count();
    robot.bus.run_for(100'000);
    EXPECT_EQ(robot.it().pulse_count(), pulses);
  }

  test::TestModule robot;
  KernelOf<1> reference;
};

TEST_F(Sync, TheFrameOfStateZeroIsSentOnTheWayIntoOperational) {
  const auto frames = robot.bus.sent(state_identifier);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].frame, canopen::encode_state(node, 0, std::as_const(reference).frame(0, 0)));
}

TEST_F(Sync, TheSyncAfterTickZeroIsTickZero) {
  robot.tick(0);
  EXPECT_FALSE(robot.module().synchronised());
  robot.sync(0);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.kernel().tick(), 1U);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(0));
  EXPECT_TRUE(robot.it().is_pulsing());
  robot.bus.run_for(500);
  EXPECT_EQ(robot.bus.sent(state_identifier).back().frame,
            canopen::encode_state(node, 0, std::as_const(reference).frame(0, 0)));
}

TEST_F(Sync, EverySyncComputesATickAndSendsItsFrame) {
  robot.run(300);
  EXPECT_EQ(robot.kernel().tick(), 301U);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(300));
  const auto frames = robot.bus.sent(state_identifier);
  ASSERT_EQ(frames.size(), 302U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].frame.data[7], i % 256);
  }
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, ContactsAreReadAtSyncAndDebounced) {
  const auto contacts = [&] {
    robot.bus.run_for(500);
    return robot.bus.sent(state_identifier).back().frame.data[6] & StateFrame::contact_bits;
  };
  robot.run(0);
  robot.it().sensors = 0x0F;
  robot.sync(1);
  EXPECT_EQ(contacts(), 0);
  robot.sync(2);
  EXPECT_EQ(contacts(), 0x0F);
  robot.it().sensors = 0x01;
  robot.sync(3);
  EXPECT_EQ(contacts(), 0x0F);
  robot.sync(4);
  EXPECT_EQ(contacts(), 0x01);
  const auto syncs = robot.bus.sent(canopen::identifier::sync);
  ASSERT_EQ(robot.it().readings.size(), syncs.size());
  for (std::size_t i = 0; i < syncs.size(); ++i) {
    EXPECT_EQ(robot.it().readings[i], syncs[i].time);
  }
}

TEST_F(Sync, WithoutTickNothingIsComputedAndNothingMoves) {
  robot.run(0, 20);
  EXPECT_EQ(robot.kernel().tick(), 0U);
  EXPECT_EQ(robot.bus.sent(state_identifier).size(), 1U);
  expect_unmoved();
}

TEST_F(Sync, ASyncOfWrongLengthOrCounterIsIgnored) {
  robot.run(5);
  robot.bus.deliver({canopen::identifier::sync, 0, {}});
  robot.bus.deliver({canopen::identifier::sync, 2, {7, 0}});
  robot.bus.deliver({canopen::identifier::sync, 1, {0}});
  robot.bus.deliver({canopen::identifier::sync, 1, {129}});
  EXPECT_EQ(robot.kernel().tick(), 6U);
  EXPECT_TRUE(robot.module().synchronised());
  robot.run(6, 10);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(10));
}

TEST_F(Sync, ARepeatedSyncIsIgnored) {
  robot.run(5);
  robot.bus.deliver(canopen::encode_sync(5));
  robot.bus.run_for(3'000);
  robot.bus.deliver(canopen::encode_sync(5));
  EXPECT_EQ(robot.kernel().tick(), 6U);
  robot.run(6, 10);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(10));
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, ASyncSoonerThanHalfAPeriodIsNoTickAndIsReportedOnce) {
  robot.run(5);
  robot.sync(6);
  const Microseconds accepted = robot.bus.now();
  for (const std::uint32_t tick : {7U, 8U, 9U}) {
    robot.bus.run_for(1'000);
    robot.bus.deliver(canopen::encode_sync(tick));
    EXPECT_EQ(robot.kernel().tick(), 7U);
  }
  robot.bus.run_for(1'000);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::early_sync, 0, 5'000 - 1'130}));
  // This SYNC comes half a period after the one that counted.
  robot.bus.run_until(accepted + 5'000 - test::TestBus::frame_time_us);
  robot.bus.deliver(canopen::encode_sync(7));
  EXPECT_EQ(robot.kernel().tick(), 8U);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(7));
}

TEST_F(Sync, ASecondProducerDoesNotDriveTheRobotFaster) {
  robot.run(20);
  // Another producer sends between the SYNCs of the first, with the counter that fits.
  for (std::uint32_t k = 21; k < 121; ++k) {
    robot.sync(k);
    robot.bus.run_for(4'000);
    robot.bus.deliver(canopen::encode_sync(k + 1));
  }
  EXPECT_EQ(robot.kernel().tick(), 121U);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(120));
}

TEST_F(Sync, UpToEightMissedSyncsAreCaughtUpWith) {
  std::uint32_t last = 5;
  robot.run(last);
  for (std::uint32_t missed = 1; missed <= 8; ++missed) {
    robot.bus.run_for(missed * 10'000);
    const std::uint32_t next = last + missed + 1;
    robot.sync(next);
    EXPECT_EQ(robot.kernel().tick(), next + 1);
    EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(next));
    robot.bus.run_for(500);
    const CanFrame frame = robot.bus.sent(state_identifier).back().frame;
    EXPECT_EQ(frame.data[7], next + 1);
    EXPECT_NE(frame.data[6] & StateFrame::holdover, 0) << "computed without hearing SYNC";
    robot.sync(next + 1);
    robot.bus.run_for(9'000);
    EXPECT_EQ(robot.bus.sent(state_identifier).back().frame.data[6] & StateFrame::holdover, 0);
    last = next + 1;
  }
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, ACommitInATickWhoseSyncWasMissedTakesEffectInItsTick) {
  const unsigned offset = test::parameter_index(reference, 0, "offset");
  ASSERT_EQ(robot.bus.write(node, canopen::object::transaction, 1), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, test::parameter_address(reference, 0, "offset", canopen::ValueKind::staged_parameter),
                            4, static_cast<std::uint32_t>(test::degrees(10))),
            AbortCode::none);
  robot.bus.deliver(encode(canopen::CommitMessage{1, 8, robot.setup.robot_id}));
  ASSERT_EQ(reference.stage(1, 0, 0, offset, test::degrees(10)), Status::ok);
  ASSERT_EQ(reference.commit(1, 8), Status::ok);
  robot.run(6);
  robot.sync(10);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(10));
}

TEST_F(Sync, NineMissedSyncsLoseTheTick) {
  robot.run(5);
  robot.sync(15);
  EXPECT_EQ(robot.kernel().tick(), 6U);
  expect_quick_stop();
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::sync_lost, 0x11, 6}));
  // Later SYNCs give no tick without TICK.
  robot.run(16, 19);
  expect_quick_stop();
  EXPECT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0x11U);
}

TEST_F(Sync, ASyncThatGoesBackLosesTheTick) {
  robot.run(20);
  robot.sync(18);
  expect_quick_stop();
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0].code, EmergencyCode::sync_lost);
}

TEST_F(Sync, ATickThatFitsChangesNothing) {
  robot.run(9);
  robot.tick(10);
  robot.run(10, 19);
  robot.tick(20);
  robot.run(20, 25);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(25));
  EXPECT_TRUE(robot.emergencies().empty());
}

// SYNC has the higher priority and may overtake TICK on a busy bus.
TEST_F(Sync, ATickThatItsSyncHasOvertakenChangesNothing) {
  robot.run(10);
  robot.tick(10);
  robot.run(11, 15);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(15));
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, ATickThatComesBeforeMissedSyncsAreKnownChangesNothing) {
  robot.run(8);
  robot.tick(10);  // SYNC 9 was missed
  robot.sync(10);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(10));
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, AnotherTickThanItsOwnLosesTheTickAndTheModuleJoinsFromIt) {
  robot.run(20);
  robot.tick(500);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::quick_stop_active);
  EXPECT_FALSE(robot.module().synchronised());
  robot.sync(500);
  EXPECT_EQ(robot.kernel().tick(), 501U);
  EXPECT_FALSE(robot.module().synchronised());
  robot.bus.run_for(9'000);
  robot.sync(501);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(501)) << "the plain sine is a function of the tick";
  robot.bus.run_for(9'000);
  robot.sync(502);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::quick_stop_active) << "only the host lets it follow again";
  robot.bus.run_for(1'000);
  const auto emergencies = robot.emergencies();
  ASSERT_EQ(emergencies.size(), 3U);
  EXPECT_EQ(emergencies[0], (Emergency{node, EmergencyCode::sync_lost, 0x11, 21}));
  EXPECT_EQ(emergencies[1],
            (Emergency{node, EmergencyCode::none, 0, static_cast<std::uint32_t>(EmergencyCode::sync_lost)}));
  EXPECT_EQ(emergencies[2], (Emergency{node, EmergencyCode::rejoined, 0, 501}));
}

TEST_F(Sync, AForeignConfigurationIsToldOnceAndGivesNoTick) {
  for (int i = 0; i < 3; ++i) {
    robot.bus.deliver(encode(canopen::TickMessage{0, robot.crc() ^ 1U}));
    robot.sync(0);
  }
  EXPECT_EQ(robot.kernel().tick(), 0U);
  expect_unmoved();
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::foreign_configuration, 0x81, robot.crc() ^ 1U}));
  robot.tick(0);
  robot.sync(0);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.emergencies().back().code, EmergencyCode::none);
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0U);
}

TEST_F(Sync, AForeignConfigurationStopsAModuleThatMoves) {
  robot.run(9);
  ASSERT_TRUE(robot.it().is_pulsing());
  robot.bus.deliver(encode(canopen::TickMessage{10, robot.crc() + 1U}));
  robot.run(10, 15);
  expect_quick_stop();
}

TEST_F(Sync, ATickOfWrongLengthIsIgnored) {
  CanFrame frame = encode(canopen::TickMessage{0, robot.crc()});
  frame.length = 7;
  robot.bus.deliver(frame);
  robot.sync(0);
  expect_unmoved();
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Sync, AfterAStopTickZeroStartsFromStateZeroAgain) {
  robot.run(50);
  robot.tick(0);
  robot.bus.run_for(500);
  const CanFrame frame = robot.bus.sent(state_identifier).back().frame;
  EXPECT_EQ(frame.data[7], 0) << "the frame of state 0 is sent again";
  robot.sync(0);
  EXPECT_EQ(robot.kernel().tick(), 1U);
  EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(0));
}

// The label of the frame would be one too high for its neighbours.
TEST_F(Sync, AModuleThatStartsInAMovingRobotWaitsForTheTick) {
  std::uint32_t tick = 100;
  for (const NmtCommand command : {NmtCommand::enter_pre_operational, NmtCommand::stop}) {
    robot.command(command);
    const std::size_t from = robot.bus.log.size();
    robot.run(tick, tick + 3);
    robot.command(NmtCommand::start);
    robot.run(tick + 4, tick + 9);
    EXPECT_TRUE(robot.bus.sent(state_identifier, from).empty());
    robot.tick(tick + 10);
    robot.run(tick + 10, tick + 11);
    EXPECT_EQ(robot.bus.sent(state_identifier, from).size(), 1U);
    EXPECT_EQ(robot.kernel().setpoint(0), expected_setpoint(tick + 11));
    tick += 20;
  }
}

TEST_F(Sync, AModuleThatReceivedSyncAndStartsWithTickZeroSendsTheFrameOfStateZeroThen) {
  robot.command(NmtCommand::enter_pre_operational);
  robot.run(100, 103);
  robot.command(NmtCommand::start);
  const std::size_t from = robot.bus.log.size();
  robot.tick(0);
  robot.bus.run_for(500);
  const auto frames = robot.bus.sent(state_identifier, from);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].frame.data[7], 0);
}

TEST_F(Sync, AModuleThatLeavesOperationalLosesTheTick) {
  robot.run(20);
  robot.command(NmtCommand::enter_pre_operational);
  EXPECT_FALSE(robot.module().synchronised());
  EXPECT_EQ(robot.kernel().tick(), 0U);
  robot.start();
  robot.run(0, 5);
  expect_unmoved();
  EXPECT_EQ(robot.kernel().tick(), 0U);
}

TEST_F(Sync, AStartIsNotFlaggedByWhatWasBefore) {
  robot.run(5);
  robot.sync(9);
  robot.command(NmtCommand::enter_pre_operational);
  robot.start();
  EXPECT_EQ(robot.bus.sent(state_identifier).back().frame,
            canopen::encode_state(node, 0, std::as_const(reference).frame(0, 0)));
}

TEST_F(Sync, HalfASecondWithoutSyncLosesTheTickAndStopsTheRobot) {
  robot.run(20);
  const auto last = robot.bus.sent(canopen::identifier::sync).back().time;
  robot.bus.run_until(last + 499'999);
  EXPECT_TRUE(robot.module().synchronised());
  EXPECT_EQ(robot.module().power(), canopen::PowerState::operation_enabled);
  robot.bus.run_until(last + 500'000);
  EXPECT_FALSE(robot.module().synchronised());
  EXPECT_EQ(robot.module().power(), canopen::PowerState::quick_stop_active);
  robot.bus.run_for(3'000'000);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::sync_lost, 0x11, 21}));
}

TEST_F(Sync, AnEnabledModuleThatNeverReceivesSyncStops) {
  robot.bus.run_for(600'000);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::quick_stop_active);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0].code, EmergencyCode::sync_lost);
  EXPECT_EQ(robot.it().pulse_count(), 0U) << "its angle is not known";
}

TEST(SyncSilence, IsNoFaultOfAModuleThatIsNeitherSynchronisedNorEnabled) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.bus.run_for(2'000'000);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST(Rejoin, AModuleThatIsReplacedInAMovingRobotJoinsAgain) {
  test::TestRobot robot(test::one_slot(test::algorithm(test::coupled), 5));
  test::TestRobot undisturbed(test::one_slot(test::algorithm(test::coupled), 5));
  robot.drive();
  undisturbed.drive();
  robot.run_to(300);
  robot.command(NmtCommand::reset_node, robot.node(2));
  robot.bus.run_for(20'000);
  robot.configure(2);
  robot.command(NmtCommand::start, robot.node(2));
  robot.run_to(700);
  undisturbed.run_to(700);
  const auto emergencies = robot.bus.emergencies(robot.node(2));
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0].code, EmergencyCode::rejoined);
  EXPECT_EQ(emergencies[0].detail % 10, 1U);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(robot.kernel(joint).tick(), 701U);
    EXPECT_NEAR(test::in_degrees(robot.kernel(joint).setpoint(joint)),
                test::in_degrees(undisturbed.kernel(joint).setpoint(joint)), 1.5);
    if (joint != 2) {
      EXPECT_TRUE(robot.bus.emergencies(robot.node(joint)).empty()) << "joint " << joint;
    }
  }
}

}  // namespace
}  // namespace proleg
