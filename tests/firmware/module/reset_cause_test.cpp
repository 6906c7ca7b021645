// A module whose program did not end as it should reports that, once.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::Emergency;
using canopen::EmergencyCode;
using firmware::ResetCause;

constexpr std::uint8_t restarted_node = 3;

std::vector<CanFrame> frames_after_power_on(ResetCause cause, std::uint32_t detail = 0) {
  test::TestBus bus;
  firmware::ModuleIdentity identity;
  identity.node = restarted_node;
  identity.reset_cause = cause;
  identity.reset_detail = detail;
  bus.add(identity).power_on(0);
  bus.run_until(50'000);
  std::vector<CanFrame> frames;
  for (const test::TestBus::Sent& sent : bus.log) {
    frames.push_back(sent.frame);
  }
  return frames;
}

const CanFrame boot_up_message = encode(canopen::Heartbeat{restarted_node, canopen::NmtState::boot_up});

TEST(ResetCauses, OfEverydayLifeAreNotWorthAMessage) {
  for (const ResetCause cause : {ResetCause::power_on, ResetCause::pin, ResetCause::software}) {
    EXPECT_EQ(frames_after_power_on(cause), std::vector{boot_up_message});
  }
}

TEST(ResetCauses, WatchdogFaultAndClockFailureFollowTheBootUpMessage) {
  // Codes of CiA 301, table 26, and IEC 61800-7-201: 6010 software reset (watchdog), 6100 internal software.
  EXPECT_EQ(frames_after_power_on(ResetCause::watchdog),
            (std::vector{boot_up_message, CanFrame{0x083, 8, {0x10, 0x60, 0, 0, 0, 0, 0, 0}}}));
  EXPECT_EQ(frames_after_power_on(ResetCause::fault, 0x08001234),
            (std::vector{boot_up_message, CanFrame{0x083, 8, {0x00, 0x61, 0, 0x34, 0x12, 0x00, 0x08, 0}}}));
  // CiA 402: 5220 computing circuit.
  EXPECT_EQ(frames_after_power_on(ResetCause::clock, 0x08001234),
            (std::vector{boot_up_message, CanFrame{0x083, 8, {0x20, 0x52, 0, 0x34, 0x12, 0x00, 0x08, 0}}}));
}

TEST(ResetCauses, AreNotReportedAgainWhenTheHostResetsTheModule) {
  for (const auto command : {canopen::NmtCommand::reset_node, canopen::NmtCommand::reset_communication}) {
    test::TestBus bus;
    firmware::ModuleIdentity identity;
    identity.node = restarted_node;
    identity.reset_cause = ResetCause::watchdog;
    bus.add(identity).power_on(0);
    bus.run_until(50'000);
    EXPECT_EQ(bus.emergencies(restarted_node),
              (std::vector{Emergency{restarted_node, EmergencyCode::watchdog_reset, 0, 0}}));
    bus.deliver(encode(canopen::NmtRequest{command, 0}));
    bus.run_for(50'000);
    EXPECT_EQ(bus.sent(canopen::identifier::heartbeat + restarted_node).size(), 2U) << "boot-up again";
    EXPECT_EQ(bus.emergencies(restarted_node).size(), 1U);
  }
}

TEST(ResetCauses, ANewResetIsReportedAgain) {
  test::TestBus bus;
  firmware::ModuleIdentity identity;
  identity.node = restarted_node;
  identity.reset_cause = ResetCause::watchdog;
  test::ModuleNode& module = bus.add(identity);
  for (const std::size_t count : {1U, 2U}) {
    module.power_on(bus.now());
    bus.run_for(50'000);
    EXPECT_EQ(bus.emergencies(restarted_node).size(), count);
  }
}

}  // namespace
}  // namespace proleg
