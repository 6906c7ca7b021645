#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>

#include "matsuoka_model.hpp"
#include "robot.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

class Matsuoka : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::matsuoka), robot_joints), 0), Status::ok);
  }

  /// Sets the oscillator of a model: the frequency is the natural one that belongs to tau and T.
  void set(const test::MatsuokaModel& model) {
    test::set_all(kernel, 0, "frequency", test::hertz(model.omega() / (2 * std::numbers::pi)));
    test::set_all(kernel, 0, "time_ratio", test::ratio(model.t / model.tau));
    test::set_all(kernel, 0, "fatigue", test::ratio(model.beta));
    test::set_all(kernel, 0, "inhibition", test::ratio(model.w));
  }

  void isolate() {
    test::set_all(kernel, 0, "coupling", 0);
    test::set_all(kernel, 0, "noise", 0);
  }

  KernelOf<robot_joints> kernel;
};

// Periods and amplitudes of y1 - y2 for c = 1, integrated with small steps, independently of this project's code.
struct Oscillator {
  double tau;
  double t;
  double beta;
  double w;
  double period;
  double amplitude;
};
constexpr std::array<Oscillator, 4> oscillators = {{{0.25, 0.5, 2.5, 2.5, 2.230, 0.480},
                                                    {0.10, 0.2, 2.0, 2.0, 0.897, 0.505},
                                                    {0.12, 0.6, 2.5, 1.5, 1.267, 0.485},
                                                    {0.12, 0.6, 3.0, 2.0, 1.339, 0.479}}};

TEST_F(Matsuoka, HasThePeriodsAndAmplitudesOfTheTable) {
  for (const Oscillator& row : oscillators) {
    isolate();
    set({row.tau, row.t, row.beta, row.w});
    kernel.reset();
    test::run(kernel, 2000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 3000);
    EXPECT_NEAR(meters[0].period() * 0.01, row.period, 0.01 * row.period) << "tau " << row.tau << ", T " << row.t;
    // The joint's angle is 2 A (y1 - y2); Euler steps of a quarter of a tick add up to a percent.
    EXPECT_NEAR(meters[0].highest() / 80, row.amplitude, 0.015 * row.amplitude);
    EXPECT_NEAR(meters[0].lowest() / 80, -row.amplitude, 0.015 * row.amplitude);
  }
}

TEST_F(Matsuoka, FollowsItsEquationsInDoublePrecision) {
  isolate();
  test::MatsuokaModel model;
  set(model);
  kernel.reset();
  double largest = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    kernel.advance();
    for (int i = 0; i < 4; ++i) {
      model.step(0.0025, 1, 1);
    }
    largest = std::max(largest, std::abs(test::value(kernel, 0, 2, "u1") / 268435456.0 - model.u1));
    largest = std::max(largest, std::abs(test::value(kernel, 0, 2, "v2") / 268435456.0 - model.v2));
  }
  std::cout << "within " << largest << " over 1000 ticks\n";
  EXPECT_LE(largest, 1e-5);
}

// 1 + tau / T < w < 1 + beta: with tau / T = 1/2 and beta = 2.5 the bounds are 1.5 and 3.5.
TEST_F(Matsuoka, OscillatesOnlyBetweenItsBoundsOfInhibition) {
  const std::array<std::array<double, 2>, 5> cases = {{{1.4, 0}, {1.6, 1}, {2.5, 1}, {3.3, 1}, {3.6, 0}}};
  for (const auto& [w, oscillates] : cases) {
    isolate();
    test::set_all(kernel, 0, "fatigue", test::ratio(2.5));
    test::set_all(kernel, 0, "inhibition", test::ratio(w));
    test::set_all(kernel, 0, "frequency", test::hertz(1));
    kernel.reset();
    test::run(kernel, 6000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 2000);
    const double swing = meters[0].highest() - meters[0].lowest();
    if (oscillates != 0) {
      EXPECT_GT(swing, 20) << "w = " << w;
    } else {
      EXPECT_LT(swing, 1) << "w = " << w;
    }
  }
}

TEST_F(Matsuoka, LocksNearThePhaseDifferenceAndItsFrequency) {
  for (const double lag : {55.0, -90.0, 120.0}) {
    test::set_all(kernel, 0, "phase_difference", test::phase(lag));
    kernel.reset();
    test::run(kernel, 4000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 2000);
    for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
      const double found = meters[joint + 1].lead_over(meters[joint]);
      std::cout << "wanted " << lag << ", joint " << joint + 1 << " leads by " << found << ", period "
                << meters[joint].period() << '\n';
      EXPECT_NEAR(std::remainder(found - lag, 360), 0, 8) << "joint " << joint + 1 << ", wanted " << lag;
      EXPECT_NEAR(meters[joint].period(), 100, 3);
    }
  }
}

TEST_F(Matsuoka, HasItsPhaseAtZeroWhereTheJointRisesThroughItsOffset) {
  test::run(kernel, 2000);
  for (int tick = 0; tick < 500; ++tick) {
    const std::int32_t before = kernel.setpoint(1);
    kernel.advance();
    if (before < 0 && kernel.setpoint(1) >= 0) {
      EXPECT_NEAR(in_degrees(test::value(kernel, 0, 1, "current_phase")), 0, 10);
    }
  }
}

TEST_F(Matsuoka, KeepsItsPeriodWhenTheAmplitudeChanges) {
  isolate();
  for (const double amplitude : {10.0, 40.0, 80.0}) {
    test::set_all(kernel, 0, "amplitude", test::degrees(amplitude));
    kernel.reset();
    test::run(kernel, 1000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
    EXPECT_NEAR(meters[0].highest(), amplitude, 0.03 * amplitude);
    EXPECT_NEAR(meters[0].period(), 100, 1.5);
  }
}

}  // namespace
}  // namespace proleg
