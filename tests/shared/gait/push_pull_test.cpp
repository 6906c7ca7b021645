// The neurons are chaotic inside a burst, so fixed point and double precision diverge spike by spike. The oracles are
// statistics: period, overlap of the two neurons' bursts, lag; and the map itself over single steps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>

#include "robot.hpp"
#include "shared/gait/rulkov_neuron.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

constexpr double one = rulkov::unit;

TEST(RulkovNeuron, StepsAsTheMapInDoublePrecision) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> fast(-9, 8);
  std::uniform_real_distribution<double> slow(-9, -6);
  std::uniform_real_distribution<double> conductance(0, 3);
  const double mu = 0.0005;
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::round(fast(random) * one) / one;
    const double y = std::round(slow(random) * one) / one;
    const rulkov::Synapses open{test::ratio(conductance(random)), test::ratio(conductance(random) / 3)};
    const double current = open.inhibition / 268435456.0 * (-7 - x) + open.excitation / 268435456.0 * (1 - x);
    const rulkov::Neuron found =
        rulkov::iterate({static_cast<std::int32_t>(x * one), static_cast<std::int32_t>(y * one)}, open,
                        static_cast<std::int32_t>(mu * 2147483648.0));
    const double u = y + 0.1 * current;
    if (x > 0 && std::abs(x - (15 + u)) < 1e-6) {
      continue;  // on the edge of two branches a rounding decides
    }
    if (std::abs(u) > 15.9) {
      continue;  // beyond the range of the format
    }
    const double expected = x <= 0 ? 15 / (1 - x) + u : (x < 15 + u ? 15 + u : -1);
    ASSERT_NEAR(found.x / one, expected, 1e-3) << "x = " << x << ", y = " << y << ", I = " << current;
    ASSERT_NEAR(found.y / one, y + mu * (-(x + 1) - 0.33 + 0.5 * current), 1e-6);
  }
}

// An isolated neuron of these constants: 2105 iterations from burst to burst.
TEST(RulkovNeuron, BurstsInThePeriodOfTheIsolatedNeuron) {
  rulkov::Neuron neuron{-rulkov::unit, -7 * rulkov::unit};
  int bursts = 0;
  int first = 0;
  int last = 0;
  int last_spike = -1000;
  for (int i = 0; i < 200'000; ++i) {
    const std::int32_t before = neuron.x;
    neuron = rulkov::iterate(neuron, {0, 0}, 1'073'742);
    if (before <= 0 && neuron.x > 0) {
      if (i - last_spike > 200 && i > 20'000) {
        first = bursts == 0 ? i : first;
        last = i;
        ++bursts;
      }
      last_spike = i;
    }
  }
  ASSERT_GT(bursts, 10);
  EXPECT_NEAR(static_cast<double>(last - first) / (bursts - 1), 2105, 0.02 * 2105);
}

class PushPull : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::push_pull), robot_joints), 0), Status::ok);
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(PushPull, HasItsPeriodWithinTwoPercent) {
  for (const double frequency : {0.1, 0.4, 0.7, 1.0, 1.3}) {
    test::set_all(kernel, 0, "frequency", test::hertz(frequency));
    kernel.reset();
    const auto period = static_cast<unsigned>(100 / frequency);
    test::run(kernel, 20 * period);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 30 * period);
    for (const test::WaveMeter& meter : meters) {
      EXPECT_NEAR(meter.period() * 0.01 * frequency, 1, 0.02) << frequency << " Hz";
    }
  }
}

TEST_F(PushPull, LocksToThePhaseDifference) {
  for (const double lag : {55.0, -55.0, 100.0, 150.0}) {
    test::set_all(kernel, 0, "phase_difference", test::phase(lag));
    kernel.reset();
    test::run(kernel, 4000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 3000);
    for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
      const double found = meters[joint + 1].lead_over(meters[joint]);
      // A delay of whole ticks: steps of 3.6 degrees.
      EXPECT_NEAR(std::remainder(found - lag, 360), 0, 5) << "joint " << joint + 1 << ", wanted " << lag;
    }
  }
}

TEST_F(PushPull, CouplesAcrossJointsThatTheGroupLeavesOut) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::push_pull), robot_joints);
  configuration.slots[0].group = JointMask(0b11001);
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  test::run(kernel, 4000);
  const std::vector<test::WaveMeter> meters = test::meter(kernel, 2000);
  EXPECT_NEAR(meters[3].lead_over(meters[0]), 165, 4) << "three joints further on";
  EXPECT_NEAR(meters[4].lead_over(meters[3]), 55, 4);
}

TEST_F(PushPull, LetsPromotorAndRemotorFireInTurn) {
  test::run(kernel, 2000);
  int both = 0;
  int any = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    kernel.advance();
    const std::int32_t active = test::value(kernel, 0, 2, "activity") & 3;
    both += active == 3 ? 1 : 0;
    any += active != 0 ? 1 : 0;
  }
  EXPECT_GT(any, 2000);
  EXPECT_LT(both, any / 100 + 60) << "a tick in which the two change places";
}

TEST_F(PushPull, SwingsByItsAmplitudeAroundItsOffset) {
  for (const double frequency : {0.4, 1.0, 1.3}) {
    test::set_all(kernel, 0, "frequency", test::hertz(frequency));
    test::set_all(kernel, 0, "offset", test::degrees(-5));
    kernel.reset();
    test::run(kernel, 3000);
    const double tolerance = frequency == 1.0 ? 1.5 : 8.0;
    for (const test::WaveMeter& meter : test::meter(kernel, 1000, -5)) {
      EXPECT_NEAR(meter.highest(), 35, tolerance) << frequency << " Hz";
      EXPECT_NEAR(meter.lowest(), -45, tolerance) << frequency << " Hz";
    }
  }
}

}  // namespace
}  // namespace proleg
