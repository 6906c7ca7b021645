// A joint of a robot that moves loses its power.

#include "host/robot/power_watch.hpp"

#include <gtest/gtest.h>

#include <array>

#include "driving_host.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shipped.hpp"

namespace proleg::test {
namespace {

class PowerWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    bus.attach(watch);
    ASSERT_TRUE(host.start());
    watch.start(bus.now());
    ASSERT_TRUE(host.run_to_tick(100));
  }
  ~PowerWatchTest() override { bus.detach(watch); }

  bool finds_loss_within(Microseconds time) {
    return bus.run_until(bus.now() + time, [this] { return watch.loss().has_value(); });
  }

  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus{scenario};
  DrivingHost host{bus, scenario};
  host::PowerWatch watch{bus, {1, 2, 3, 4, 5}};
};

TEST_F(PowerWatchTest, FindsNothingWhileAllJointsFollow) { EXPECT_FALSE(finds_loss_within(5 * second)); }

TEST_F(PowerWatchTest, FindsAJointWhosePowerAnotherProgramTakesWithinASecond) {
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

TEST_F(PowerWatchTest, FindsAFaultByTheStateFrameWithinTwoTicks) {
  bus.robot().plant().jam(1, 3'000);  // mA; a fault after half a second
  EXPECT_FALSE(finds_loss_within(480'000));
  EXPECT_TRUE(finds_loss_within(150'000));
  ASSERT_TRUE(watch.loss());
  EXPECT_EQ(watch.loss()->node, 2U);
  EXPECT_EQ(watch.loss()->emergency, canopen::EmergencyCode::over_current);
}

TEST_F(PowerWatchTest, AModuleThatRestartsIsTheMastersUntilItMovesAgain) {
  bus.robot().module(2).power_on(bus.robot().now());
  EXPECT_FALSE(finds_loss_within(3 * second));
  watch.return_to_gait(3);
  EXPECT_FALSE(finds_loss_within(2 * second)) << "the master has set it up again";
}

TEST_F(PowerWatchTest, SendsNothingWhenItIsStopped) {
  watch.stop();
  bus.run_for(second / 4);
  const std::uint64_t before = bus.sent_frames();
  bus.run_for(2 * second);
  EXPECT_LE(bus.sent_frames() - before, 21U) << "heartbeats of the host";
}

}  // namespace
}  // namespace proleg::test
