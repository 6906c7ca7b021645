// The lease of a module, object 0x2002, which says whose robot it is.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::NmtCommand;
using test::node;

class LeaseOfAModule : public testing::Test {
 protected:
  LeaseOfAModule() {
    robot.bus.host_is_alive = false;
    robot.boot();
  }

  AbortCode take(std::uint32_t token) { return robot.bus.write(node, object::session_token, token); }
  [[nodiscard]] std::uint32_t holder() { return robot.bus.value(node, object::session_token); }
  void heartbeat(std::uint8_t of = canopen::host_node) {
    robot.bus.deliver(encode(canopen::Heartbeat{of, canopen::NmtState::operational}));
  }

  test::TestModule robot;
};

TEST_F(LeaseOfAModule, IsFreeAtFirstAndBelongsToTheFirstWhoTakesIt) {
  EXPECT_EQ(holder(), 0U);
  EXPECT_EQ(take(0x12345678), AbortCode::none);
  EXPECT_EQ(holder(), 0x12345678U);
  EXPECT_EQ(take(0x87654321), AbortCode::refused_by_state);
  EXPECT_EQ(holder(), 0x12345678U);
  EXPECT_EQ(take(0x12345678), AbortCode::none) << "its holder takes it again";
}

TEST_F(LeaseOfAModule, IsNotReleasedByAWriteOfZero) {
  EXPECT_EQ(take(0), AbortCode::none) << "no host has it";
  ASSERT_EQ(take(7), AbortCode::none);
  EXPECT_EQ(take(0), AbortCode::refused_by_state);
  EXPECT_EQ(holder(), 7U);
}

TEST_F(LeaseOfAModule, EndsHalfASecondAfterTheLastHeartbeatOfTheHost) {
  ASSERT_EQ(take(7), AbortCode::none);
  for (unsigned i = 0; i < 20; ++i) {
    robot.bus.run_for(100'000);
    heartbeat();
  }
  robot.bus.run_for(490'000);
  EXPECT_EQ(take(8), AbortCode::refused_by_state);
  robot.bus.run_for(20'000);
  EXPECT_EQ(holder(), 0U);
  EXPECT_EQ(take(8), AbortCode::none);
}

TEST_F(LeaseOfAModule, EndsWithoutAnyHeartbeatAndNotThroughThoseOfModules) {
  ASSERT_EQ(take(7), AbortCode::none);
  for (unsigned i = 0; i < 6; ++i) {
    robot.bus.run_for(100'000);
    heartbeat(9);
  }
  EXPECT_EQ(holder(), 0U);
}

TEST_F(LeaseOfAModule, EndsWithAResetOfTheNodeAndNotWithOneOfItsCommunication) {
  ASSERT_EQ(take(7), AbortCode::none);
  robot.command(NmtCommand::reset_communication);
  robot.bus.run_for(20'000);
  EXPECT_EQ(holder(), 7U);
  robot.command(NmtCommand::reset_node);
  robot.bus.run_for(20'000);
  EXPECT_EQ(holder(), 0U);
}

}  // namespace
}  // namespace proleg
