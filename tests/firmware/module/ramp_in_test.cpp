// A joint that was moved by hand moves slowly to the start of the gait when it gets power (object 0x200E).

#include <cstdlib>

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::EmergencyCode;
using canopen::NmtCommand;
using canopen::PowerState;
using test::node;
constexpr unsigned speed = 90;
constexpr std::uint16_t reached = 1U << 10U;  // the bit "target reached" of the statusword (CiA 402)

/// Pulse width of an angle in degrees: 18000 +- 12000 for +-90 degrees.
constexpr std::int32_t width_of(int degrees) { return servo_center + servo_quarter_turn * degrees / 90; }

class RampIn : public testing::Test {
 protected:
  static constexpr std::uint32_t servo_us = 3'000;

  RampIn() {
    // The joint has the offset -10 degrees and no amplitude: so has its state 0.
    set("amplitude", 0);
    set("offset", -10);
    robot.bus.nodes.clear();
    firmware::ModuleIdentity identity;
    identity.node = node;
    identity.core_fingerprint = 0xC0DEC0DE;
    identity.capabilities = canopen::measures_angle;
    robot.bus.add(identity, 77'000'000);
    robot.setup.start_values = values;
    measure(30);
  }
  void set(std::string_view name, int degrees) {
    const auto number = find_parameter(robot.setup.kernel.slots[0].algorithm->declaration(), name);
    values.push_back({0, 0, static_cast<std::uint8_t>(number), false, raw(Unit::degree, degrees)});
  }
  void measure(int degrees) { robot.it().meters.readings.angle = raw(Unit::degree, degrees); }
  /// Enters Operational, with power and without a tick.
  void enable(std::uint32_t ramp_speed = speed) {
    robot.boot();
    robot.configure(0);
    robot.write(object::ramp_in_speed, ramp_speed);
    power();
  }
  void power() {
    robot.start();
    robot.enable(0);
  }
  /// Sends the host's heartbeats for this time.
  void run_with_host(Microseconds time) {
    constexpr Microseconds period = 100'000;
    for (; time > 0; time -= std::min(time, period)) {
      robot.bus.deliver(encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational}));
      robot.bus.run_for(std::min(time, period));
    }
  }
  [[nodiscard]] bool has_arrived() { return (robot.bus.value(node, object::statusword) & reached) != 0; }
  [[nodiscard]] std::int32_t width() { return *robot.it().pulses.back().width; }
  /// Checks the speed between successive pulses, by the time that has passed between them.
  void expect_speed_at_most(unsigned degrees_per_second, std::size_t from = 0) {
    const std::vector<test::Pulse>& pulses = robot.it().pulses;
    unsigned moves = 0;
    for (std::size_t i = std::max<std::size_t>(from, 1); i < pulses.size(); ++i) {
      if (pulses[i].width && pulses[i - 1].width) {
        const auto passed = static_cast<std::int64_t>(pulses[i].time - pulses[i - 1].time);
        const std::int64_t most = passed * degrees_per_second * servo_quarter_turn / 90'000'000 + 1;
        EXPECT_LE(std::abs(*pulses[i].width - *pulses[i - 1].width), most) << "pulse " << i;
        moves += *pulses[i].width != *pulses[i - 1].width ? 1U : 0U;
      }
    }
    EXPECT_GT(moves, 10U) << "it must have moved";
  }

  std::vector<Setting> values;
  test::TestModule robot{test::one_slot(test::algorithm(test::sinusoidal), 1), servo_us};
};

TEST_F(RampIn, BeginsAtTheMeasuredAngleAndGoesSlowlyToTheStartOfTheGait) {
  enable();
  ASSERT_TRUE(robot.it().is_pulsing());
  EXPECT_FALSE(has_arrived());
  const auto first = std::find_if(robot.it().pulses.begin(), robot.it().pulses.end(),
                                  [](const test::Pulse& pulse) { return pulse.width.has_value(); });
  EXPECT_EQ(*first->width, width_of(30));
  run_with_host(200'000);
  EXPECT_FALSE(has_arrived());
  EXPECT_NEAR(width(), width_of(12), 100) << "90 degrees a second for 0.2 s";
  run_with_host(300'000);
  EXPECT_TRUE(has_arrived());
  EXPECT_EQ(width(), width_of(-10));
  expect_speed_at_most(speed);
}

TEST_F(RampIn, HoldsTheStartUntilTheGaitBeginsThereAndThenIsOver) {
  enable();
  run_with_host(3'000'000);
  EXPECT_TRUE(has_arrived());
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled)
      << "SYNC is not missing: the host has not started it";
  EXPECT_TRUE(robot.emergencies().empty());
  robot.run(20);
  EXPECT_FALSE(has_arrived());
  EXPECT_EQ(width(), width_of(-10));
  EXPECT_TRUE(robot.module().synchronised());
  expect_speed_at_most(speed);
}

TEST_F(RampIn, GivesTheGaitTheSamePulsesAsWithoutIt) {
  values.clear();
  robot.setup.start_values = values;  // the sine with its default values
  enable();
  run_with_host(2'000'000);
  ASSERT_TRUE(has_arrived());
  const std::size_t from = robot.it().pulses.size();
  robot.run(200);
  test::TestModule other(robot.setup.kernel, servo_us);
  other.set_up_and_start();
  other.enable(0);
  const std::size_t other_from = other.it().pulses.size();
  other.run(200);
  std::vector<std::int32_t> found;
  std::vector<std::int32_t> expected;
  for (std::size_t i = from; i < robot.it().pulses.size(); ++i) {
    found.push_back(robot.it().pulses[i].width.value_or(0));
  }
  for (std::size_t i = other_from; i < other.it().pulses.size(); ++i) {
    expected.push_back(other.it().pulses[i].width.value_or(0));
  }
  EXPECT_GT(found.size(), 600U);
  EXPECT_EQ(found, expected);
}

TEST_F(RampIn, IsOffUnlessTheHostSetsASpeed) {
  robot.boot();
  robot.configure(0);
  EXPECT_EQ(robot.bus.value(node, object::ramp_in_speed), 0U);
  power();
  run_with_host(300'000);
  EXPECT_EQ(robot.it().pulse_count(), 0U);
  robot.tick(0);
  robot.sync(0);
  EXPECT_EQ(width(), width_of(-10)) << "at once";
  // A reset ends it.
  robot.write(object::ramp_in_speed, 45);
  robot.command(NmtCommand::reset_node);
  robot.bus.run_for(20'000);
  EXPECT_EQ(robot.bus.value(node, object::ramp_in_speed), 0U);
}

TEST_F(RampIn, StaysWithinTheLimitsFromTheFirstPulseOn) {
  robot.limit(0, raw(Unit::degree, -6), raw(Unit::degree, 21));
  enable();
  EXPECT_LE(width(), width_of(21));
  EXPECT_GT(width(), width_of(18)) << "the limit that is nearest to the measured angle";
  run_with_host(500'000);
  EXPECT_TRUE(has_arrived());
  EXPECT_EQ(width(), width_of(-6));
  expect_speed_at_most(speed);
}

TEST_F(RampIn, IsNoFasterThanTheGreatestSpeed) {
  robot.setup.command_speed = 90;
  enable(10'000);
  run_with_host(600'000);
  EXPECT_TRUE(has_arrived());
  expect_speed_at_most(92);  // 1/64 above 90, see ServoGuard
}

TEST_F(RampIn, AHostThatDiesEndsItWithAQuickStop) {
  enable(10);
  run_with_host(300'000);
  EXPECT_GT(width(), width_of(24));
  robot.bus.host_is_alive = false;
  robot.bus.run_for(600'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies().front().code, EmergencyCode::heartbeat_lost);
  robot.bus.run_for(600'000);
  EXPECT_EQ(width(), servo_center) << "the safe pose";
  EXPECT_FALSE(has_arrived());
  expect_speed_at_most(speed);
}

TEST_F(RampIn, WithoutAHeartbeatTheMissingSyncEndsIt) {
  robot.boot();
  robot.configure(0);
  robot.write(object::host_heartbeat, 0);
  robot.write(object::ramp_in_speed, speed);
  power();
  robot.bus.run_for(450'000);
  EXPECT_EQ(robot.module().power(), PowerState::operation_enabled);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
}

TEST_F(RampIn, AQuickStopOfTheHostGoesToTheSafePose) {
  enable();
  run_with_host(100'000);
  robot.write_controlword(0x0002);
  run_with_host(1'000'000);
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  EXPECT_EQ(width(), servo_center);
  EXPECT_FALSE(has_arrived());
  robot.write_controlword(0);
  EXPECT_FALSE(robot.it().is_pulsing());
}

TEST_F(RampIn, ASyncThatIsNotUnderstoodEndsItWithAQuickStop) {
  enable();
  run_with_host(100'000);
  robot.sync(17);  // without TICK
  EXPECT_EQ(robot.module().power(), PowerState::quick_stop_active);
  run_with_host(1'000'000);
  EXPECT_EQ(width(), servo_center);
  expect_speed_at_most(speed);
}

TEST_F(RampIn, LeavingOperationalEndsIt) {
  enable();
  run_with_host(100'000);
  robot.command(NmtCommand::enter_pre_operational);
  EXPECT_FALSE(robot.it().is_pulsing());
  run_with_host(500'000);
  EXPECT_FALSE(robot.it().is_pulsing());
}

TEST_F(RampIn, DoesNotBeginWithoutANewReading) {
  robot.boot();
  robot.configure(0);
  robot.write(object::ramp_in_speed, speed);
  robot.it().meters.readings.are_new = false;
  robot.bus.run_for(20'000);
  power();
  EXPECT_EQ(robot.it().pulse_count(), 0U);
  run_with_host(200'000);
  EXPECT_EQ(robot.it().pulse_count(), 0U);
  EXPECT_EQ(robot.module().power(), PowerState::fault) << "the sensors do not measure";
}

TEST_F(RampIn, AModuleThatDoesNotMeasureWaitsForTheTickAsEver) {
  test::TestModule other(robot.setup.kernel, servo_us);
  other.it().meters.readings.angle = raw(Unit::degree, 30);  // noise: there is no potentiometer
  other.boot();
  other.configure(0);
  other.write(object::ramp_in_speed, speed);
  other.start();
  other.enable(0);
  other.bus.run_for(100'000);
  EXPECT_EQ(other.it().pulse_count(), 0U);
}

TEST_F(RampIn, InDirectPositionGoesToTheTarget) {
  robot.boot();
  robot.configure(0);
  robot.write(object::ramp_in_speed, speed);
  robot.write(object::mode, static_cast<std::uint32_t>(canopen::mode_direct_position));
  robot.write(object::target_position, static_cast<std::uint32_t>(raw(Unit::degree, 15)));
  power();
  run_with_host(400'000);
  EXPECT_TRUE(has_arrived());
  EXPECT_EQ(width(), width_of(15));
  robot.run(10);
  EXPECT_EQ(width(), width_of(15));
  expect_speed_at_most(speed);
}

}  // namespace
}  // namespace proleg
