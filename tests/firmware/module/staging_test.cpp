// Changes in flight: staged by SDO, committed by COMMIT.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::CommitMessage;
using canopen::Emergency;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using canopen::ValueKind;
using test::node;

class Staging : public testing::Test {
 protected:
  Staging() {
    robot.set_up_and_start();
    robot.run(20);
    before = amplitude();
  }

  AbortCode open(std::uint16_t transaction) { return robot.bus.write(node, object::transaction, transaction); }
  AbortCode stage(std::string_view name, std::int32_t value) {
    return robot.bus.write(node, test::parameter_address(robot.kernel(), 0, name, ValueKind::staged_parameter), 4,
                           static_cast<std::uint32_t>(value));
  }
  AbortCode distort(std::string_view name, std::int32_t value) {
    return robot.bus.write(node, test::parameter_address(robot.kernel(), 0, name, ValueKind::internal_value), 4,
                           static_cast<std::uint32_t>(value));
  }
  void commit(std::uint16_t transaction, std::uint32_t tick, std::uint16_t robot_id = 1) {
    robot.bus.deliver(encode(CommitMessage{transaction, tick, robot_id}));
    robot.bus.run_for(500);
  }
  [[nodiscard]] std::int32_t amplitude() {
    return robot.kernel().parameter(0, 0, test::parameter_index(robot.kernel(), 0, "amplitude"));
  }

  test::TestModule robot;
  std::int32_t before = 0;
  const std::int32_t after = test::degrees(12);
};

TEST_F(Staging, AStagedValueComesIntoForceAtTheTickOfItsCommit) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(7, 25);
  robot.run(21, 24);
  EXPECT_EQ(amplitude(), before);
  robot.run(25, 25);
  EXPECT_EQ(amplitude(), after);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Staging, TheStagedValueCanBeReadBesideTheOneInForce) {
  const canopen::Address staged = test::parameter_address(robot.kernel(), 0, "amplitude", ValueKind::staged_parameter);
  const canopen::Address in_force = test::parameter_address(robot.kernel(), 0, "amplitude");
  EXPECT_EQ(robot.bus.value(node, staged), static_cast<std::uint32_t>(before));
  ASSERT_EQ(open(7), AbortCode::none);
  EXPECT_EQ(robot.bus.value(node, object::transaction), 7U);
  EXPECT_EQ(robot.bus.value(node, object::staged_count), 0U);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  ASSERT_EQ(distort("current_phase", 5), AbortCode::none);
  EXPECT_EQ(robot.bus.value(node, staged), static_cast<std::uint32_t>(after));
  EXPECT_EQ(robot.bus.value(node, in_force), static_cast<std::uint32_t>(before));
  EXPECT_EQ(robot.bus.value(node, object::staged_count), 2U);
}

TEST_F(Staging, NothingIsStagedWithoutAnOpenTransaction) {
  EXPECT_EQ(stage("amplitude", after), AbortCode::refused_by_state);
  EXPECT_EQ(distort("current_phase", 5), AbortCode::refused_by_state);
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(7, 100);
  EXPECT_EQ(stage("amplitude", after), AbortCode::refused_by_state) << "the transaction is closed";
  EXPECT_EQ(open(7), AbortCode::refused_by_state) << "it waits for its tick";
  EXPECT_EQ(robot.bus.value(node, object::refusal), static_cast<std::uint32_t>(Status::staging_closed));
}

TEST_F(Staging, AStagedValueOutOfRangeIsRefused) {
  ASSERT_EQ(open(7), AbortCode::none);
  EXPECT_EQ(stage("amplitude", test::degrees(-1)), AbortCode::below_minimum);
  EXPECT_EQ(robot.bus.value(node, object::staged_count), 0U);
}

TEST_F(Staging, MoreTransactionsThanThereIsRoomForAreRefused) {
  for (std::uint16_t transaction = 1; transaction <= max_transactions; ++transaction) {
    ASSERT_EQ(open(transaction), AbortCode::none);
    commit(transaction, 1'000U + transaction);
  }
  EXPECT_EQ(open(99), AbortCode::out_of_memory);
  EXPECT_EQ(robot.bus.value(node, object::refusal), static_cast<std::uint32_t>(Status::staging_full));
}

TEST_F(Staging, ACommitThatComesTooLateChangesNothingAndIsToldOnce) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  for (int i = 0; i < 3; ++i) {
    commit(7, 20);
  }
  robot.run(21, 40);
  EXPECT_EQ(amplitude(), before);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::commit_too_late, 0, 20}));
  // The change may be committed again, in time.
  commit(7, 41);
  robot.run(41, 41);
  EXPECT_EQ(amplitude(), after);
}

TEST_F(Staging, ACommitOfWhatWasNotStagedIsToldOnce) {
  for (int i = 0; i < 3; ++i) {
    commit(9, 100);
  }
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0], (Emergency{node, EmergencyCode::commit_not_staged, 0, 9}));
  commit(9, 200);
  EXPECT_EQ(robot.emergencies().size(), 2U) << "another attempt";
}

TEST_F(Staging, RepeatsOfACommitAreSilentAlsoAfterItsTick) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(7, 23);
  commit(7, 23);
  robot.run(21, 25);
  commit(7, 23);
  EXPECT_TRUE(robot.emergencies().empty());
  EXPECT_EQ(amplitude(), after);
}

TEST_F(Staging, ACommitForAnotherRobotIsIgnored) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(7, 23, 2);
  commit(8, 23, 2);
  robot.run(21, 25);
  EXPECT_EQ(amplitude(), before);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Staging, ACommitOfWrongLengthIsIgnored) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  CanFrame frame = encode(CommitMessage{7, 23, 1});
  frame.length = 7;
  robot.bus.deliver(frame);
  robot.run(21, 25);
  EXPECT_EQ(amplitude(), before);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Staging, AnUnconfiguredModuleIgnoresCommits) {
  test::TestModule other;
  other.boot();
  other.bus.deliver(encode(CommitMessage{7, 23, 1}));
  other.bus.run_for(1'000);
  EXPECT_TRUE(other.emergencies().empty());
}

TEST_F(Staging, AModuleThatLostTheTickCatchesUpWithACommitWhenItJoins) {
  ASSERT_EQ(open(7), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  robot.sync(60);  // too many SYNCs were missed
  ASSERT_FALSE(robot.module().synchronised());
  commit(7, 65);
  robot.tick(70);
  robot.run(70, 71);
  EXPECT_EQ(amplitude(), after);
}

TEST_F(Staging, IsPossibleInPreOperationalForAnyTick) {
  robot.command(NmtCommand::reset_node);
  robot.bus.run_for(20'000);
  robot.configure(0);
  ASSERT_EQ(open(1), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(1, 0);
  robot.start();
  EXPECT_EQ(amplitude(), before);
  robot.run(0);
  EXPECT_EQ(amplitude(), after);
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(Staging, AStoppedRobotTakesChangesForTheTicksOfItsNextStart) {
  robot.command(NmtCommand::enter_pre_operational);
  ASSERT_EQ(open(1), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  commit(1, 3);
  EXPECT_TRUE(robot.emergencies().empty());
  robot.start();
  robot.run(2);
  EXPECT_EQ(amplitude(), before);
  robot.run(3, 3);
  EXPECT_EQ(amplitude(), after);
}

TEST_F(Staging, AParameterWrittenAtOnceKeepsWhatIsStaged) {
  robot.command(NmtCommand::enter_pre_operational);
  ASSERT_EQ(open(1), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, test::parameter_address(robot.kernel(), 0, "offset"), 4, 0), AbortCode::none);
  ASSERT_EQ(distort("current_phase", 5), AbortCode::none);
  commit(1, 10);
  robot.start();
  robot.run(9);
  EXPECT_EQ(amplitude(), before);
  robot.run(10, 10);
  EXPECT_EQ(amplitude(), after);
}

TEST_F(Staging, AnotherConfigurationDropsWhatIsStaged) {
  robot.command(NmtCommand::enter_pre_operational);
  ASSERT_EQ(open(1), AbortCode::none);
  ASSERT_EQ(stage("amplitude", after), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, object::activate, 1), AbortCode::none);
  EXPECT_EQ(stage("amplitude", after), AbortCode::refused_by_state);
  commit(1, 10);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0].code, EmergencyCode::commit_not_staged);
}

}  // namespace
}  // namespace proleg
