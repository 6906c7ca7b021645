// The measurements of a module, on the bus and in its objects.

#include <random>

#include "shared/canopen/robot_configuration.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::Monitoring;

ServoReadings example() { return {350, test::degrees(44.9), 31}; }

/// One module, joint 0, on a board with or without a potentiometer.
class Measuring {
 public:
  static constexpr std::uint8_t node = 3;

  explicit Measuring(bool measures_angle) {
    setup.kernel = test::one_slot(test::algorithm(test::sinusoidal), 1);
    setup.nodes = nodes_;
    setup.limits = limits_;
    firmware::ModuleIdentity identity;
    identity.node = node;
    identity.capabilities = measures_angle ? canopen::measures_angle : 0;
    it = &bus.add(identity);
    it->power_on(0);
    bus.run_until(20'000);
    const canopen::SetupList list(setup, 0);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const canopen::SdoRequest write = list.at(i);
      EXPECT_EQ(bus.write(node, write.address, write.size, write.value), canopen::AbortCode::none);
    }
    bus.deliver(encode(canopen::NmtRequest{canopen::NmtCommand::start, 0}));
  }
  /// The first monitoring frame, that of SYNC 0.
  CanFrame first_frame() {
    bus.deliver(encode(canopen::TickMessage{0, canopen::configuration_crc(setup)}));
    bus.deliver(canopen::encode_sync(0));
    bus.run_for(2'000);
    const auto sent = bus.sent(canopen::identifier::monitoring + node);
    EXPECT_EQ(sent.size(), 1U);
    return sent.empty() ? CanFrame{} : sent[0].frame;
  }

  test::TestBus bus;
  canopen::RobotSetup setup;
  test::ModuleNode* it = nullptr;

 private:
  std::array<std::uint8_t, 1> nodes_{node};
  std::array<AngleLimits, 1> limits_{{{-quarter_turn, quarter_turn}}};
};

TEST(Monitored, IsTheDocumentedFrame) {
  Measuring module(true);
  module.it->meters.readings = example();
  EXPECT_EQ(module.first_frame(), (CanFrame{0x383, 6, {0xEE, 0x1F, 0x5E, 0x01, 0x1F, 0x00}}));
}

TEST(Monitored, AnAngleThatIsNotMeasuredIsMarked) {
  Measuring without_potentiometer(false);
  without_potentiometer.it->meters.readings = example();
  const CanFrame expected{0x383, 6, {0x00, 0x80, 0x5E, 0x01, 0x1F, 0x00}};
  EXPECT_EQ(without_potentiometer.first_frame(), expected) << "the reading of such a board is noise";
  EXPECT_EQ(canopen::decode_monitoring(expected)->angle, Monitoring::not_measured);
  Measuring without_reading(true);
  without_reading.it->meters.readings = example();
  without_reading.it->meters.readings.angle.reset();
  EXPECT_EQ(without_reading.first_frame(), expected);
}

TEST(Monitored, FaultsAreTheErrorRegister) {
  Measuring module(true);
  module.bus.deliver(encode(canopen::TickMessage{0, 0xBAD}));  // this TICK belongs to another configuration
  EXPECT_EQ(module.first_frame().data[5], 0x00) << "over by the time of SYNC";
  ASSERT_EQ(module.bus.write(Measuring::node, object::current_limit_time, 0), canopen::AbortCode::none);
  module.it->meters.readings.current_ma = 2'001;
  for (std::uint32_t k = 1; k <= 10; ++k) {
    module.bus.run_for(9'000);
    module.bus.deliver(canopen::encode_sync(k));
  }
  module.bus.run_for(2'000);
  EXPECT_EQ(module.bus.sent(canopen::identifier::monitoring + Measuring::node).back().frame.data[5], 0x03);
}

TEST(Monitored, ObjectsHaveTheSameValues) {
  for (const bool measured : {true, false}) {
    Measuring module(measured);
    module.it->meters.readings = {350, -test::degrees(44.9), -7};
    static_cast<void>(module.first_frame());
    const auto value = [&](const canopen::Object& entry) { return module.bus.value(Measuring::node, entry); };
    EXPECT_EQ(value(object::capabilities), measured ? 1U : 0U);
    EXPECT_EQ(value(object::actual_position),
              measured ? static_cast<std::uint32_t>(-test::degrees(44.9)) : 0x80000000U);
    EXPECT_EQ(static_cast<std::int16_t>(value(object::measured_angle)), measured ? -8174 : -32768);
    EXPECT_EQ(value(object::rated_current), 1'000U);
    EXPECT_EQ(value(object::actual_current), 350U);
    EXPECT_EQ(static_cast<std::int8_t>(value(object::temperature)), -7);
    EXPECT_EQ(value(object::monitoring_transmission_type), 10U);
    module.it->meters.readings.current_ma = 0xFFFF;
    module.bus.run_for(20'000);
    EXPECT_EQ(value(object::actual_current), 0x7FFFU) << "CiA 402 has 16 bits with a sign";
  }
}

TEST(Monitored, IsMeasuredBeforeTheSetUpToo) {
  test::TestBus bus;
  firmware::ModuleIdentity identity;
  identity.node = 3;
  bus.add(identity).meters.readings = example();
  bus.nodes[0]->power_on(0);
  bus.run_until(40'000);
  EXPECT_EQ(bus.value(3, object::temperature), 31U);
}

/// Ticks in which a joint has sent its monitoring frames, during SYNCs 0 to `last`.
std::vector<std::uint32_t> monitored_ticks(test::TestRobot& robot, unsigned joint) {
  std::vector<std::uint32_t> ticks;
  std::uint32_t tick = ~0U;
  bool state_sent = false;
  for (const test::TestBus::Sent& sent : robot.bus.log) {
    if (test::is_sync(sent.frame)) {
      ++tick;
      state_sent = false;
    } else if (sent.frame.identifier == canopen::identifier::state_frame + robot.node(joint)) {
      state_sent = true;
    } else if (sent.frame.identifier == canopen::identifier::monitoring + robot.node(joint)) {
      EXPECT_TRUE(state_sent) << "after the state frame of its tick";
      ticks.push_back(tick);
    }
  }
  return ticks;
}

TEST(Monitored, EveryTenthSyncJointAfterJoint) {
  test::TestRobot robot(test::one_slot(test::algorithm(test::coupled), 5));
  robot.drive();
  robot.run_to(42);
  robot.bus.run_for(5'000);
  for (unsigned joint = 0; joint < robot.joints(); ++joint) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t tick = joint; tick <= 42; tick += 10) {
      expected.push_back(tick);
    }
    std::vector<std::uint32_t> found = monitored_ticks(robot, joint);
    std::erase_if(found, [](std::uint32_t tick) { return tick > 42; });
    EXPECT_EQ(found, expected) << "joint " << joint;
  }
}

TEST(Monitored, InOperationalOnly) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.run(10);
  robot.command(canopen::NmtCommand::enter_pre_operational);
  const std::size_t before = robot.bus.log.size();
  robot.run(11, 40);
  EXPECT_TRUE(robot.bus.sent(canopen::identifier::monitoring + test::TestModule::node_id, before).empty());
}

TEST(Monitored, OfAMissedSyncIsNotSent) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.run(9);
  robot.run(11, 19);  // without SYNC 10
  const auto sent = robot.bus.sent(canopen::identifier::monitoring + test::TestModule::node_id);
  EXPECT_EQ(sent.size(), 1U) << "that of tick 0";
}

TEST(Monitored, EveryHundredthSyncOnABusyBus) {
  KernelConfiguration kernel = test::one_slot(test::algorithm(test::sinusoidal), 8);
  kernel.tick_period_us = 1'500;  // 8 * 135 + 65 + 14 bits in 1,500 are 77 %, with 8 * 11.5 more 83 %
  EXPECT_EQ(canopen::monitoring_period(kernel), 10U);
  kernel.tick_period_us = 1'450;
  EXPECT_EQ(canopen::monitoring_period(kernel), 100U);
  test::TestModule robot(kernel);
  robot.set_up_and_start();
  EXPECT_EQ(robot.bus.value(test::TestModule::node_id, object::monitoring_transmission_type), 100U);
  robot.run(150);
  EXPECT_EQ(robot.bus.sent(canopen::identifier::monitoring + test::TestModule::node_id).size(), 2U);
}

}  // namespace
}  // namespace proleg
