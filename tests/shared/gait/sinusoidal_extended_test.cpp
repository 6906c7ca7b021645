#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

class SinusoidalExtended : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::extended), robot_joints), 0), Status::ok);
  }

  [[nodiscard]] std::int32_t value(unsigned joint, std::string_view name) const {
    return test::value(kernel, 0, joint, name);
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(SinusoidalExtended, EqualsThePlainSinusoidalToTheLastBitOnceItHasSettled) {
  KernelOf<robot_joints> plain;
  ASSERT_EQ(plain.configure(test::one_slot(test::algorithm(test::sinusoidal), robot_joints), 0), Status::ok);
  for (Kernel* each : {static_cast<Kernel*>(&kernel), static_cast<Kernel*>(&plain)}) {
    test::set_all(*each, 0, "amplitude", test::degrees(33.3));
    test::set_all(*each, 0, "frequency", test::hertz(0.77));
    test::set_all(*each, 0, "phase_difference", test::phase(-71));
    test::set_all(*each, 0, "phase", test::phase(12));
    test::set_all(*each, 0, "offset", test::degrees(-7));
    each->reset();
    test::run(*each, 400);
  }
  for (int tick = 400; tick < 1000; ++tick) {
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(kernel.setpoint(joint), plain.setpoint(joint)) << "tick " << tick;
      ASSERT_EQ(value(joint, "current_phase"), test::value(plain, 0, joint, "current_phase")) << "tick " << tick;
    }
    kernel.advance();
    plain.advance();
  }
}

TEST_F(SinusoidalExtended, StartsFromRest) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(kernel.setpoint(joint), 0);
  }
}

// Critically damped filter with double pole at -a/2: r(t) = R (1 - (1 + a t / 2) exp(-a t / 2)).
TEST_F(SinusoidalExtended, RampsItsAmplitudeAndOffsetAsTheAnalyticStepResponse) {
  constexpr double rate = 20;
  test::set_all(kernel, 0, "amplitude", test::degrees(40));
  test::set_all(kernel, 0, "offset", test::degrees(-20));
  kernel.reset();
  for (int tick = 0; tick < 300; ++tick) {
    const double ht = rate / 2 * tick * 0.01;
    const double share = 1 - (1 + ht) * std::exp(-ht);
    ASSERT_NEAR(in_degrees(value(2, "current_amplitude")), 40 * share, 1e-4) << "tick " << tick;
    ASSERT_NEAR(in_degrees(value(2, "current_offset")), -20 * share, 1e-4) << "tick " << tick;
    kernel.advance();
  }
}

TEST_F(SinusoidalExtended, Reaches95PercentOfItsAmplitudeIn949OverTheRate) {
  test::set_all(kernel, 0, "rate", test::per_second(5));
  kernel.reset();
  int ticks = 0;
  while (in_degrees(value(0, "current_amplitude")) < 0.95 * 40) {
    kernel.advance();
    ++ticks;
  }
  EXPECT_NEAR(ticks * 0.01, 9.49 / 5, 0.01);
}

TEST_F(SinusoidalExtended, NeverOvershootsItsAmplitude) {
  for (const double rate : {0.1, 1.0, 20.0, 100.0}) {
    test::set_all(kernel, 0, "rate", test::per_second(rate));
    kernel.reset();
    std::int32_t before = 0;
    for (int tick = 0; tick < static_cast<int>(4000 / rate); ++tick) {
      kernel.advance();
      const std::int32_t now = value(0, "current_amplitude");
      ASSERT_GE(now, before) << "rate " << rate << ", tick " << tick;
      ASSERT_LE(now, test::degrees(40)) << "rate " << rate << ", tick " << tick;
      before = now;
    }
    EXPECT_EQ(before, test::degrees(40)) << "rate " << rate;
  }
}

/// Largest change of a set-point over a tick around a change of frequency from 0.5 to 1.5 Hz after 5.13 s.
double largest_step_around_a_frequency_change(std::string_view algorithm) {
  KernelOf<robot_joints> kernel;
  EXPECT_EQ(kernel.configure(test::one_slot(test::algorithm(algorithm), robot_joints), 0), Status::ok);
  test::set_all(kernel, 0, "frequency", test::hertz(0.5));
  kernel.reset();
  test::run(kernel, 500);
  test::commit_all(kernel, 0, "frequency", test::hertz(1.5), 513);
  double largest = 0;
  for (int tick = 500; tick < 600; ++tick) {
    kernel.advance();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      largest =
          std::max(largest, std::abs(in_degrees(kernel.setpoint(joint)) - in_degrees(kernel.previous_setpoint(joint))));
    }
  }
  return largest;
}

// A sine of amplitude A moves by at most 2 pi f A dt in a tick.
TEST_F(SinusoidalExtended, KeepsItsPhaseContinuousWhenTheFrequencyChanges) {
  const double fastest = 2 * std::numbers::pi * 1.5 * 40 * 0.01;
  EXPECT_LE(largest_step_around_a_frequency_change(test::extended), fastest + 1e-3);
  EXPECT_GT(largest_step_around_a_frequency_change(test::sinusoidal), fastest + 1e-3)
      << "the plain sine jumps, as its description says";
}

TEST_F(SinusoidalExtended, ShiftsItsPhaseAlongTheShortestArc) {
  test::set_all(kernel, 0, "phase_difference", 0);
  test::set_all(kernel, 0, "phase", test::phase(170));
  kernel.reset();
  test::commit_all(kernel, 0, "phase", test::phase(-170), 0);
  for (int tick = 0; tick < 300; ++tick) {
    kernel.advance();
    // From 170 through 180 to 190: never more than 10 degrees from half a turn.
    ASSERT_GE(std::abs(in_degrees(value(3, "current_shift"))), 170 - 1e-6) << "tick " << tick;
  }
  EXPECT_EQ(value(3, "current_shift"), test::phase(-170));
}

TEST_F(SinusoidalExtended, ShiftsItsPhaseByHalfATurnUpwards) {
  test::set_all(kernel, 0, "phase_difference", 0);
  kernel.reset();
  test::commit_all(kernel, 0, "phase", test::phase(180), 0);
  test::run(kernel, 10);
  EXPECT_GT(value(0, "current_shift"), 0);
  EXPECT_LT(value(0, "current_shift"), test::degrees(90));
  test::run(kernel, 400);
  EXPECT_EQ(value(0, "current_shift"), test::phase(180));
}

TEST_F(SinusoidalExtended, OscillatesAtAWholeMultipleOfTheFrequency) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    test::set(kernel, 0, joint, "harmonic", static_cast<std::int32_t>(joint) + 1);
  }
  kernel.reset();
  test::run(kernel, 400);
  for (int tick = 400; tick < 600; ++tick) {
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const double angle = 40 * std::sin(2 * std::numbers::pi * ((joint + 1) * 1.0 * tick * 0.01 + joint * 55.0 / 360));
      ASSERT_NEAR(in_degrees(kernel.setpoint(joint)), angle, 1e-3) << "tick " << tick << ", joint " << joint;
      ASSERT_NEAR(value(joint, "measured_frequency") / 16777216.0, joint + 1.0, 1e-5);
    }
    kernel.advance();
  }
}

TEST_F(SinusoidalExtended, StartsWithoutNoiseUnlessAskedForIt) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(value(joint, "current_amplitude"), 0);
  }
  test::set_all(kernel, 0, "noise", test::ratio(1));
  kernel.reset();
  int noisy = 0;
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    noisy += value(joint, "current_amplitude") != 0 && value(joint, "current_offset") != 0 ? 1 : 0;
  }
  EXPECT_EQ(noisy, static_cast<int>(robot_joints));
}

}  // namespace
}  // namespace proleg
