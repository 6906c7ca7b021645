// A session of a host with a robot: the lease, the movement of the joints to the start of the gait, and the checksums
// of the set-points at its end.

#include <gtest/gtest.h>

#include "scripted_robot.hpp"

namespace proleg::test {
namespace {

using namespace canopen;

constexpr std::uint32_t token = 0x5A17C3E2;
constexpr std::uint32_t foreign_token = 0x11223344;
constexpr Address lease{0x2002, 0};
constexpr Address ramp_in_speed{0x200E, 0};
constexpr Address setpoint_ticks{0x200D, 1};
constexpr Address controlword{0x6040, 0};
constexpr Address mode{0x6060, 0};
constexpr Address target_position{0x607A, 0};
constexpr Address setpoint_crc{0x200D, 2};
constexpr std::uint16_t nmt = 0x000;

/// A master that resets the modules, as on a real bus.
void drive(ScriptedRobot& robot) {
  robot.options.resets_modules = true;
  robot.options.session_token = token;
}

/// Nodes to which the master has written the lease before it reset the modules, in their order.
std::vector<unsigned> leases_before_the_reset(const ScriptedRobot& robot) {
  std::vector<unsigned> nodes;
  for (const sim::Transmission& transmission : robot.transmissions) {
    const CanFrame& frame = transmission.frame;
    if (frame.identifier == nmt) {
      break;
    }
    if ((frame.identifier & 0x780U) == 0x600 && frame.data[0] == 0x23 && frame.data[1] == 0x02 &&
        frame.data[2] == 0x20) {
      nodes.push_back(frame.identifier & 0x7FU);
    }
  }
  return nodes;
}

bool has_sent(const ScriptedRobot& robot, std::uint16_t identifier) {
  return std::ranges::any_of(robot.transmissions, [identifier](const sim::Transmission& transmission) {
    return transmission.frame.identifier == identifier;
  });
}

/// The answer of a module without the object.
AbortCode lacks(Address missing, Address address) {
  return address.index == missing.index ? AbortCode::no_such_object : AbortCode::none;
}

TEST(MasterLease, IsTakenInAscendingOrderOfTheNodesBeforeTheResetAndAgainAfterIt) {
  ScriptedRobot robot(4);
  drive(robot);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  EXPECT_EQ(leases_before_the_reset(robot), (std::vector<unsigned>{3, 5, 7, 9}));
  for (unsigned joint = 0; joint < 4; ++joint) {
    EXPECT_EQ(robot.module(joint).lease, token) << "the reset had ended the first one";
    EXPECT_EQ(robot.module(joint).writes.front(), std::pair(lease, token));
  }
}

TEST(MasterLease, OfAnotherHostLeavesTheRobotAsItIs) {
  for (unsigned owned = 0; owned < 3; ++owned) {
    ScriptedRobot robot(3);
    drive(robot);
    robot.start();
    robot.run_for(100'000);
    robot.module(owned).lease = foreign_token;
    const Microseconds begin = robot.now();
    ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 2'000'000));
    EXPECT_EQ(robot.master().problem().code, ProblemCode::lease_refused);
    EXPECT_EQ(robot.master().problem().node, robot.module(owned).node);
    EXPECT_LE(robot.now() - begin, 1'000'000U);
    EXPECT_FALSE(has_sent(robot, nmt));
    EXPECT_EQ(robot.module(owned).lease, foreign_token);
    robot.master().stop(robot.now());
    robot.run_for(500'000);
    EXPECT_FALSE(has_sent(robot, nmt)) << "the robot is another host's";
  }
}

TEST(MasterLease, OfAHostThatDiedEndsAndIsTakenThen) {
  ScriptedRobot robot(3);
  drive(robot);
  robot.start();
  robot.run_for(100'000);
  robot.module(1).lease = foreign_token;
  robot.run_for(400'000);
  robot.module(1).lease = 0;  // 500 ms after its last heartbeat
  EXPECT_TRUE(robot.run_until_running());
}

TEST(MasterLease, IsNotAskedOfAnOlderProgram) {
  ScriptedRobot robot(3);
  drive(robot);
  robot.module(1).refusal = [](Address address, bool, std::uint32_t) { return lacks(lease, address); };
  robot.start();
  EXPECT_TRUE(robot.run_until_running());
}

TEST(MasterLease, ThatIsTakenAwayDuringTheResetEndsTheStart) {
  ScriptedRobot robot(3);
  drive(robot);
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.module(2).boots == 2; }, 5'000'000));
  robot.module(2).lease = foreign_token;
  ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 5'000'000));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::lease_refused);
  EXPECT_EQ(robot.master().problem().node, robot.module(2).node);
  EXPECT_EQ(robot.module(2).power(), PowerState::switch_on_disabled);
}

TEST(MasterLease, OfAModuleThatDoesNotAnswerDelaysTheStartAndTheModuleIsNamed) {
  ScriptedRobot robot(3);
  drive(robot);
  robot.start();
  robot.module(1).power_off();
  const Microseconds begin = robot.now();
  ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 10'000'000));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::missing_module);
  EXPECT_EQ(robot.master().problem().node, robot.module(1).node);
  EXPECT_LE(robot.now() - begin, 3'000'000U);
}

TEST(MasterRampIn, SyncWaitsForTheLastJoint) {
  ScriptedRobot robot(4);
  robot.options.ramp_in_speed = 90;
  robot.module(2).ramp_in_us = 700'000;
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.module(2).power() == PowerState::operation_enabled; }, 5'000'000));
  const Microseconds powered = robot.now();
  ASSERT_TRUE(robot.run_until([&] { return robot.module(0).produces_sync(); }, 5'000'000));
  EXPECT_GE(robot.now() - powered, 700'000U);
  EXPECT_LE(robot.now() - powered, 750'000U);
  for (unsigned joint = 0; joint < 4; ++joint) {
    EXPECT_EQ(robot.module(joint).value(ramp_in_speed), 90U);
  }
  EXPECT_TRUE(robot.run_until_running());
}

TEST(MasterRampIn, AJointThatDoesNotArriveIsNamedAndNothingMovesOn) {
  ScriptedRobot robot(4);
  robot.options.ramp_in_speed = 90;
  robot.module(2).ramp_in_us = never;
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.module(2).power() == PowerState::operation_enabled; }, 5'000'000));
  const Microseconds powered = robot.now();
  ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 10'000'000));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::not_ramped_in);
  EXPECT_EQ(robot.master().problem().node, robot.module(2).node);
  EXPECT_LE(robot.now() - powered, 4'100'000U) << "180 degrees at 90 degrees a second, and two seconds";
  EXPECT_FALSE(robot.module(0).produces_sync());
  robot.master().stop(robot.now());
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 2'000'000));
  EXPECT_EQ(robot.module(2).power(), PowerState::switch_on_disabled);
}

TEST(MasterRampIn, DoesNotWaitForModulesThatCannot) {
  ScriptedRobot robot(3);
  robot.options.ramp_in_speed = 90;
  robot.module(0).measures_angle = false;
  robot.module(0).ramp_in_us = never;
  robot.module(1).refusal = [](Address address, bool, std::uint32_t) { return lacks(ramp_in_speed, address); };
  robot.module(1).ramp_in_us = never;
  robot.start();
  EXPECT_TRUE(robot.run_until_running());
}

TEST(MasterRampIn, IsOffUnlessItIsAskedFor) {
  ScriptedRobot robot(2);
  robot.module(0).ramp_in_us = never;
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  EXPECT_TRUE(
      std::ranges::none_of(robot.module(0).writes, [](const auto& write) { return write.first == ramp_in_speed; }));
}

TEST(MasterHold, JointsGetPowerWhereTheyAre) {
  ScriptedRobot robot(3);
  robot.options.ramp_in_speed = 90;
  robot.options.holds = true;
  for (unsigned joint = 0; joint < 3; ++joint) {
    robot.module(joint).measured = joint == 1 ? position_not_measured : static_cast<std::int32_t>(1'000'000 * joint);
  }
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  for (unsigned joint = 0; joint < 3; ++joint) {
    std::vector<Address> order;
    for (const auto& [address, value] : robot.module(joint).writes) {
      if (address == mode || address == target_position || (address == controlword && order.back() != controlword)) {
        order.push_back(address);
      }
    }
    const std::vector<Address> expected =
        joint == 1 ? std::vector{mode, controlword} : std::vector{mode, target_position, controlword};
    EXPECT_EQ(order, expected) << "joint " << joint;
    EXPECT_EQ(robot.module(joint).value(mode), 8U);
    EXPECT_EQ(robot.module(joint).value(target_position), joint == 1 ? 0U : 1'000'000U * joint);
  }
}

TEST(MasterHold, AModuleThatRestartsGetsTheModeThatTheOthersHave) {
  for (const bool holds : {true, false}) {
    ScriptedRobot robot(3);
    robot.start();
    ASSERT_TRUE(robot.run_until_running());
    ASSERT_TRUE(robot.run_to_tick(20));
    robot.master().set_holds(holds);
    robot.module(1).measured = 77;
    robot.module(1).power_on(robot.now());
    ASSERT_TRUE(robot.run_until([&] { return robot.count(EventKind::rejoined) == 1; }, 2'000'000));
    EXPECT_EQ(robot.module(1).power(), PowerState::operation_enabled);
    EXPECT_EQ(robot.module(1).value(target_position), holds ? 77U : 0U);
    EXPECT_EQ(std::ranges::any_of(robot.module(1).writes, [](const auto& write) { return write.first == mode; }),
              holds);
  }
}

/// Runs a robot with checksums, and stops it.
void run_and_stop(ScriptedRobot& robot) {
  robot.options.ramps_down = true;
  robot.options.reads_checksums = true;
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.master().stop(robot.now());
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 4'000'000));
}

TEST(MasterChecksums, AreReadFromEveryModuleWhileTheJointsRampDown) {
  using State = Master::SetpointChecksum::State;
  ScriptedRobot robot(4);
  robot.module(2).refusal = [](Address address, bool, std::uint32_t) { return lacks(setpoint_ticks, address); };
  run_and_stop(robot);
  for (const unsigned joint : {0U, 1U, 3U}) {
    EXPECT_EQ(robot.master().checksum(joint).state, State::read);
    const auto& writes = robot.module(joint).writes;
    const auto quick_stop = std::ranges::find(writes, std::pair(Address{0x6040, 0}, std::uint32_t{2}));
    const auto request = std::ranges::find(writes, std::pair(setpoint_ticks, std::uint32_t{0}));
    const auto off = std::find(quick_stop, writes.end(), std::pair(Address{0x6040, 0}, std::uint32_t{0}));
    ASSERT_NE(request, writes.end());
    EXPECT_LT(quick_stop, request);
    EXPECT_LT(request, off);
  }
  EXPECT_EQ(robot.master().checksum(2).state, State::not_available);
}

TEST(MasterChecksums, OfAModuleThatIsGoneAreNotReadAndTheStopEnds) {
  using State = Master::SetpointChecksum::State;
  ScriptedRobot robot(3);
  robot.module(1).refusal = [&robot](Address address, bool, std::uint32_t) {
    if (address.index == setpoint_crc.index) {
      robot.module(1).ignores_sdo = true;
    }
    return AbortCode::none;
  };
  run_and_stop(robot);
  EXPECT_EQ(robot.master().checksum(0).state, State::read);
  EXPECT_EQ(robot.master().checksum(1).state, State::not_read);
  EXPECT_EQ(robot.count(EventKind::not_stopped), 1U);
}

}  // namespace
}  // namespace proleg::test
