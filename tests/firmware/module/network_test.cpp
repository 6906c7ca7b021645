// The module as a node of a CANopen network: CiA 301, section 7.3.2, and docs/protocol.md.

#include <set>

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::AbortCode;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using canopen::NmtState;
using test::node;
constexpr std::uint16_t heartbeat_identifier = canopen::identifier::heartbeat + node;

firmware::ModuleIdentity identity(std::uint8_t node_id, std::uint32_t id) {
  firmware::ModuleIdentity made;
  made.node = node_id;
  made.unique_id = {id, id * 7919U, 3};
  return made;
}

TEST(Network, SendsNothingAndReceivesNothingBeforePowerOn) {
  test::TestModule robot;
  EXPECT_EQ(robot.module().next_deadline(), never);
  robot.command(NmtCommand::reset_node);
  robot.bus.deliver({heartbeat_identifier, 1, {0}});
  robot.tick(0);
  robot.sync(0);
  robot.bus.run_for(1'000'000);
  EXPECT_EQ(robot.module().next_deadline(), never);
  EXPECT_EQ(robot.bus.log.size(), 4U);
  EXPECT_EQ(robot.it().pulse_count(), 0U);
}

TEST(Network, BootUpComesOnceAndThenTheModuleIsPreOperational) {
  test::TestModule robot;
  robot.boot();
  ASSERT_EQ(robot.bus.log.size(), 1U);
  EXPECT_EQ(robot.bus.log[0].frame, (CanFrame{heartbeat_identifier, 1, {0}}));
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  robot.bus.run_for(10'000'000);
  EXPECT_EQ(robot.bus.log.size(), 1U);
}

TEST(Network, TheBootUpDelayIsOneToSixteenMillisecondsByTheUniqueId) {
  std::set<Microseconds> delays;
  for (std::uint32_t id = 0; id < 200; ++id) {
    test::ModuleNode module(identity(9, id), id * 1'000'003U);
    module.power_on(500);
    const Microseconds delay = module.next_deadline() - 500;
    EXPECT_EQ(delay % 1'000, 0U);
    EXPECT_GE(delay, 1'000U);
    EXPECT_LE(delay, 16'000U);
    delays.insert(delay);
    // The delay follows from the id, so it is the same again.
    module.power_on(777'777);
    EXPECT_EQ(module.next_deadline() - 777'777, delay);
  }
  EXPECT_EQ(delays.size(), 16U);
}

TEST(Network, NoServiceAnswersBeforeBootUp) {
  test::TestModule robot;
  robot.it().power_on(0);
  robot.bus.send({canopen::identifier::sdo_request + node, 8, {0x40, 0x18, 0x10, 1}});
  robot.bus.send(encode(canopen::NmtRequest{NmtCommand::stop, 0}));
  robot.bus.run_until(900);
  EXPECT_EQ(robot.bus.log.size(), 2U);
  EXPECT_EQ(robot.module().state(), NmtState::boot_up);
}

TEST(Network, HeartbeatComesEveryPeriodWithTheState) {
  test::TestModule robot;
  robot.set_up_and_start();  // the set-up asks for 100 ms
  const std::size_t from = robot.bus.log.size();
  const Microseconds start = robot.bus.now();
  robot.bus.run_for(1'000'000);
  const auto beats = robot.bus.sent(heartbeat_identifier, from);
  ASSERT_EQ(beats.size(), 10U);
  for (std::size_t i = 0; i < beats.size(); ++i) {
    EXPECT_EQ(beats[i].frame, (CanFrame{heartbeat_identifier, 1, {0x05}}));
    EXPECT_EQ(beats[i].time - beats[0].time, i * 100'000);
  }
  EXPECT_LE(beats[0].time - start, 100'000U);
  robot.command(NmtCommand::stop);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.bus.sent(heartbeat_identifier).back().frame, (CanFrame{heartbeat_identifier, 1, {0x04}}));
  robot.command(NmtCommand::enter_pre_operational);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.bus.sent(heartbeat_identifier).back().frame, (CanFrame{heartbeat_identifier, 1, {0x7F}}));
}

TEST(Network, AHeartbeatThatIsSentTooLateDoesNotCatchUp) {
  test::ModuleNode module(identity(9, 1));
  module.power_on(0);
  module.poll(20'000);
  module.receive(20'000, {0x609, 8, {0x2B, 0x17, 0x10, 0, 10}});
  module.poll(20'000);
  EXPECT_EQ(module.next_deadline(), 30'000U);
  module.poll(95'000);
  EXPECT_EQ(module.next_deadline(), 105'000U);
}

TEST(Network, AHeartbeatPeriodOfZeroEndsIt) {
  test::TestModule robot;
  robot.boot();
  EXPECT_EQ(robot.bus.write(node, canopen::object::heartbeat_period, 10), AbortCode::none);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.bus.write(node, canopen::object::heartbeat_period, 0), AbortCode::none);
  const std::size_t from = robot.bus.log.size();
  robot.bus.run_for(1'000'000);
  EXPECT_EQ(robot.bus.log.size(), from);
}

TEST(Network, CommandsForOtherNodesAndUnknownOnesAreIgnored) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.command(NmtCommand::stop, node + 1);
  robot.bus.deliver({canopen::identifier::nmt, 2, {0x03, 0}});
  robot.bus.deliver({canopen::identifier::nmt, 1, {0x02, 0}});
  robot.bus.deliver({canopen::identifier::nmt, 3, {0x02, 0, 0}});
  EXPECT_EQ(robot.module().state(), NmtState::operational);
  robot.command(NmtCommand::stop, node);
  EXPECT_EQ(robot.module().state(), NmtState::stopped);
}

TEST(Network, AStoppedModuleAnswersNothingButNetworkManagement) {
  test::TestModule robot;
  robot.set_up_and_start();
  ASSERT_EQ(robot.bus.write(node, canopen::object::heartbeat_period, 0), AbortCode::none);
  robot.command(NmtCommand::stop);
  const std::size_t from = robot.bus.log.size();
  robot.bus.send({canopen::identifier::sdo_request + node, 8, {0x40, 0x18, 0x10, 1}});
  robot.bus.send(encode(canopen::CommitMessage{1, 100, robot.setup.robot_id}));
  robot.bus.send(encode(canopen::TickMessage{0, ~robot.crc()}));
  robot.bus.send(canopen::encode_sync(0));
  robot.bus.send(
      encode(canopen::Heartbeat{canopen::host_node, NmtState::operational}));  // the host sends no other heartbeat
  robot.bus.run_for(2'000'000);
  EXPECT_EQ(robot.bus.log.size(), from + 5);
  robot.command(NmtCommand::start);
  EXPECT_EQ(robot.module().state(), NmtState::operational);
}

/// CiA 301, 7.3.2.2: the communication profile area.
bool is_communication(const canopen::Object& entry) { return entry.address.index < 0x2000; }

class Reset : public testing::TestWithParam<NmtCommand> {};
INSTANTIATE_TEST_SUITE_P(OfBothKinds, Reset, testing::Values(NmtCommand::reset_node, NmtCommand::reset_communication));

TEST_P(Reset, RestoresTheDefaultsAndBootsAgain) {
  const bool is_whole = GetParam() == NmtCommand::reset_node;
  test::TestModule robot;
  robot.setup.kernel.tick_period_us = 7'000;
  robot.set_up_and_start();
  robot.enable(0);
  robot.run(5);
  ASSERT_TRUE(robot.it().is_pulsing());
  ASSERT_EQ(robot.bus.write(node, canopen::object::mode, canopen::mode_direct_position), AbortCode::none);
  const std::size_t from = robot.bus.log.size();
  robot.command(GetParam(), node);
  EXPECT_FALSE(robot.it().is_pulsing());
  const Microseconds reset_at = robot.bus.now();
  robot.bus.run_for(20'000);
  const auto boot_up = robot.bus.sent(heartbeat_identifier, from);
  ASSERT_EQ(boot_up.size(), 1U);
  EXPECT_GT(boot_up[0].time, reset_at + 1'000);
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::switch_on_disabled);
  EXPECT_FALSE(robot.module().synchronised());
  for (const canopen::ObjectRow& row : canopen::object_rows()) {
    if (row.first->access == canopen::Access::read_write && row.indices == 1 && !is_long(row.first->type) &&
        (is_whole || is_communication(*row.first))) {
      EXPECT_EQ(robot.bus.value(node, *row.first),
                row.first->default_value & 0xFFFFFFFFU >> (32 - 8 * size_of(row.first->type)))
          << row.first->name;
    }
  }
  EXPECT_EQ(robot.bus.value(node, canopen::object::current_tick), 0U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::configuration_crc), is_whole ? 0U : robot.crc());
}

TEST(Network, AResetOfTheCommunicationLeavesTheApplicationAsItIs) {
  KernelConfiguration kernel = test::one_slot(test::algorithm(test::coupled), 3, 7'000);
  test::TestModule robot(kernel);
  robot.set_up_and_start();
  const canopen::Address amplitude = test::parameter_address(robot.kernel(), 0, "amplitude");
  robot.command(NmtCommand::enter_pre_operational);
  ASSERT_EQ(robot.bus.write(node, amplitude, 4, 0x0E38E38E), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, canopen::object::upper_limit, 0x10000000), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, canopen::object::current_limit, 1'234), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, canopen::object::target_position, 77), AbortCode::none);
  robot.start();
  robot.command(NmtCommand::reset_communication, node);
  robot.bus.run_for(20'000);
  EXPECT_EQ(robot.bus.value(node, amplitude), 0x0E38E38EU);
  EXPECT_EQ(robot.bus.value(node, canopen::object::upper_limit), 0x10000000U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::current_limit), 1'234U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::target_position), 77U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::joint_count), 3U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::activate), 1U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::tick_period), 10'000U);
  EXPECT_EQ(robot.bus.value(node, canopen::object::state_frame_identifier[0].address(1)), canopen::pdo_off);
  EXPECT_TRUE(robot.it().listened.empty());

  // Without the frames of its neighbours the joint would compute other angles.
  robot.command(NmtCommand::start);
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0].code, EmergencyCode::not_configured);

  const canopen::SetupList list(robot.setup, 0);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list.at(i).address.index < 0x2000) {
      ASSERT_EQ(robot.bus.write(node, list.at(i).address, list.at(i).size, list.at(i).value), AbortCode::none);
    }
  }
  robot.command(NmtCommand::start);
  EXPECT_EQ(robot.module().state(), NmtState::operational);
  EXPECT_FALSE(robot.it().listened.empty());
  EXPECT_EQ(robot.bus.value(node, amplitude), 0x0E38E38EU);
}

TEST(Network, AResetOfTheCommunicationLeavesTheServoWithoutPowerButInItsFault) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.enable(0);
  robot.it().meters.readings.current_ma = 3'000;
  robot.run(60);
  ASSERT_EQ(robot.module().power(), canopen::PowerState::fault);
  robot.command(NmtCommand::reset_communication);
  robot.bus.run_for(20'000);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::fault) << "of the application";
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0x03U) << "generic, current";
  EXPECT_FALSE(robot.it().is_pulsing());
  robot.command(NmtCommand::reset_node);
  robot.bus.run_for(20'000);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::switch_on_disabled);
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0U);
}

TEST(Network, TheErrorHistoryHasTheLastEightTheNewestFirst) {
  test::TestModule robot;
  robot.boot();
  const auto error = [&](std::uint8_t sub) {
    std::uint32_t value = 0;
    const AbortCode code = robot.bus.read(node, {0x1003, sub}, value);
    return code == AbortCode::none ? value : static_cast<std::uint32_t>(code);
  };
  constexpr auto no_data = static_cast<std::uint32_t>(AbortCode::no_data);
  EXPECT_EQ(error(0), 0U);
  EXPECT_EQ(error(1), no_data);
  robot.command(NmtCommand::start);  // the module is not configured
  EXPECT_EQ(error(0), 1U);
  EXPECT_EQ(error(1), 0x00006300U);
  EXPECT_EQ(error(2), no_data);
  robot.configure(0);
  robot.start();
  const auto commit = [&](std::uint16_t transaction) {
    robot.bus.deliver(encode(canopen::CommitMessage{transaction, 100, robot.setup.robot_id}));
    robot.bus.run_for(1'000);
  };
  for (std::uint16_t transaction = 1; transaction <= 9; ++transaction) {
    commit(transaction);
  }
  EXPECT_EQ(error(0), 8U);
  for (std::uint8_t sub = 1; sub <= 8; ++sub) {
    EXPECT_EQ(error(sub), 0x0000FF02U | (10U - sub) << 16U) << "commit not staged, its transaction";
  }
  EXPECT_EQ(error(9), static_cast<std::uint32_t>(AbortCode::no_such_sub_index));
  // CiA 301, 7.5.2.4: 0 clears, no other value is allowed.
  EXPECT_EQ(robot.bus.write(node, {0x1003, 0}, 1, 1), AbortCode::out_of_range);
  EXPECT_EQ(robot.bus.write(node, {0x1003, 1}, 4, 0), AbortCode::read_only);
  EXPECT_EQ(error(0), 8U);
  EXPECT_EQ(robot.bus.write(node, {0x1003, 0}, 1, 0), AbortCode::none);
  EXPECT_EQ(error(0), 0U);
  EXPECT_EQ(error(1), no_data);
  commit(10);
  EXPECT_EQ(error(0), 1U);
  robot.command(NmtCommand::reset_communication);
  robot.bus.run_for(20'000);
  EXPECT_EQ(error(0), 0U);
}

TEST(Network, AnErrorThatIsOverIsNoErrorOfTheHistory) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.it().bus_off(robot.bus.now());
  robot.bus.run_for(20'000);
  robot.it().bus_back(robot.bus.now());
  robot.bus.run_for(11'000'000);
  ASSERT_EQ(robot.emergencies().back().code, EmergencyCode::none);
  std::uint32_t value = 0;
  EXPECT_EQ(robot.bus.read(node, {0x1003, 0}, value), AbortCode::none);
  for (std::uint8_t sub = 1; sub <= value; ++sub) {
    EXPECT_NE(robot.bus.value(node, canopen::Address{0x1003, sub}) & 0xFFFFU, 0U);
  }
}

TEST(Network, PowerOnAtAnyTimeIsAReset) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.enable(0);
  robot.run(5);
  const std::size_t from = robot.bus.log.size();
  robot.it().power_on(robot.bus.now());
  EXPECT_FALSE(robot.it().is_pulsing());
  const std::size_t pulses = robot.it().pulse_count();
  robot.bus.run_for(2'000'000);
  EXPECT_EQ(robot.it().pulse_count(), pulses);
  EXPECT_TRUE(robot.emergencies(from).empty());
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
}

TEST(Network, AResetClearsTheQueue) {
  test::TestModule robot;
  robot.set_up_and_start();
  // The bus is busy, so that the answers wait in the queue.
  for (int i = 0; i < 12; ++i) {
    robot.it().receive(robot.bus.now(), {canopen::identifier::sdo_request + node, 8, {0x40, 0x18, 0x10, 1}});
  }
  robot.it().receive(robot.bus.now(), encode(canopen::NmtRequest{NmtCommand::reset_node, 0}));
  const std::size_t from = robot.bus.log.size();
  robot.bus.run_for(20'000);
  // The frames are the answer that the controller has already, and the boot-up message.
  EXPECT_EQ(robot.bus.log.size(), from + 2);
}

TEST(Network, WhatDoesNotFitTheQueueIsDroppedAndCounted) {
  test::TestModule robot;
  robot.set_up_and_start();
  constexpr unsigned requests = 30;
  for (unsigned i = 0; i < requests; ++i) {
    robot.it().receive(robot.bus.now(), {canopen::identifier::sdo_request + node, 8, {0x40, 0x18, 0x10, 1}});
  }
  const std::size_t room = 1 + TransmitQueue::capacity;  // one of them in a mailbox
  EXPECT_EQ(robot.module().dropped_frames(), requests - room);
  const std::size_t from = robot.bus.log.size();
  robot.bus.run_for(20'000);
  EXPECT_EQ(robot.bus.sent(canopen::identifier::sdo_answer + node, from).size(), room);
}

TEST(Network, StartWithoutConfigurationIsRefusedWithAnEmergency) {
  test::TestModule robot;
  robot.boot();
  robot.command(NmtCommand::start);
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  const auto emergencies = robot.emergencies();
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0].code, canopen::EmergencyCode::not_configured);
  EXPECT_EQ(emergencies[0].detail, 0U);
  EXPECT_EQ(robot.it().pulse_count(), 0U);
}

TEST(Network, AnotherSenderOnAnOwnIdentifierStopsTheModuleUntilItsReset) {
  for (const std::uint16_t base :
       {canopen::identifier::emergency, canopen::identifier::state_frame, canopen::identifier::second_state,
        canopen::identifier::monitoring, canopen::identifier::sdo_answer, canopen::identifier::heartbeat}) {
    test::TestModule robot;
    robot.set_up_and_start();
    robot.enable(0);
    robot.run(5);
    ASSERT_TRUE(robot.it().is_pulsing());
    const auto identifier = static_cast<std::uint16_t>(base + node);
    robot.bus.deliver({identifier, 8, {}});
    robot.bus.deliver({identifier, 8, {}});
    robot.bus.run_for(1'000);
    EXPECT_FALSE(robot.it().is_pulsing());
    EXPECT_EQ(robot.module().state(), NmtState::stopped);
    std::vector<canopen::Emergency> own;
    for (const auto& sent : robot.bus.sent(canopen::identifier::emergency + node)) {
      if (sent.sender != test::TestBus::host) {
        own.push_back(*canopen::decode_emergency(sent.frame));
      }
    }
    ASSERT_EQ(own.size(), 1U) << std::hex << identifier;
    EXPECT_EQ(own[0], (canopen::Emergency{node, EmergencyCode::identifier_collision, 0x11, identifier}));

    const std::size_t pulses = robot.it().pulse_count();
    robot.command(NmtCommand::start);
    robot.command(NmtCommand::enter_pre_operational);
    robot.run(6, 10);
    EXPECT_EQ(robot.module().state(), NmtState::stopped);
    EXPECT_EQ(robot.it().pulse_count(), pulses);
    robot.command(NmtCommand::reset_node);
    robot.bus.run_for(20'000);
    EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  }
}

TEST(Network, ACollisionBeforeBootUpIsReportedAfterTheBootUpMessage) {
  test::TestModule robot;
  robot.it().power_on(robot.bus.now());
  robot.bus.deliver({canopen::identifier::heartbeat + node, 1, {0}});
  robot.bus.run_for(50'000);
  std::vector<CanFrame> own;
  for (const auto& sent : robot.bus.log) {
    if (sent.sender != test::TestBus::host) {
      own.push_back(sent.frame);
    }
  }
  ASSERT_EQ(own.size(), 2U);
  EXPECT_EQ(own[0], encode(canopen::Heartbeat{node, NmtState::boot_up}));
  EXPECT_EQ(own[1], encode(canopen::Emergency{node, EmergencyCode::identifier_collision, 0x11,
                                              canopen::identifier::heartbeat + node}));
  EXPECT_EQ(robot.module().state(), NmtState::stopped);
}

TEST(Network, TwoModulesWithOneNodeIdBothStop) {
  for (std::uint32_t id = 1; id < 40; ++id) {
    test::TestBus bus;
    test::ModuleNode& first = bus.add(identity(9, 0));
    test::ModuleNode& second = bus.add(identity(9, id), 55'555);
    first.power_on(0);
    second.power_on(0);
    if (first.next_deadline() == second.next_deadline()) {
      continue;  // their boot-up messages are one frame on the bus; answers to SDO would collide
    }
    bus.run_for(50'000);
    EXPECT_EQ(first.module.state(), NmtState::stopped);
    EXPECT_EQ(second.module.state(), NmtState::stopped);
    EXPECT_EQ(bus.emergencies(9).size(), 2U);
  }
}

}  // namespace
}  // namespace proleg
