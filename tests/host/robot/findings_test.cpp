// What is said of observations and of the way to a bus: the code of the first finding, the nodes, and commands that a
// person can type.

#include "host/robot/findings.hpp"

#include <gtest/gtest.h>

#include "shared/canopen/declared_objects.hpp"

namespace proleg::host {
namespace {

using canopen::EmergencyCode;
using canopen::NmtState;

constexpr std::uint32_t core = 0x12345678;

/// A module that waits, as a healthy one is seen.
ObservedNode module_at(std::uint8_t node) {
  ObservedNode seen;
  seen.node = node;
  seen.answers = ScannedNode{};
  seen.answers->node = node;
  seen.answers->has_answered = true;
  seen.answers->is_module = true;
  seen.answers->serial = 0x1000U + node;
  seen.answers->protocol = canopen::protocol_version;
  seen.answers->core_fingerprint = core;
  seen.answers->statusword = 0x40;  // switch on disabled
  return seen;
}

/// A bus with two modules that wait.
BusObservations healthy() {
  BusObservations seen;
  seen.listened_us = 1'000'000;
  seen.was_asked = true;
  seen.is_complete = true;
  seen.nodes = {module_at(1), module_at(2)};
  seen.own.state.is_connected = true;
  seen.own.statistics.received = 100;
  seen.own.statistics.transmitted = 300;
  return seen;
}

std::vector<Finding> findings(const BusObservations& seen, const std::string& bus = "can0") {
  return find_bus_faults(seen, parse_bus_address(bus), {core});
}
std::string_view first_code(const BusObservations& seen) {
  const auto found = findings(seen);
  return found.empty() ? "none" : found.front().code;
}

TEST(BusFindings, AreNoneOfAHealthyBus) { EXPECT_EQ(first_code(healthy()), "none"); }

TEST(BusFindings, ADeadBusHasOneFinding) {
  BusObservations seen = healthy();
  seen.nodes.clear();
  seen.own.statistics = {};
  EXPECT_EQ(first_code(seen), "no_acknowledgement");
  seen.own.statistics.transmitted = 300;
  EXPECT_EQ(first_code(seen), "nobody_answers") << "an adapter that confirms nothing, or a virtual interface";
  seen.own.state.errors.add(CanErrorKind::acknowledgement);
  EXPECT_EQ(first_code(seen), "no_acknowledgement") << "an adapter that confirms what it took";
  seen.own.state.controller.receive_errors = 8;
  EXPECT_EQ(first_code(seen), "wrong_bit_rate") << "the driver of the adapter does not say which errors";
  seen.own.state.controller.receive_errors = 0;
  seen.own.state.errors.add(CanErrorKind::stuff);
  seen.worst_controller_state = CanState::bus_off;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "wrong_bit_rate");
  EXPECT_NE(found.front().what.find("bus-off"), std::string::npos);
  EXPECT_NE(found.front().to_do.find("sudo ip link set can0 down"), std::string::npos)
      << "it does not return by itself";
  EXPECT_EQ(findings(seen, "tcp:localhost:1").front().to_do.find("ip link"), std::string::npos);
}

TEST(BusFindings, LinesThatAreNotUnderstoodAreShownInsteadOfADeadBus) {
  BusObservations seen = healthy();
  seen.nodes.clear();
  seen.own.statistics = {};
  seen.own.statistics.malformed = 1;
  seen.own.statistics.malformed_line = "'t1812AABB123'";
  const auto found = findings(seen, "serial:/dev/ttyUSB0@115200");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "damaged_lines");
  EXPECT_NE(found.front().what.find("'t1812AABB123'"), std::string::npos);
  EXPECT_NE(found.front().to_do.find("baud rate"), std::string::npos);
}

TEST(BusFindings, SomeLinesAtTheOpeningMayBeTheRestOfOtherOutput) {
  BusObservations seen = healthy();
  seen.own.statistics.malformed = 2;
  EXPECT_EQ(first_code(seen), "none");
  seen.own.statistics.malformed = 3;
  EXPECT_EQ(first_code(seen), "damaged_lines");
}

TEST(BusFindings, ALostConnectionHidesAllElse) {
  BusObservations seen = healthy();
  seen.own.state.is_connected = false;
  seen.own.state.reason = "the line is gone";
  seen.nodes[0].boot_ups = 5;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "connection_lost");
  EXPECT_NE(found.front().what.find("the line is gone"), std::string::npos);
}

TEST(BusFindings, ErrorsOfAPlugThatWasJustPutInAreNone) {
  BusObservations seen = healthy();
  seen.frames = 700;
  seen.errors = 2;
  EXPECT_EQ(first_code(seen), "none");
  seen.errors = 3;
  EXPECT_EQ(first_code(seen), "damaged_frames");
}

TEST(BusFindings, AFullBusNamesTheNodeThatFillsIt) {
  BusObservations seen = healthy();
  seen.load = 0.5;
  EXPECT_EQ(first_code(seen), "none");
  seen.busiest_load = 0.4;
  seen.busiest_identifier = 0x189;
  auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "bus_overload");
  EXPECT_EQ(found.front().nodes, std::vector<std::uint8_t>{9});
  seen.busiest_identifier = 0x123;
  found = findings(seen);
  EXPECT_TRUE(found.front().nodes.empty()) << "the identifier does not say it";
  seen.busiest_load = 0.1;
  seen.load = 0.9;
  EXPECT_EQ(first_code(seen), "bus_overload");
}

TEST(BusFindings, OneNodeIdOfSeveralModules) {
  BusObservations seen = healthy();
  seen.silent_modules = {{0xAAAA, 5}};
  EXPECT_EQ(first_code(seen), "stopped_module");
  seen.silent_modules = {{0xAAAA, 5}, {0xBBBB, 5}};
  EXPECT_EQ(first_code(seen), "duplicate_node_id") << "both have stopped";
  seen.silent_modules = {{0xAAAA, 2}};
  EXPECT_EQ(first_code(seen), "duplicate_node_id") << "one has stopped, the other one answers";
  seen.nodes[1].answers->serial = 0;
  EXPECT_EQ(first_code(seen), "none") << "its serial number was not read: it may be the same module";
  seen.silent_modules.clear();
  seen.nodes[1].emergencies = {EmergencyCode::identifier_collision};
  seen.nodes[1].boot_ups = 2;
  seen.nodes[1].answers.reset();
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U) << "that two modules boot with one node id is no restart";
  EXPECT_EQ(found.front().code, "duplicate_node_id");
  EXPECT_EQ(found.front().nodes, std::vector<std::uint8_t>{2});
}

TEST(BusFindings, OneHostIsRight) {
  BusObservations seen = healthy();
  seen.host_heartbeats = 11;
  EXPECT_EQ(first_code(seen), "none");
  seen.host_heartbeats = 20;
  EXPECT_EQ(first_code(seen), "two_hosts");
  seen.listened_us = 2'000'000;
  EXPECT_EQ(first_code(seen), "none");
}

TEST(BusFindings, OneProducerOfSyncIsRightAlsoIfFramesAreLost) {
  BusObservations seen = healthy();
  seen.nodes[0].produces_sync = true;
  seen.syncs = 100;
  seen.sync_jumps = 10;
  EXPECT_EQ(first_code(seen), "none");
  seen.sync_jumps = 90;
  EXPECT_EQ(first_code(seen), "two_sync_producers");
  seen.sync_jumps = 0;
  seen.foreign_syncs = 1;
  EXPECT_EQ(first_code(seen), "two_sync_producers");
  seen.foreign_syncs = 0;
  seen.nodes[1].produces_sync = true;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().nodes, (std::vector<std::uint8_t>{1, 2}));
}

TEST(BusFindings, AQuickStopIsAConsequence) {
  BusObservations seen = healthy();
  for (ObservedNode& node : seen.nodes) {
    node.answers->statusword = 0x07;
    node.past_errors = {EmergencyCode::heartbeat_lost};
  }
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "quick_stop");
  EXPECT_NE(found.front().what.find("heartbeat of the host lost"), std::string::npos);
  seen.nodes[0].state = NmtState::operational;
  EXPECT_EQ(findings(seen).size(), 1U);
  EXPECT_EQ(first_code(seen), "sync_missing");
}

TEST(BusFindings, AFaultHasTheCauseThatIsPresentElseTheLastOne) {
  BusObservations seen = healthy();
  seen.nodes[1].answers->statusword = 0x08;
  EXPECT_EQ(first_code(seen), "drive_fault");
  seen.nodes[1].past_errors = {EmergencyCode::sync_lost, EmergencyCode::supply_low, EmergencyCode::over_current};
  EXPECT_EQ(first_code(seen), "supply_low");
  for (const auto& [bit, code] :
       {std::pair{2U, "over_current"}, {4U, "supply_low"}, {8U, "over_temperature"}, {32U, "sensors_failed"}}) {
    seen.nodes[1].answers->error_register = static_cast<std::uint8_t>(bit | 1U);
    EXPECT_EQ(first_code(seen), code);
    EXPECT_EQ(findings(seen).front().nodes, std::vector<std::uint8_t>{2});
  }
  seen.nodes[0].answers->statusword = 0x08;
  seen.nodes[0].answers->error_register = 2;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 2U) << "one for each cause";
  EXPECT_EQ(found[0].code, "over_current");
  EXPECT_EQ(found[1].code, "sensors_failed");
}

TEST(BusFindings, SettingsOfALaterProgramAreNamedWhileTheyLast) {
  BusObservations seen = healthy();
  seen.nodes[1].past_errors = {EmergencyCode::newer_settings};
  EXPECT_EQ(first_code(seen), "none") << "an error that is over";
  seen.nodes[1].answers->error_register = 0x81;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "newer_settings");
  EXPECT_EQ(found.front().nodes, std::vector<std::uint8_t>{2});
  EXPECT_NE(found.front().to_do.find("proleg recover --reset-settings"), std::string::npos);
}

TEST(BusFindings, AModuleWithoutBrownOutResetIsNamed) {
  BusObservations seen = healthy();
  seen.nodes[0].has_brown_out_reset = false;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "no_brown_out_reset");
  EXPECT_EQ(found.front().nodes, std::vector<std::uint8_t>{1});
  EXPECT_NE(found.front().to_do.find("proleg flash --bare --probe stlink"), std::string::npos);
}

TEST(BusFindings, AModuleThatWasNotReadHasNoForeignCore) {
  BusObservations seen = healthy();
  seen.nodes[0].answers->core_fingerprint = 0;
  EXPECT_EQ(first_code(seen), "none");
  seen.nodes[0].answers->core_fingerprint = core + 1;
  EXPECT_EQ(first_code(seen), "other_core");
  seen.nodes[0].answers->protocol = 0x0200;
  const auto found = findings(seen);
  ASSERT_EQ(found.size(), 1U) << "another protocol explains another core";
  EXPECT_EQ(found.front().code, "other_protocol");
}

TEST(BusFindings, ANodeThatIsOnlyReceived) {
  BusObservations seen = healthy();
  seen.nodes[1].answers.reset();
  seen.nodes[1].state = NmtState::pre_operational;
  EXPECT_EQ(first_code(seen), "no_answer");
  seen.is_complete = false;
  EXPECT_EQ(first_code(seen), "none") << "the questions did not end";
}

TEST(BusFindings, WhatNothingElseExplainsIsReported) {
  BusObservations seen = healthy();
  seen.nodes[0].emergencies = {EmergencyCode::rejoined};
  EXPECT_EQ(first_code(seen), "none") << "that is no fault";
  seen.nodes[0].emergencies = {EmergencyCode::frames_lost};
  EXPECT_EQ(first_code(seen), "module_report");
  seen.has_fresh_modules = true;
  EXPECT_EQ(findings(seen).size(), 1U);
  EXPECT_EQ(first_code(seen), "module_without_node_id");
}

TEST(BusFindings, ABusWithoutAModule) {
  BusObservations seen = healthy();
  for (ObservedNode& node : seen.nodes) {
    node.answers->is_module = false;
  }
  EXPECT_EQ(first_code(seen), "no_module") << "devices of others only";
  seen.nodes.clear();
  EXPECT_EQ(first_code(seen), "no_module") << "a host, for example";
}

TEST(BusFindings, EverySentenceBeginsWithACapitalLetterAndEndsWithAFullStop) {
  BusObservations seen = healthy();
  seen.nodes[0].boot_ups = 3;
  seen.nodes[1].answers->statusword = 0x08;
  seen.nodes[1].answers->core_fingerprint = core + 1;
  seen.has_fresh_modules = true;
  const auto found = findings(seen);
  EXPECT_EQ(found.size(), 4U);
  for (const Finding& finding : found) {
    EXPECT_TRUE(finding.what.front() >= 'A' && finding.what.front() <= 'Z') << finding.what;
    EXPECT_EQ(finding.what.back(), '.') << finding.what;
  }
}

// The way to the bus.

ConnectionFacts interface_facts() {
  ConnectionFacts facts;
  facts.address = parse_bus_address("can0");
  facts.can = CanInterface{.kind = "can",
                           .is_can = true,
                           .is_up = true,
                           .queue_length = 1000,
                           .bit_rate = 1'000'000,
                           .restart_ms = 0,
                           .is_listen_only = false,
                           .state = CanState::error_active,
                           .transmit_errors = 0,
                           .receive_errors = 0};
  return facts;
}
std::string_view first_code(const ConnectionFacts& facts) {
  const auto found = find_connection_faults(facts);
  return found.empty() ? "none" : found.front().code;
}

TEST(ConnectionFindings, OfACanInterface) {
  EXPECT_EQ(first_code(interface_facts()), "none");
  ConnectionFacts facts = interface_facts();
  facts.can->bit_rate = 500'000;
  EXPECT_EQ(first_code(facts), "interface_bit_rate");
  EXPECT_TRUE(blocks(find_connection_faults(facts).front())) << "requests would destroy the frames of the robot";
  facts = interface_facts();
  facts.can->is_listen_only = true;
  EXPECT_EQ(first_code(facts), "listen_only");
  facts = interface_facts();
  facts.can->state = CanState::bus_off;
  EXPECT_EQ(first_code(facts), "bus_off");
  facts.can->restart_ms = 100;
  EXPECT_EQ(first_code(facts), "none") << "it returns by itself";
  facts = interface_facts();
  facts.can->is_up = false;
  facts.can->bit_rate.reset();
  EXPECT_EQ(first_code(facts), "interface_down");
  EXPECT_EQ(find_connection_faults(facts).front().to_do, "sudo ip link set can0 up type can bitrate 1000000");
  facts.can->kind = "vcan";
  EXPECT_EQ(find_connection_faults(facts).front().to_do, "sudo ip link set can0 up");
  facts.can->is_can = false;
  EXPECT_EQ(first_code(facts), "wrong_kind");
}

TEST(ConnectionFindings, AShortQueueDoesNotKeepTheBusFromBeingExamined) {
  ConnectionFacts facts = interface_facts();
  facts.can->queue_length = 10;  // the kernel's default
  const auto found = find_connection_faults(facts);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().code, "short_queue");
  EXPECT_EQ(found.front().to_do, "sudo ip link set can0 txqueuelen 1000");
  EXPECT_FALSE(blocks(found.front()));
  facts.can->queue_length = 128;  // host/udev/70-proleg.rules
  EXPECT_EQ(first_code(facts), "none");
}

TEST(ConnectionFindings, OfASerialDevice) {
  ConnectionFacts facts;
  facts.address = parse_bus_address("serial:/dev/ttyUSB0");
  facts.serial = SerialDevice{true, true, true, "dialout", true, {}};
  EXPECT_EQ(first_code(facts), "none");
  facts.serial->may_use = false;
  facts.serial->is_user_in_group = false;
  const Finding rights = find_connection_faults(facts).front();
  EXPECT_EQ(rights.code, "no_rights");
  EXPECT_NE(rights.to_do.find("sudo usermod -aG dialout $USER"), std::string::npos);
  EXPECT_NE(rights.to_do.find("70-proleg.rules (docs/installing.md)"), std::string::npos);
  facts.serial->exists = false;
  EXPECT_EQ(first_code(facts), "no_device");
  facts.serial = SerialDevice{true, false, true, "root", false, {}};
  EXPECT_EQ(first_code(facts), "wrong_kind") << "a file";
}

TEST(ConnectionFindings, OfABusThatCannotBeOpened) {
  ConnectionFacts facts;
  facts.address = parse_bus_address("serial:/dev/ttyUSB0");
  facts.serial = SerialDevice{true, true, true, "dialout", true, {"ModemManager (process 812)"}};
  for (const auto& [problem, code] : {std::pair{TransportProblem::no_kernel_support, "kernel_without_can"},
                                      {TransportProblem::missing, "no_device"},
                                      {TransportProblem::wrong_kind, "wrong_kind"},
                                      {TransportProblem::no_rights, "no_rights"},
                                      {TransportProblem::in_use, "device_in_use"},
                                      {TransportProblem::no_answer, "adapter_silent"},
                                      {TransportProblem::not_slcan, "adapter_not_slcan"},
                                      {TransportProblem::no_bit_rate, "adapter_refuses"},
                                      {TransportProblem::other, "bus_not_reached"}}) {
    facts.failure = {problem, "serial:/dev/ttyUSB0@1000000: something"};
    const auto found = find_connection_faults(facts);
    ASSERT_EQ(found.size(), 1U) << code;
    EXPECT_EQ(found.front().code, code);
    EXPECT_FALSE(found.front().to_do.empty());
    EXPECT_TRUE(blocks(found.front()));
  }
  facts.failure->problem = TransportProblem::in_use;
  EXPECT_NE(find_connection_faults(facts).front().what.find("ModemManager (process 812)"), std::string::npos);
}

}  // namespace
}  // namespace proleg::host
