// Oracle: the closed form of a half-centre. tau s' = +-1 - s between -h and h has half periods of
// tau ln((1 + h) / (1 - h)); with L half a period in time constants, h = tanh(L / 2).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>

#include "robot.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

class HalfCentre : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::half_centre), robot_joints), 0), Status::ok);
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(HalfCentre, HasThePeriodOfTheClosedForm) {
  for (const double frequency : {0.1, 0.37, 1.0, 2.3}) {
    for (const double constants : {0.2, 1.0, 2.5, 4.0}) {
      test::set_all(kernel, 0, "coupling", 0);
      test::set_all(kernel, 0, "frequency", test::hertz(frequency));
      test::set_all(kernel, 0, "fatigue", test::ratio(constants));
      kernel.reset();
      test::run(kernel, 1000);
      const std::vector<test::WaveMeter> meters = test::meter(kernel, 4000);
      // Steep turns between two ticks cost the second order.
      const double tolerance = 0.002 + 0.05 * frequency * 0.01 * constants;
      EXPECT_NEAR(meters[0].period() * 0.01 * frequency, 1, tolerance) << frequency << " Hz, L = " << constants;
    }
  }
}

// The solution from -h at time 0 is s = 1 - (1 + h) exp(-t / tau).
TEST_F(HalfCentre, FollowsTheClosedFormBetweenItsTurns) {
  for (const double constants : {0.5, 2.0, 4.0}) {
    test::set_all(kernel, 0, "coupling", 0);
    test::set_all(kernel, 0, "noise", 0);
    test::set_all(kernel, 0, "fatigue", test::ratio(constants));
    kernel.reset();
    test::run(kernel, 600);
    const double h = std::tanh(constants / 2);
    const double tau = 0.5 / constants;
    double largest = 0;
    for (int tick = 0; tick < 100; ++tick) {
      kernel.advance();
      const double turns = test::value(kernel, 0, 0, "current_phase") / 4294967296.0;
      const bool rises = turns >= -0.25 && turns < 0.25;
      const double since_turn = rises ? turns + 0.25 : (turns > 0 ? turns - 0.25 : turns + 0.75);
      const double level = (1 - (1 + h) * std::exp(-since_turn / tau)) / h;
      largest = std::max(largest, std::abs(in_degrees(kernel.setpoint(0)) - 40 * (rises ? level : -level)));
    }
    std::cout << "L = " << constants << ": within " << largest << " degrees of the closed form\n";
    EXPECT_LE(largest, 0.1) << "L = " << constants;
  }
}

TEST_F(HalfCentre, ReachesItsAmplitudeAndNoMore) {
  test::set_all(kernel, 0, "offset", test::degrees(12));
  kernel.reset();
  test::run(kernel, 1000);
  for (const test::WaveMeter& meter : test::meter(kernel, 1000, 12)) {
    EXPECT_LE(meter.highest(), 52.01);
    EXPECT_GE(meter.highest(), 50.5);
    EXPECT_GE(meter.lowest(), -28.01);
    EXPECT_LE(meter.lowest(), -26.5);
  }
}

TEST_F(HalfCentre, LocksToThePhaseDifferenceFromANoisyStart) {
  for (const double lag : {55.0, -90.0, 120.0}) {
    test::set_all(kernel, 0, "phase_difference", test::phase(lag));
    kernel.reset();
    test::run(kernel, 3000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
    for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
      EXPECT_NEAR(std::remainder(meters[joint + 1].lead_over(meters[joint]) - lag, 360), 0, 1.5)
          << "joint " << joint + 1 << ", wanted " << lag;
      EXPECT_NEAR(meters[joint].period(), 100, 0.5);
    }
  }
}

TEST_F(HalfCentre, KeepsOneHalfActiveAtATime) {
  int changes = 0;
  std::int32_t before = test::value(kernel, 0, 2, "active");
  for (int tick = 0; tick < 1000; ++tick) {
    kernel.advance();
    const std::int32_t active = test::value(kernel, 0, 2, "active");
    ASSERT_TRUE(active == 0 || active == 1);
    changes += active != before ? 1 : 0;
    before = active;
  }
  EXPECT_NEAR(changes, 20, 2) << "two changes in each of ten periods";
}

}  // namespace
}  // namespace proleg
