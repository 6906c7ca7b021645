// The checksum of a joint's set-points: object 0x200D.

#include "shared/fixed/crc32.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::NmtCommand;
using test::node;

class SetpointChecksum : public testing::Test {
 protected:
  SetpointChecksum() { robot.set_up_and_start(); }

  /// Runs ticks until `last`, and computes the expected checksum: each set-point is read from the kernel, byte by byte.
  void run(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t tick = first; tick <= last; ++tick) {
      robot.sync(tick);
      note_setpoint();
      robot.bus.run_for(5'000);
    }
  }
  void note_setpoint() {
    const auto setpoint = static_cast<std::uint32_t>(robot.kernel().setpoint(0));
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(setpoint >> shift));
    }
  }
  [[nodiscard]] std::uint32_t ticks() { return robot.bus.value(node, object::setpoint_ticks); }
  [[nodiscard]] std::uint32_t crc() { return robot.bus.value(node, object::setpoint_crc); }
  void take() { ASSERT_EQ(robot.bus.write(node, object::setpoint_ticks, 0), AbortCode::none); }
  void expect_all(std::uint32_t count) {
    take();
    EXPECT_EQ(ticks(), count);
    EXPECT_EQ(crc(), crc32(bytes));
  }

  test::TestModule robot;
  std::vector<std::uint8_t> bytes;
};

TEST_F(SetpointChecksum, IsZeroBeforeTheFirstTick) {
  expect_all(0);
  EXPECT_EQ(crc(), 0U);
}

TEST_F(SetpointChecksum, CountsEverySetpointFromTickZeroOn) {
  robot.tick(0);
  run(0, 0);
  expect_all(1);
  run(1, 249);
  expect_all(250);
  EXPECT_EQ(bytes.size(), 1'000U);
}

TEST_F(SetpointChecksum, StaysAsItWasTakenWhileTheRobotMoves) {
  robot.tick(0);
  run(0, 9);
  take();
  const std::uint32_t before = crc32(bytes);
  run(10, 19);
  EXPECT_EQ(ticks(), 10U);
  EXPECT_EQ(crc(), before);
  expect_all(20);
}

TEST_F(SetpointChecksum, IncludesTicksWhoseSyncWasMissed) {
  robot.tick(0);
  run(0, 9);
  test::TestModule other;
  other.set_up_and_start();
  other.run(19);
  for (const std::uint32_t tick : {14U, 19U}) {
    robot.sync(tick);
  }
  take();
  EXPECT_EQ(ticks(), 20U);
  ASSERT_EQ(other.bus.write(node, object::setpoint_ticks, 0), AbortCode::none);
  EXPECT_EQ(crc(), other.bus.value(node, object::setpoint_crc)) << "the plain sine needs no SYNC";
}

TEST_F(SetpointChecksum, BeginsAgainWithTheTick) {
  robot.tick(0);
  run(0, 9);
  robot.command(NmtCommand::enter_pre_operational);
  EXPECT_EQ(ticks(), 0U);
  bytes.clear();
  robot.command(NmtCommand::start);
  robot.bus.run_for(10'000);
  robot.tick(0);
  run(0, 4);
  expect_all(5);
}

TEST_F(SetpointChecksum, OfAModuleThatJoinsIsNotValid) {
  robot.tick(300);
  robot.sync(300);
  robot.bus.run_for(5'000);
  run(301, 310);
  ASSERT_TRUE(robot.module().synchronised());
  take();
  EXPECT_EQ(ticks(), 0U);
  EXPECT_EQ(crc(), 0U);
}

TEST_F(SetpointChecksum, IsOnlyTakenByAZero) {
  EXPECT_EQ(robot.bus.write(node, object::setpoint_ticks, 1), AbortCode::above_maximum);
  EXPECT_NE(robot.bus.write(node, object::setpoint_crc, 0), AbortCode::none);
}

}  // namespace
}  // namespace proleg
