// Oracle: beta + A sin(2 pi f t + n phi), and for the yaw joints the same with its own values and a phase ahead; n
// counts all joints from the head (Tesch et al. 2009, with the wave in this project's direction).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;

constexpr unsigned chain_joints = 8;

class CompoundSerpenoid : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::compound), chain_joints), 0), Status::ok);
    set("pitch_amplitude", test::degrees(20));
    set("pitch_frequency", test::hertz(0.9));
    set("pitch_phase_difference", test::phase(56));
    set("pitch_offset", test::degrees(3));
    set("yaw_amplitude", test::degrees(30));
    set("yaw_frequency", test::hertz(0.6));
    set("yaw_phase_difference", test::phase(-29));
    set("yaw_offset", test::degrees(-7));
    set("yaw_phase", test::phase(45));
  }

  void set(std::string_view name, std::int32_t value) { test::set_all(kernel, 0, name, value); }

  /// Compares the joints with the equation from tick 400 on, when all filters have settled.
  void expect_the_two_waves(unsigned parity, double slope) {
    kernel.reset();
    test::run(kernel, 400);
    for (unsigned tick = 400; tick < 700; ++tick) {
      for (unsigned n = 0; n < chain_joints; ++n) {
        const bool yaw = n % 2 == parity;
        const double turns = (yaw ? 0.6 : 0.9) * tick * 0.01 + ((yaw ? -29.0 : 56.0) * n + (yaw ? 45 : 0)) / 360;
        const double amplitude = std::clamp((yaw ? 30 : 20) + slope * n, 0.0, 90.0);
        const double expected = (yaw ? -7 : 3) + amplitude * std::sin(2 * std::numbers::pi * turns);
        // The phase increment is rounded: 1.2e-10 turns in a tick.
        ASSERT_NEAR(in_degrees(kernel.setpoint(n)), expected, 5e-5) << "tick " << tick << ", joint " << n;
      }
      kernel.advance();
    }
  }

  KernelOf<chain_joints> kernel;
};

TEST_F(CompoundSerpenoid, PlaysAWaveInEachPlane) { expect_the_two_waves(1, 0); }

TEST_F(CompoundSerpenoid, ExchangesThePlanesWithTheParity) {
  set("yaw_parity", 0);
  expect_the_two_waves(0, 0);
}

TEST_F(CompoundSerpenoid, GrowsItsAmplitudesAlongTheBodyAndNeverBelowZero) {
  set("amplitude_slope", test::degrees(-5));
  expect_the_two_waves(1, -5);
}

// Rolling: both planes swing as one, a quarter of a period apart, so that the body bends to an arc that goes round.
TEST_F(CompoundSerpenoid, BendsToAnArcThatRolls) {
  for (const std::string_view plane : {"pitch", "yaw"}) {
    const std::string name(plane);
    set(name + "_amplitude", test::degrees(34));
    set(name + "_frequency", test::hertz(0.5));
    set(name + "_phase_difference", 0);
    set(name + "_offset", 0);
  }
  set("yaw_phase", test::phase(90));
  kernel.reset();
  test::run(kernel, 400);
  for (int tick = 0; tick < 200; ++tick) {
    kernel.advance();
    for (unsigned n = 0; n + 1 < chain_joints; n += 2) {
      EXPECT_NEAR(std::hypot(in_degrees(kernel.setpoint(n)), in_degrees(kernel.setpoint(n + 1))), 34, 1e-4);
    }
  }
}

TEST_F(CompoundSerpenoid, ChangesItsPlanesFrequencyWithoutAJump) {
  kernel.reset();
  test::run(kernel, 413);
  test::commit_all(kernel, 0, "yaw_frequency", test::hertz(1.2), 413);
  for (int tick = 0; tick < 100; ++tick) {
    kernel.advance();
    const double step = in_degrees(kernel.setpoint(1)) - in_degrees(kernel.previous_setpoint(1));
    ASSERT_LE(std::abs(step), 2 * std::numbers::pi * 1.2 * 30 * 0.01 + 1e-3) << "tick " << tick;
  }
}

}  // namespace
}  // namespace proleg
