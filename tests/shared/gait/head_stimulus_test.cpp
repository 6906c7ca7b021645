// The wave that turns back when something touches the head.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <random>

#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::ModuleChain;
using test::robot_joints;

constexpr std::uint32_t one_hertz_step = 42'949'673;  // phase step of 1 Hz in ticks of 10 ms
constexpr std::uint8_t head_front = StateFrame::contact_far_link_front;
constexpr std::uint8_t head_rear = StateFrame::contact_far_link_rear;

KernelConfiguration configuration() { return test::one_slot(test::algorithm(test::stimulus), robot_joints); }

/// All joints in one kernel.
class HeadStimulus : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(kernel_.configure(configuration(), 0), Status::ok); }

  /// Advances a tick. contacts: of the head's joint at this SYNC.
  void tick(std::uint8_t contacts = 0) {
    kernel_.set_contacts(0, contacts);
    kernel_.advance();
  }
  /// Change of a joint's phase in the last tick.
  [[nodiscard]] std::int32_t step(unsigned joint) {
    const std::int32_t phase = test::value(kernel_, 0, joint, "current_phase");
    const auto change =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(phase) - static_cast<std::uint32_t>(before_[joint]));
    before_[joint] = phase;
    return change;
  }
  /// 1 if the wave of all joints went forwards in the last tick, -1 if it went backwards.
  [[nodiscard]] int direction() {
    int direction = 0;
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const std::int32_t change = step(joint);
      EXPECT_EQ(std::abs(change), static_cast<std::int32_t>(one_hertz_step)) << "no jump of joint " << joint;
      const int own = change > 0 ? 1 : -1;
      EXPECT_TRUE(joint == 0 || own == direction) << "joint " << joint;
      direction = own;
    }
    return direction;
  }
  void note_phases() {
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      static_cast<void>(step(joint));
    }
  }

  KernelOf<robot_joints> kernel_;
  std::array<std::int32_t, robot_joints> before_{};
};

TEST(HeadStimulusUntouched, IsTheSineBitForBit) {
  std::mt19937 random(151);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const auto tick_us = static_cast<std::uint32_t>(1000 + random() % 99'001);
    KernelOf<robot_joints> own;
    KernelOf<robot_joints> sine;
    ASSERT_EQ(own.configure(test::one_slot(test::algorithm(test::stimulus), robot_joints, tick_us), 0), Status::ok);
    ASSERT_EQ(sine.configure(test::one_slot(test::algorithm(test::sinusoidal), robot_joints, tick_us), 0), Status::ok);
    const std::int32_t amplitude = test::degrees(90 * unit(random));
    const std::int32_t frequency = test::hertz(20 * unit(random));
    const std::int32_t difference = test::phase(360 * unit(random));
    const std::int32_t shift = test::phase(360 * unit(random));
    for (Kernel* kernel : {static_cast<Kernel*>(&own), static_cast<Kernel*>(&sine)}) {
      test::set_all(*kernel, 0, "amplitude", amplitude);
      test::set_all(*kernel, 0, "frequency", frequency);
      test::set_all(*kernel, 0, "phase_difference", difference);
      test::set_all(*kernel, 0, "phase", shift);
      kernel->reset();
    }
    for (int tick = 0; tick < 300; ++tick) {
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        ASSERT_EQ(own.setpoint(joint), sine.setpoint(joint)) << "seed 151, trial " << trial << ", tick " << tick;
      }
      own.advance();
      sine.advance();
    }
  }
}

// out = A sin(2 pi f T n + j dphi + phase) + O, where n grows by 1 in each tick, and falls by 1 from the tick after a
// touch is in the head's state frame until `retreat` ticks have passed since the last touch.
TEST_F(HeadStimulus, FollowsItsEquationThroughRandomTouches) {
  constexpr int retreat = 70;
  test::set_all(kernel_, 0, "retreat", retreat);
  test::set_all(kernel_, 0, "phase", test::phase(33));
  test::set_all(kernel_, 0, "offset", test::degrees(-7));
  test::set_all(kernel_, 0, "frequency", test::hertz(1.3));
  kernel_.reset();
  std::mt19937 random(152);
  double largest = 0;
  int left = 0;
  long n = 0;
  bool touched_before = false;
  for (int tick = 0; tick < 5000; ++tick) {
    const bool touched = random() % 150 == 0;
    left = touched_before ? retreat : std::max(left - 1, 0);
    n += left > 0 ? -1 : 1;
    touched_before = touched;
    this->tick(touched ? head_front : 0);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const double turns = 1.3 * 0.01 * static_cast<double>(n) + (joint * 55.0 + 33.0) / 360.0;
      const double expected = 40 * std::sin(2 * std::numbers::pi * turns) - 7;
      largest = std::max(largest, std::abs(in_degrees(kernel_.setpoint(joint)) - expected));
    }
  }
  EXPECT_GT(left + std::abs(n), 0);
  // The error is half a step of phase in a tick, as for the plain sine.
  EXPECT_LE(largest, 40 * 5000 * 4.2e-8 * std::numbers::pi / 180 + 1e-6);
  std::cout << "seed 152: largest error " << largest << " degrees\n";
}

TEST_F(HeadStimulus, TurnsTwoTicksAfterTheTouchAndBackAfterTheRetreat) {
  constexpr int retreat = 20;
  test::set_all(kernel_, 0, "retreat", retreat);
  kernel_.reset();
  note_phases();
  for (int i = 0; i < 5; ++i) {
    tick();
    EXPECT_EQ(direction(), 1);
  }
  tick(head_front);
  EXPECT_EQ(direction(), 1) << "the touch is in no state frame yet";
  for (int i = 0; i < retreat; ++i) {
    tick();
    EXPECT_EQ(direction(), -1) << "tick " << i << " of the retreat";
  }
  tick();
  EXPECT_EQ(direction(), 1);
}

TEST_F(HeadStimulus, StaysReversedWhileTheHeadIsTouched) {
  test::set_all(kernel_, 0, "retreat", 5);
  kernel_.reset();
  note_phases();
  tick(head_front);
  static_cast<void>(direction());
  for (int i = 0; i < 60; ++i) {
    tick(head_front);
    EXPECT_EQ(direction(), -1);
  }
  for (int i = 0; i < 5; ++i) {
    tick();
    EXPECT_EQ(direction(), -1);
  }
  tick();
  EXPECT_EQ(direction(), 1);
}

TEST_F(HeadStimulus, ListensToTheSensorsOfItsParameterOnly) {
  struct Case {
    std::int32_t sensor;
    std::uint8_t contacts;
    int direction;
  };
  for (const Case& one : {Case{2, head_front, -1}, Case{2, head_rear, 1}, Case{1, head_rear, -1},
                          Case{1, head_front, 1}, Case{3, head_rear, -1}, Case{3, head_front, -1}, Case{3, 3, 1}}) {
    test::set_all(kernel_, 0, "sensor", one.sensor);
    kernel_.reset();
    note_phases();
    tick(one.contacts);
    static_cast<void>(direction());
    tick();
    EXPECT_EQ(direction(), one.direction) << "sensor " << one.sensor << ", contacts " << int{one.contacts};
  }
}

TEST_F(HeadStimulus, WithoutARetreatNeverTurns) {
  test::set_all(kernel_, 0, "retreat", 0);
  kernel_.reset();
  note_phases();
  for (int i = 0; i < 20; ++i) {
    tick(head_front);
    EXPECT_EQ(direction(), 1);
  }
}

TEST_F(HeadStimulus, KeepsItsPhaseWhenTheFrequencyChanges) {
  for (int i = 0; i < 30; ++i) {
    tick();
  }
  note_phases();
  test::commit_all(kernel_, 0, "frequency", test::hertz(2), kernel_.tick());
  tick();
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(step(joint), 85'899'346);
  }
}

/// Whether all joints have the same set-points in two chains.
bool agree(ModuleChain& a, ModuleChain& b) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    if (a[joint].setpoint(joint) != b[joint].setpoint(joint)) {
      return false;
    }
  }
  return true;
}

TEST(HeadStimulusLosses, AreForgottenWithinATickForEachJoint) {
  ModuleChain losing(configuration());
  ModuleChain complete(configuration());
  std::mt19937 random(153);
  bool differed = false;
  for (int tick = 0; tick < 3000; ++tick) {
    const bool loses = tick % 300 < 250;
    const std::uint8_t contacts = tick % 700 == 230 ? head_front : 0;
    losing.exchange([&](unsigned, unsigned) { return loses && random() % 10 < 3; });
    complete.exchange();
    losing[0].set_contacts(0, contacts);
    complete[0].set_contacts(0, contacts);
    losing.advance();
    complete.advance();
    differed = differed || !agree(losing, complete);
    if (tick % 300 >= 250 + static_cast<int>(robot_joints)) {
      ASSERT_TRUE(agree(losing, complete)) << "seed 153, tick " << tick;
    }
  }
  EXPECT_TRUE(differed) << "the losses had no effect";
}

TEST(HeadStimulusJoining, TakesPartInARetreatAtOnce) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    ModuleChain joining(configuration());
    ModuleChain complete(configuration());
    for (int tick = 0; tick < 150; ++tick) {
      const std::uint8_t contacts = tick == 100 ? head_front : 0;
      if (tick == 120) {
        joining[joint].join(120);
      }
      for (ModuleChain* chain : {&joining, &complete}) {
        // A joint that joins has sent no frame for this tick.
        chain->exchange([&](unsigned sender, unsigned) { return chain == &joining && tick == 120 && sender == joint; });
        (*chain)[0].set_contacts(0, contacts);
        chain->advance();
      }
    }
    EXPECT_TRUE(agree(joining, complete)) << "joint " << joint;
  }
}

}  // namespace
}  // namespace proleg
