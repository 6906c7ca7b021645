// Five modules on a bus, configured by SDO only, compute the same as five kernels that exchange frames.

#include <random>

#include "module_chain.hpp"
#include "shared/gait/joint_readings.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::AbortCode;
using canopen::ValueKind;

constexpr unsigned joints = 5;

KernelConfiguration three_slots(std::uint32_t tick_us) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), joints, tick_us, 0x1'2345'6789);
  configuration.slots[1] = {&test::algorithm(test::extended), JointMask(0b01110)};
  configuration.slots[2] = {&test::algorithm(test::direct), JointMask(0b00100)};
  return configuration;
}

/// A robot of modules and the chain of kernels that it must equal: the chain computes a tick whenever SYNC is sent, and
/// all joints are compared before each.
class Pair {
 public:
  explicit Pair(const KernelConfiguration& configuration, std::uint32_t servo_period_us = 20'000)
      : robot(configuration, servo_period_us), chain(configuration), debouncers_(joints) {
    robot.bus.on_frame = [this](const CanFrame& frame) {
      if (test::is_sync(frame)) {
        expect_equal();
        tick();
      }
    };
    robot.bus.loses = [this](const CanFrame& frame, std::size_t receiver) {
      for (unsigned joint = 0; joint < joints; ++joint) {
        if (frame.identifier == canopen::identifier::state_frame + robot.node(joint)) {
          return lost(joint, static_cast<unsigned>(receiver), frame.data[7]);
        }
      }
      return false;
    };
  }

  void start_value(std::uint8_t slot, unsigned joint, std::string_view name, std::int32_t value) {
    const auto parameter = static_cast<std::uint8_t>(test::parameter_index(chain[joint], slot, name));
    values_.push_back({slot, static_cast<std::uint8_t>(joint), parameter, false, value});
    test::set(chain[joint], slot, joint, name, value);
  }
  void limit(unsigned joint, std::int32_t lower, std::int32_t upper) {
    robot.limit(joint, lower, upper);
    ASSERT_EQ(chain[joint].set_limits(joint, lower, upper), Status::ok);
  }
  void drive() {
    robot.setup.start_values = values_;
    chain.reset();
    robot.drive();
  }
  /// Returns the chain to its start.
  void restart() {
    chain.reset();
    debouncers_.assign(joints, {});
  }
  void run_to(std::uint32_t tick) {
    robot.run_to(tick);
    ASSERT_EQ(chain[0].tick(), tick + 1);
    expect_equal();
  }

  // These functions change modules and chain together, in a transaction that is opened in all modules.
  void open(std::uint16_t transaction) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(robot.bus.write(robot.node(joint), canopen::object::transaction, transaction), AbortCode::none);
      ASSERT_EQ(chain[joint].open(transaction), Status::ok);
    }
    transaction_ = transaction;
  }
  void stage(std::uint8_t slot, unsigned joint, std::string_view name, std::int32_t value) {
    write(joint, test::parameter_address(chain[joint], slot, name, ValueKind::staged_parameter), value);
    ASSERT_EQ(chain[joint].stage(transaction_, slot, joint, test::parameter_index(chain[joint], slot, name), value),
              Status::ok);
  }
  void distort(std::uint8_t slot, unsigned joint, std::string_view name, std::int32_t value) {
    write(joint, test::parameter_address(chain[joint], slot, name, ValueKind::internal_value), value);
    ASSERT_EQ(
        chain[joint].stage_internal(transaction_, slot, joint, test::value_index(chain[joint], slot, name), value),
        Status::ok);
  }
  void commit(std::uint32_t tick) {
    for (int i = 0; i < 3; ++i) {
      robot.bus.deliver(encode(canopen::CommitMessage{transaction_, tick, robot.setup.robot_id}));
    }
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(chain[joint].commit(transaction_, tick), Status::ok);
    }
  }

  /// Number of lost frames in a hundred.
  unsigned lost_percent = 0;
  test::TestRobot robot;
  test::ModuleChain chain;

 private:
  [[nodiscard]] bool lost(unsigned sender, unsigned receiver, unsigned label) const {
    return label != 0 && (label * 2654435761U + sender * 40503U + receiver * 9973U) / 256U % 100U < lost_percent;
  }

  void tick() {
    for (unsigned joint = 0; joint < joints; ++joint) {
      robot.at(joint).sensors = static_cast<std::uint8_t>(random_() & random_());
      chain[joint].set_contacts(joint, debouncers_[joint].sample(robot.at(joint).sensors));
    }
    chain.exchange([&](unsigned sender, unsigned receiver) { return lost(sender, receiver, chain[0].tick() & 0xFFU); });
    chain.advance();
  }

  void expect_equal() {
    for (unsigned joint = 0; joint < joints; ++joint) {
      const Kernel& module = robot.kernel(joint);
      const Kernel& expected = chain[joint];
      ASSERT_EQ(module.tick(), expected.tick()) << "joint " << joint;
      ASSERT_EQ(module.setpoint(joint), expected.setpoint(joint)) << "joint " << joint << " tick " << module.tick();
      ASSERT_EQ(module.previous_setpoint(joint), expected.previous_setpoint(joint));
      for (unsigned channel = 0; channel < module.channel_count(joint); ++channel) {
        ASSERT_EQ(module.frame(joint, channel), expected.frame(joint, channel));
      }
    }
  }

  void write(unsigned joint, canopen::Address address, std::int32_t value) {
    ASSERT_EQ(robot.bus.write(robot.node(joint), address, 4, static_cast<std::uint32_t>(value)), AbortCode::none);
  }

  std::vector<ContactDebouncer> debouncers_;
  std::vector<Setting> values_;
  std::uint16_t transaction_ = 0;
  std::mt19937 random_{1};
};

class Chain : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(OfTickPeriods, Chain, testing::Values(3'000, 10'000, 100'000));

TEST_P(Chain, ComputesTheSetPointsOfAChainOfKernelsBitForBit) {
  Pair pair(three_slots(GetParam()));
  for (unsigned joint = 0; joint < joints; ++joint) {
    pair.start_value(0, joint, "amplitude", test::degrees(20.0 + joint));
    pair.start_value(0, joint, "phase_difference", test::phase(-70.0));
  }
  pair.start_value(1, 3, "frequency", test::hertz(1.7));
  pair.start_value(2, 2, "angle", test::degrees(-30));
  pair.limit(1, test::degrees(-10), test::degrees(12.5));
  pair.drive();

  // There are changes on the way: a parameter of every joint, and a distortion of one joint.
  pair.run_to(30);
  pair.open(7);
  for (unsigned joint = 0; joint < joints; ++joint) {
    pair.stage(0, joint, "amplitude", test::degrees(35));
  }
  pair.distort(0, 2, "current_phase", test::phase(100));
  pair.commit(150);
  pair.run_to(200);
  pair.open(8);
  pair.stage(1, 3, "frequency", test::hertz(0.5));
  pair.commit(260);
  pair.run_to(400);

  EXPECT_EQ(pair.robot.kernel(2).parameter(0, 2, test::parameter_index(pair.chain[2], 0, "amplitude")),
            test::degrees(35));
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(pair.robot.kernel(joint).missed_frames(), 0U);
    EXPECT_TRUE(pair.robot.bus.emergencies(pair.robot.node(joint)).empty());
    EXPECT_EQ(pair.robot.module(joint).dropped_frames(), 0U);
  }
}

TEST(Chain, ComputesTheSameWhenTheSameFramesAreLost) {
  Pair pair(test::one_slot(test::algorithm(test::coupled), joints));
  pair.lost_percent = 10;
  pair.drive();
  pair.run_to(400);
  EXPECT_GT(pair.robot.kernel(0).missed_frames(), 20U) << "of joint 1";
}

TEST(Chain, ComputesTheSameWhenItIsStoppedAndStartedAgain) {
  Pair pair(test::one_slot(test::algorithm(test::coupled), joints));
  pair.drive();
  pair.run_to(100);
  pair.robot.command(canopen::NmtCommand::enter_pre_operational);
  pair.restart();
  pair.robot.bus.run_for(50'000);
  pair.robot.start();
  pair.robot.produce_sync();
  pair.run_to(100);
}

TEST(Chain, ChangesStagedBeforeTheStartTakeEffectAtTheirTick) {
  Pair pair(test::one_slot(test::algorithm(test::coupled), joints));
  pair.robot.set_up();
  pair.open(3);
  pair.stage(0, 1, "amplitude", test::degrees(10));
  pair.distort(0, 4, "current_phase", test::phase(33));
  pair.commit(0);
  pair.open(4);
  pair.stage(0, 1, "amplitude", test::degrees(20));
  pair.commit(50);
  pair.robot.start();
  pair.robot.produce_sync();
  pair.run_to(100);
}

class Pulses : public testing::TestWithParam<std::tuple<std::uint32_t, std::uint32_t>> {};
INSTANTIATE_TEST_SUITE_P(OfPeriods, Pulses,
                         testing::Combine(testing::Values(1'000, 3'000, 7'001, 20'000),
                                          testing::Values(4'999, 10'000)));

// The formulas are those of docs/protocol.md, as shared/kernel/servo_pulses.hpp has them.
TEST_P(Pulses, AreThoseOfTheScheduleAtTheirTimesAfterSync) {
  const auto [servo_us, tick_us] = GetParam();
  constexpr std::uint32_t last = 150;
  test::TestRobot robot(test::one_slot(test::algorithm(test::sinusoidal), 3, tick_us), servo_us);
  robot.set_up();
  robot.start();
  for (unsigned joint = 0; joint < robot.joints(); ++joint) {
    robot.enable(joint);
  }
  std::vector<std::array<std::int32_t, 3>> setpoints;
  const auto keep = [&] {
    setpoints.push_back({robot.kernel(0).setpoint(0), robot.kernel(1).setpoint(1), robot.kernel(2).setpoint(2)});
  };
  keep();
  robot.produce_sync();
  for (std::uint32_t k = 0; k <= last; ++k) {
    robot.run_to(k);
    keep();
  }
  const std::vector<test::TestBus::Sent> syncs = robot.bus.sent(canopen::identifier::sync);
  const ServoSchedule schedule(servo_us, tick_us);
  for (unsigned joint = 0; joint < robot.joints(); ++joint) {
    std::vector<test::Pulse> expected{{0, std::nullopt}};  // the pulses are off at power-on
    for (std::uint32_t k = 0; k < last; ++k) {
      for (std::uint64_t n = schedule.first_interval(k); n < schedule.first_interval(k + 1); ++n) {
        const std::int32_t angle = interpolate(setpoints[k][joint], setpoints[k + 1][joint], schedule.fraction(n));
        const Microseconds time = syncs[k].time + schedule.start_us(n) - std::uint64_t{k} * tick_us;
        // SYNC waits for a frame that is on the bus, and so the next one may be early.
        expected.push_back({std::min(time, syncs[k + 1].time), servo_command(angle)});
      }
    }
    const std::vector<test::Pulse>& pulses = robot.at(joint).pulses;
    ASSERT_GE(pulses.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(pulses[i].time, expected[i].time) << "joint " << joint << " pulse " << i;
      ASSERT_EQ(pulses[i].width, expected[i].width) << "joint " << joint << " pulse " << i;
    }
  }
}

}  // namespace
}  // namespace proleg
