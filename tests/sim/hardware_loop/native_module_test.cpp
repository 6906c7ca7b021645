// The module's program behind the simulator's controller: bus-off.

#include "sim/hardware_loop/native_module.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace proleg::sim {
namespace {

/// Receives frames, and so acknowledges them.
struct Host final : BusListener {
  explicit Host(Bus& bus) : controller(bus.attach(*this)) {}
  void received(BusTime time, const CanFrame& frame) override { frames.push_back({time, frame}); }
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override {}

  struct ReceivedFrame {
    BusTime time;
    CanFrame frame;
  };
  std::vector<ReceivedFrame> frames;
  Controller& controller;
};

class NativeModules : public testing::Test {
 protected:
  static constexpr std::uint8_t node = 5;
  static constexpr BusTime ms = 1'000'000;

  static firmware::ModuleIdentity identity() {
    firmware::ModuleIdentity made;
    made.node = node;
    return made;
  }
  void run_until(BusTime end) {
    for (BusTime next = 0; next <= end;) {
      bus.advance_to(next);
      while (module.next_event() <= bus.now()) {
        module.advance_to(bus.now(), bus.earliest_delivery());
      }
      next = std::min(bus.next_event(), module.next_event());
    }
    bus.advance_to(end);
  }

  Bus bus;
  Host host{bus};
  NativeModule module{bus, identity(), Crystal(), [] { return std::uint8_t{0}; }};
};

TEST_F(NativeModules, ReturnFromBusOffAndReportIt) {
  module.power_on(0);
  run_until(30 * ms);
  ASSERT_EQ(host.frames.size(), 1U) << "boot-up";
  // Heartbeats of 1 ms that are all destroyed end in bus-off.
  ASSERT_TRUE(host.controller.send({static_cast<std::uint16_t>(canopen::identifier::sdo_request + node),
                                    8,
                                    {0x2B, 0x17, 0x10, 0x00, 0x01, 0x00, 0x00, 0x00}}));
  run_until(32 * ms);
  bool destroy = true;
  bus.set_error_rule([&](const CanFrame& frame, std::uint64_t) { return destroy && frame.identifier > 0x700; });
  run_until(45 * ms);
  host.frames.clear();
  destroy = false;
  run_until(60 * ms);
  ASSERT_FALSE(host.frames.empty());
  const auto emergency = canopen::decode_emergency(host.frames[0].frame);
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->node, node);
  EXPECT_EQ(emergency->code, canopen::EmergencyCode::bus_off_recovered);
  // 10 ms of pause and 128 times 11 bits.
  EXPECT_EQ(emergency->detail, 11U);
  EXPECT_GT(host.frames.size(), 3U) << "heartbeats";
}

TEST_F(NativeModules, SendTheirBootUpMessageAfterALongFaultOfTheBus) {
  // Every transmission is destroyed.
  bus.set_error_rule([&](const CanFrame&, std::uint64_t) { return true; });
  module.power_on(0);
  run_until(3'000 * ms);
  EXPECT_TRUE(host.frames.empty());
  bus.set_error_rule({});
  run_until(5'000 * ms);
  ASSERT_EQ(host.frames.size(), 1U);
  EXPECT_EQ(canopen::decode_heartbeat(host.frames[0].frame), (canopen::Heartbeat{node, canopen::NmtState::boot_up}));
}

TEST_F(NativeModules, StartWhenTheirBootloaderHasCheckedTheImage) {
  constexpr BusTime start_time = 94 * ms;
  module.set_start_time(start_time / 1'000);
  for (const BusTime power_on : {BusTime{0}, 500 * ms}) {
    run_until(power_on);
    host.frames.clear();
    module.power_on(power_on);
    run_until(power_on + start_time + 17 * ms);
    ASSERT_EQ(host.frames.size(), 1U) << "boot-up, 1 to 16 ms after the start";
    EXPECT_GT(host.frames[0].time, power_on + start_time + ms);
  }
}

TEST_F(NativeModules, MeasureNothingWithoutASource) {
  module.power_on(0);
  run_until(100 * ms);
  EXPECT_EQ(module.last_tick().tick, firmware::TickRecord::none);
}

}  // namespace
}  // namespace proleg::sim
