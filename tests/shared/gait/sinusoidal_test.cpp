#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <random>

#include "module_chain.hpp"
#include "robot.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

using test::in_degrees;

/// A sin(2 pi f t + Phi) + O in degrees (thesis, equation 3.1).
double equation_3_1(double amplitude, double frequency, double t, double phase_degrees, double offset) {
  return amplitude * std::sin(2 * std::numbers::pi * (frequency * t + phase_degrees / 360)) + offset;
}

// Thesis listing B.8: amplitude 30 degrees, 1 Hz, control period 31 ms, phase -88.73 degrees a joint in file order,
// which counts from the tail; so +88.73 degrees a joint from the head, and the tail at 0.
TEST(Sinusoidal, ReproducesThePublishedAnglesOfThesisListingB8) {
  constexpr std::array<std::array<double, 5>, 2> published = {
      {{5.80648, -29.297, -7.10298, 28.9827, 8.38557}, {11.3934, -27.4934, -12.6101, 26.9354, 13.802}}};
  KernelOf<5> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), 5, 31'000), 0), Status::ok);
  test::set_all(kernel, 0, "amplitude", test::degrees(30));
  test::set_all(kernel, 0, "frequency", test::hertz(1));
  test::set_all(kernel, 0, "phase_difference", test::phase(88.73));
  test::set_all(kernel, 0, "phase", test::phase(-4 * 88.73));
  kernel.reset();
  for (std::size_t sample = 0; sample < published.size(); ++sample) {
    kernel.advance();
    for (unsigned in_file = 0; in_file < 5; ++in_file) {
      const unsigned joint = 4 - in_file;
      EXPECT_NEAR(in_degrees(kernel.setpoint(joint)), published[sample][in_file], 0.005)
          << "J" << in_file + 1 << " at t = " << 0.031 * static_cast<double>(sample + 1);
    }
  }
}

// Angles: half a step of the parameter, the sine's 7.3e-9 and one rounding; phase: half a step of the increment a tick.
TEST(Sinusoidal, FollowsEquation31ForRandomParameters) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(0, 1);
  double largest = 0;
  for (int trial = 0; trial < 200; ++trial) {
    constexpr unsigned joints = 6;
    const auto tick_us = static_cast<std::uint32_t>(1000 + random() % 99'001);
    KernelOf<joints> kernel;
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), joints, tick_us), 0), Status::ok);
    const double amplitude = 90 * unit(random);
    const double frequency = 2 * unit(random);
    const double difference = 360 * unit(random) - 180;
    const double shift = 360 * unit(random) - 180;
    const double offset = (90 - amplitude) * (2 * unit(random) - 1);
    test::set_all(kernel, 0, "amplitude", test::degrees(amplitude));
    test::set_all(kernel, 0, "frequency", test::hertz(frequency));
    test::set_all(kernel, 0, "phase_difference", test::phase(difference));
    test::set_all(kernel, 0, "phase", test::phase(shift));
    test::set_all(kernel, 0, "offset", test::degrees(offset));
    kernel.reset();
    for (unsigned tick = 0; tick <= 200; ++tick) {
      for (unsigned joint = 0; joint < joints; ++joint) {
        const double expected = equation_3_1(amplitude, test::hertz(frequency) / 16777216.0, tick * tick_us * 1e-6,
                                             joint * difference + shift, offset);
        const double error = std::abs(in_degrees(kernel.setpoint(joint)) - expected);
        // Phase steps are 8.4e-8 degrees: half a step for each tick, joint and for the shift, times d(angle)/d(phase).
        const double tolerance =
            3 * 8.4e-8 + amplitude * (7.3e-9 + (tick + joint + 1) * 4.2e-8 * std::numbers::pi / 180);
        ASSERT_LE(error, tolerance) << "trial " << trial << ", tick " << tick << ", joint " << joint;
        largest = std::max(largest, error);
      }
      kernel.advance();
    }
  }
  std::cout << "largest error " << largest << " degrees over 200 ticks\n";
}

TEST(Sinusoidal, MeasuresItsFrequencyAndThePhaseDifferenceToTheNextJoint) {
  KernelOf<5> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), 5), 0), Status::ok);
  test::set_all(kernel, 0, "frequency", test::hertz(1.25));
  test::set_all(kernel, 0, "phase_difference", test::phase(-55));
  kernel.reset();
  test::run(kernel, 10);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_NEAR(test::value(kernel, 0, joint, "measured_frequency") / 16777216.0, 1.25, 1e-6);
    EXPECT_EQ(test::value(kernel, 0, joint, "measured_phase_difference"), joint < 4 ? test::phase(-55) : 0);
  }
}

// protocol.md: nearest, no remainder.
TEST(PhaseIncrement, IsTheIntegerNearestToTheTurnsOfATick) {
  EXPECT_EQ(phase_increment_of(test::hertz(1), 10'000), 42'949'673);   // 2^32 / 100 = 42949672.96
  EXPECT_EQ(phase_increment_of(test::hertz(1), 31'000), 133'143'986);  // 2^32 * 0.031 = 133143986.2
  EXPECT_EQ(phase_increment_of(0, 10'000), 0);
  std::mt19937 random(5);
  for (int i = 0; i < 10000; ++i) {
    const auto frequency = static_cast<std::int32_t>(random() % (20U << 24U));
    const auto tick_us = static_cast<std::uint32_t>(1000 + random() % 99'001);
    const long double turns = static_cast<long double>(frequency) / (1 << 24) * tick_us / 1e6L;
    const long double exact = turns * 4294967296.0L;
    const auto increment = static_cast<std::uint32_t>(phase_increment_of(frequency, tick_us));
    const long double error = exact - static_cast<long double>(increment);
    ASSERT_LE(std::abs(error - 4294967296.0L * std::round(error / 4294967296.0L)), 0.5L + 1e-6L)
        << frequency << " at " << tick_us;
  }
}

TEST(PhaseIncrement, DriftsByNoMoreThanDeclaredInAnHour) {
  constexpr double ticks = 360'000;
  double largest = 0;
  for (double frequency = 0.1; frequency < 4; frequency += 0.0137) {
    const std::int32_t raw_frequency = test::hertz(frequency);
    const double turns = ticks * phase_increment_of(raw_frequency, 10'000) / 4294967296.0;
    largest = std::max(largest, 360 * std::abs(turns - raw_frequency / 16777216.0 * 3600));
  }
  EXPECT_LE(largest, 0.0151);
  EXPECT_GE(largest, 0.001) << "without a remainder there is a drift";
}

// However a module came to tick k, its state is that of tick k: frames do not matter.
TEST(Sinusoidal, IsAFunctionOfTheTickForAnyReceivedFrames) {
  const KernelConfiguration configuration = test::one_slot(test::algorithm(test::sinusoidal), 5);
  KernelOf<5> reference;
  ASSERT_EQ(reference.configure(configuration, 0), Status::ok);
  test::ModuleChain chain(configuration);
  std::mt19937 random(8);
  for (int tick = 0; tick < 500; ++tick) {
    chain.exchange([&](unsigned, unsigned) { return random() % 2 == 0; });
    chain.advance();
    reference.advance();
    for (unsigned joint = 0; joint < 5; ++joint) {
      ASSERT_EQ(chain[joint].setpoint(joint), reference.setpoint(joint)) << "tick " << tick << " joint " << joint;
    }
  }
}

TEST(Sinusoidal, KeepsTheLargestAmplitudeAndOffsetWithinTheLimits) {
  for (const double offset : {-90.0, 90.0}) {
    KernelOf<1> kernel;
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), 1), 0), Status::ok);
    test::set_all(kernel, 0, "amplitude", test::degrees(90));
    test::set_all(kernel, 0, "offset", test::degrees(offset));
    kernel.reset();
    for (int tick = 0; tick < 200; ++tick) {
      const double expected = std::clamp(equation_3_1(90, 1, tick * 0.01, 0, offset), -90.0, 90.0);
      ASSERT_NEAR(in_degrees(kernel.setpoint(0)), expected, 1e-4) << "tick " << tick;
      kernel.advance();
    }
  }
}

}  // namespace
}  // namespace proleg
