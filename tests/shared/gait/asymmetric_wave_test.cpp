#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

class AsymmetricWave : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::asymmetric), robot_joints), 0), Status::ok);
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(AsymmetricWave, EqualsTheExtendedSineToTheLastBitWhenItRisesInHalfThePeriod) {
  KernelOf<robot_joints> sine;
  ASSERT_EQ(sine.configure(test::one_slot(test::algorithm(test::extended), robot_joints), 0), Status::ok);
  for (Kernel* each : {static_cast<Kernel*>(&kernel), static_cast<Kernel*>(&sine)}) {
    test::set_all(*each, 0, "amplitude", test::degrees(33.3));
    test::set_all(*each, 0, "frequency", test::hertz(0.77));
    test::set_all(*each, 0, "phase_difference", test::phase(-71));
    test::set_all(*each, 0, "phase", test::phase(12));
    test::set_all(*each, 0, "offset", test::degrees(-7));
    each->reset();
  }
  for (int tick = 0; tick < 2000; ++tick) {
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(kernel.setpoint(joint), sine.setpoint(joint)) << "tick " << tick << ", joint " << joint;
    }
    kernel.advance();
    sine.advance();
  }
}

// The warp of the reference: psi = Theta / (2 d) turns while Theta < d, else 1/2 + (Theta - d) / (2 (1 - d));
// angle = -A cos(2 pi psi). Theta starts at the trough, a quarter of a turn before the sine's 0.
TEST_F(AsymmetricWave, FollowsTheWarpedCosine) {
  for (const double d : {0.2, 0.35, 0.5, 0.8}) {
    test::set_all(kernel, 0, "rising_fraction", test::ratio(d));
    kernel.reset();
    test::run(kernel, 400);
    for (unsigned tick = 400; tick < 600; ++tick) {
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        const double turns = tick * 0.01 + joint * 55.0 / 360 + 0.25;
        const double theta = turns - std::floor(turns);
        const double psi = theta < d ? theta / (2 * d) : 0.5 + (theta - d) / (2 * (1 - d));
        ASSERT_NEAR(in_degrees(kernel.setpoint(joint)), -40 * std::cos(2 * std::numbers::pi * psi), 2e-4)
            << "fraction " << d << ", tick " << tick << ", joint " << joint;
      }
      kernel.advance();
    }
  }
}

TEST_F(AsymmetricWave, RisesForItsFractionOfThePeriod) {
  test::set_all(kernel, 0, "rising_fraction", test::ratio(0.3));
  kernel.reset();
  test::run(kernel, 400);
  int rising = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    kernel.advance();
    rising += kernel.setpoint(2) > kernel.previous_setpoint(2) ? 1 : 0;
  }
  EXPECT_NEAR(rising / 1000.0, 0.3, 0.015);
}

TEST_F(AsymmetricWave, ChangesItsFractionWithoutAJumpAtTheTrough) {
  test::set_all(kernel, 0, "phase_difference", 0);
  kernel.reset();
  test::run(kernel, 475);
  EXPECT_NEAR(in_degrees(kernel.setpoint(0)), -40, 1e-3);
  test::commit_all(kernel, 0, "rising_fraction", test::ratio(0.25), 475);
  test::run(kernel, 1);
  EXPECT_NEAR(in_degrees(kernel.setpoint(0)), -40 * std::cos(2 * std::numbers::pi * 0.01 / 0.5), 1e-3);
}

}  // namespace
}  // namespace proleg
