// What a person who watches the bus sees of the modules, and what it costs the bus.

#include "host/robot/bus_monitor.hpp"

#include <gtest/gtest.h>

#include "host/robot/sdo_queue.hpp"
#include "live_bus.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shipped.hpp"

namespace proleg::test {
namespace {

using host::BusMonitor;
using host::MonitoredNode;

/// Counts the requests of a host for an object.
class RequestCount final : public host::BusUser {
 public:
  explicit RequestCount(canopen::Address address) : address_(address) {}
  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void requested(Microseconds /*now*/, const CanFrame& frame) override {
    const bool is_request = canopen::identifier::base_of(frame.identifier) == canopen::identifier::sdo_request;
    const auto index = static_cast<std::uint16_t>(frame.data.at(1) | frame.data.at(2) << 8U);
    count_ += is_request && index == address_.index && frame.data.at(3) == address_.sub ? 1U : 0U;
  }
  [[nodiscard]] unsigned count() const { return count_; }

 private:
  canopen::Address address_;
  unsigned count_ = 0;
};

class BusMonitorTest : public ::testing::Test {
 protected:
  BusMonitorTest() {
    bus.attach(monitor);
    bus.attach(requests);
  }
  void write_limit(std::uint8_t node, std::uint16_t limit_ma) {
    host::SdoQueue queue(bus);
    bus.attach(queue);
    queue.write(node, canopen::object::current_limit.address, canopen::object::current_limit.type, limit_ma, {});
    EXPECT_TRUE(bus.run_until(bus.now() + second, [&queue] { return queue.is_idle(); }));
    bus.detach(queue);
  }
  void expect_limits(std::uint16_t first, std::uint16_t others) {
    const std::vector<MonitoredNode> nodes = monitor.nodes();
    ASSERT_EQ(nodes.size(), 5U);
    for (const MonitoredNode& node : nodes) {
      EXPECT_EQ(node.current_limit, node.node == 1 ? first : others) << "node " << int{node.node};
    }
  }

  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus{scenario};
  BusMonitor monitor{bus};
  RequestCount requests{canopen::object::current_limit.address};
};

TEST_F(BusMonitorTest, ReadsTheLimitOfTheCurrentOnceFromEachModule) {
  bus.run_for(10 * second);
  expect_limits(2'000, 2'000);
  EXPECT_EQ(requests.count(), 5U);
}

TEST_F(BusMonitorTest, ReadsTheLimitsAgainWhenAsked) {
  bus.run_for(3 * second);
  write_limit(1, 700);
  bus.run_for(3 * second);
  expect_limits(2'000, 2'000);
  monitor.read_limits_again();
  bus.run_for(3 * second);
  expect_limits(700, 2'000);
}

TEST_F(BusMonitorTest, ReadsTheLimitAgainAfterTheRestartOfAModule) {
  bus.run_for(3 * second);
  write_limit(1, 700);
  monitor.read_limits_again();
  bus.run_for(3 * second);
  expect_limits(700, 2'000);
  bus.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 1}));
  bus.run_for(3 * second);
  expect_limits(2'000, 2'000);
}

TEST_F(BusMonitorTest, FindsTheLimitsAlthoughFramesAreLost) {
  bus.run_for(300'000);  // the modules have said that they are there
  ASSERT_EQ(requests.count(), 0U);
  bus.lose(0.3, 1);
  bus.run_for(10 * second);
  expect_limits(2'000, 2'000);
}

TEST_F(BusMonitorTest, ThePositionIsTheNewestThatWasReadOrMeasured) {
  bus.run_for(3 * second);
  ASSERT_EQ(monitor.nodes().front().position, 0) << "read from a module that stands";
  monitor.receive(bus.now(), canopen::encode(canopen::Monitoring{1, 0x2000, 100, 25, 0}));
  EXPECT_EQ(monitor.nodes().front().position, 1 << 29) << "45 degrees";
  monitor.receive(bus.now(), canopen::encode(canopen::Monitoring{1, canopen::Monitoring::not_measured, 100, 25, 0}));
  EXPECT_EQ(monitor.nodes().front().position, 1 << 29);
  bus.run_for(3 * second);
  EXPECT_EQ(monitor.nodes().front().position, 0) << "read again";
}

TEST_F(BusMonitorTest, ReadsNothingWhileTheBusBelongsToTheMaster) {
  monitor.set_reads(false);
  bus.run_for(3 * second);
  EXPECT_EQ(requests.count(), 0U);
  EXPECT_EQ(bus.sent_frames(), 0U);
}

TEST_F(BusMonitorTest, ReadsWhatOnlyMonitoringFramesHaveInOperation) {
  bus.run_for(2 * second);
  for (const MonitoredNode& node : monitor.nodes()) {
    EXPECT_EQ(node.temperature_c, 25) << "node " << int{node.node};
    EXPECT_TRUE(node.current_ma) << "node " << int{node.node};
    EXPECT_EQ(node.error_register, 0) << "node " << int{node.node};
    EXPECT_FALSE(node.contacts) << "touch sensors are read only if they are wanted";
  }
}

TEST_F(BusMonitorTest, ReadsTheTouchSensorsTenTimesASecondIfTheyAreWanted) {
  RequestCount touch{canopen::object::touch_sensors.address};
  bus.attach(touch);
  monitor.set_reads_touch(true);
  bus.run_for(10 * second);
  for (const MonitoredNode& node : monitor.nodes()) {
    EXPECT_TRUE(node.contacts) << "node " << int{node.node};
  }
  EXPECT_NEAR(touch.count(), 500, 60);
  monitor.set_reads(false);
  const unsigned before = touch.count();
  bus.run_for(2 * second);
  EXPECT_LE(touch.count(), before + 5);
  bus.detach(touch);
}

TEST_F(BusMonitorTest, AModuleThatHasBootedIsPreOperational) {
  bus.run_for(2 * second);
  monitor.receive(bus.now(), canopen::encode(canopen::Heartbeat{1, canopen::NmtState::operational}));
  EXPECT_EQ(monitor.nodes().front().state, canopen::NmtState::operational);
  monitor.receive(bus.now(), canopen::encode(canopen::Heartbeat{1, canopen::NmtState::boot_up}));
  EXPECT_EQ(monitor.nodes().front().state, canopen::NmtState::pre_operational);
}

TEST_F(BusMonitorTest, ForgetsNodesThatAreSilentOnlyWhenAsked) {
  bus.run_for(2 * second);
  monitor.forget_silent(bus.now());
  EXPECT_EQ(monitor.nodes().size(), 5U);
  monitor.forget_silent(bus.now() + 4 * second);
  EXPECT_TRUE(monitor.nodes().empty());
}

}  // namespace
}  // namespace proleg::test
