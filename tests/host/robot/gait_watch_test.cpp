// A joint of a robot that moves loses its power.

#include "host/robot/gait_watch.hpp"

#include <gtest/gtest.h>

#include <array>

#include "driving_host.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shipped.hpp"

namespace proleg::test {
namespace {

class GaitWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    bus.attach(watch);
    ASSERT_TRUE(host.start());
    watch.start(bus.now());
    ASSERT_TRUE(host.run_to_tick(100));
  }
  ~GaitWatchTest() override { bus.detach(watch); }

  bool finds_loss_within(Microseconds time) {
    return bus.run_until(bus.now() + time, [this] { return watch.loss().has_value(); });
  }

  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus{scenario};
  DrivingHost host{bus, scenario};
  host::GaitWatch watch{bus, {1, 2, 3, 4, 5}};
};

TEST_F(GaitWatchTest, FindsNothingWhileAllJointsFollow) { EXPECT_FALSE(finds_loss_within(5 * second)); }

TEST_F(GaitWatchTest, FindsAJointWhosePowerAnotherProgramTakesWithinASecond) {
  host::SdoQueue other(bus);
  bus.attach(other);
  other.write(4, canopen::object::controlword.address, std::array<std::uint8_t, 2>{0, 0}, {});
  EXPECT_TRUE(finds_loss_within(second));
  bus.detach(other);
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->node, 4U);
  EXPECT_EQ(watch.loss()->statusword & 0x4FU, 0x40U) << "Switch on disabled";
  EXPECT_EQ(watch.loss()->emergency, canopen::EmergencyCode::none);
}

TEST_F(GaitWatchTest, FindsAModeThatAnotherProgramHasSetWithinASecond) {
  host::SdoQueue other(bus);
  bus.attach(other);
  other.write(2, canopen::object::mode.address, std::array<std::uint8_t, 1>{8}, {});
  EXPECT_TRUE(finds_loss_within(second));
  bus.detach(other);
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->node, 2U);
  EXPECT_EQ(watch.loss()->reason, host::GaitWatch::Reason::mode);
  EXPECT_EQ(watch.loss()->mode, 8);
}

TEST_F(GaitWatchTest, KnowsWhichModeIsExpected) {
  host::SdoQueue other(bus);
  bus.attach(other);
  const auto set_mode = [&](std::int8_t mode) {
    watch.expect_mode(std::nullopt);
    for (std::uint8_t node = 1; node <= 5; ++node) {
      other.write(node, canopen::object::mode.address, canopen::DataType::integer8, static_cast<std::uint8_t>(mode),
                  {});
    }
    ASSERT_TRUE(bus.run_until(bus.now() + second, [&] { return other.is_idle(); }));
    watch.expect_mode(mode);
  };
  set_mode(canopen::mode_direct_position);
  EXPECT_FALSE(finds_loss_within(3 * second));
  EXPECT_TRUE(watch.statusword(5));
  EXPECT_FALSE(watch.statusword(6));
  set_mode(canopen::mode_gait);
  EXPECT_FALSE(finds_loss_within(3 * second));
  watch.expect_mode(canopen::mode_direct_position);
  EXPECT_TRUE(finds_loss_within(second));
  EXPECT_EQ(watch.loss()->reason, host::GaitWatch::Reason::mode);
  bus.detach(other);
}

TEST_F(GaitWatchTest, FindsAModuleThatIsStoppedWithinASecond) {
  ASSERT_TRUE(bus.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::stop, 3})));
  EXPECT_TRUE(finds_loss_within(second));
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->node, 3U);
  EXPECT_EQ(watch.loss()->reason, host::GaitWatch::Reason::network);
  EXPECT_EQ(watch.loss()->state, canopen::NmtState::stopped);
}

// A second SYNC producer: the modules lose their tick, and ramp to the safe pose.
TEST_F(GaitWatchTest, FindsJointsThatForeignSyncsHaveStoppedWithinASecond) {
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(bus.send({canopen::identifier::sync, 1, {5}}));
    bus.run_for(7'000);
  }
  EXPECT_TRUE(finds_loss_within(second));
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->reason, host::GaitWatch::Reason::drive);
  EXPECT_NE(watch.loss()->emergency, canopen::EmergencyCode::none);
}

TEST_F(GaitWatchTest, LooksAtAllJointsWhenItIsAskedTo) {
  watch.look_at_all();
  EXPECT_TRUE(bus.run_until(bus.now() + second / 10, [this] { return watch.has_looked(); }));
  EXPECT_FALSE(watch.loss());
}

TEST_F(GaitWatchTest, FindsAFaultByTheStateFrameWithinTwoTicks) {
  bus.robot().plant().jam(1, 3'000);  // mA; a fault after half a second
  EXPECT_FALSE(finds_loss_within(480'000));
  EXPECT_TRUE(finds_loss_within(150'000));
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->node, 2U);
  EXPECT_EQ(watch.loss()->emergency, canopen::EmergencyCode::over_current);
}

TEST_F(GaitWatchTest, AModuleThatRestartsIsTheMastersUntilItMovesAgain) {
  bus.robot().module(2).power_on(bus.robot().now());
  EXPECT_FALSE(finds_loss_within(3 * second));
  watch.return_to_gait(3);
  EXPECT_FALSE(finds_loss_within(2 * second)) << "the master has set it up again";
}

TEST_F(GaitWatchTest, SendsNothingWhenItIsStopped) {
  watch.stop();
  bus.run_for(second / 4);
  const std::uint64_t before = bus.sent_frames();
  bus.run_for(2 * second);
  EXPECT_LE(bus.sent_frames() - before, 21U) << "heartbeats of the host";
}

}  // namespace
}  // namespace proleg::test
