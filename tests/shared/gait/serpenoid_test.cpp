// Oracle: Hirose's serpenoid curve. Link l has the heading alpha cos(2 pi f t - l b), b = 2 pi k / M; a joint is the
// difference of the headings of its links.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;

constexpr unsigned snake_joints = 8;
using std::numbers::pi;

class Serpenoid : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::serpenoid), snake_joints), 0), Status::ok);
  }

  void set(std::string_view name, std::int32_t value) { test::set_all(kernel, 0, name, value); }

  KernelOf<snake_joints> kernel;
};

double heading(double alpha, double waves, unsigned link, double seconds, double frequency, unsigned joint_count) {
  return alpha * std::cos(2 * pi * (frequency * seconds - link * waves / joint_count));
}

TEST_F(Serpenoid, BendsTheLinksToTheCurve) {
  for (const double waves : {1.0, 1.5, -0.75, 3.0}) {
    set("winding_angle", test::degrees(40));
    set("waves", test::ratio(waves));
    set("frequency", test::hertz(0.5));
    set("turn", test::degrees(-6));
    kernel.reset();
    test::run(kernel, 400);
    for (unsigned tick = 400; tick < 700; ++tick) {
      for (unsigned joint = 0; joint < snake_joints; ++joint) {
        const double expected = heading(40, waves, joint + 1, tick * 0.01, 0.5, snake_joints) -
                                heading(40, waves, joint, tick * 0.01, 0.5, snake_joints) - 6;
        ASSERT_NEAR(in_degrees(kernel.setpoint(joint)), expected, 2e-4)
            << waves << " waves, tick " << tick << ", joint " << joint;
      }
      kernel.advance();
    }
  }
}

// A robot that pitches and yaws has its curve in one plane: the wave is on the joints of that plane.
TEST_F(Serpenoid, CountsTheJointsOfItsGroupOnly) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::serpenoid), snake_joints);
  configuration.slots[0].group = JointMask(0b10101010);
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  test::run(kernel, 400);
  for (unsigned rank = 0; rank < 4; ++rank) {
    const double expected = heading(40, 1, rank + 1, 4, 1, 4) - heading(40, 1, rank, 4, 1, 4);
    EXPECT_NEAR(in_degrees(kernel.setpoint(2 * rank + 1)), expected, 2e-4) << "joint " << 2 * rank + 1;
    EXPECT_EQ(kernel.setpoint(2 * rank), 0);
  }
}

TEST_F(Serpenoid, BendsNoJointBeyondNinetyDegrees) {
  set("winding_angle", test::degrees(90));
  set("waves", test::ratio(4));  // b / 2 is a right angle: the joints would bend by 180 degrees
  kernel.reset();
  test::run(kernel, 400);
  for (unsigned joint = 0; joint < snake_joints; ++joint) {
    EXPECT_LE(test::value(kernel, 0, joint, "current_amplitude"), quarter_turn);
  }
}

// Between two ticks a joint of amplitude A moves by at most 2 pi f A dt; the change of a parameter adds its ramp.
TEST_F(Serpenoid, TurnsWithoutAJump) {
  test::run(kernel, 400);
  test::commit_all(kernel, 0, "turn", test::degrees(20), 400);
  const double amplitude = 2 * 40 * std::sin(pi / snake_joints);
  const double largest_of_ramp = 20 * 10 / std::numbers::e * 0.01;  // slope R a / (2 e)
  for (int tick = 0; tick < 200; ++tick) {
    kernel.advance();
    for (unsigned joint = 0; joint < snake_joints; ++joint) {
      const double step = in_degrees(kernel.setpoint(joint)) - in_degrees(kernel.previous_setpoint(joint));
      ASSERT_LE(std::abs(step), 2 * pi * amplitude * 0.01 + largest_of_ramp + 1e-3) << "tick " << tick;
    }
  }
  EXPECT_NEAR(in_degrees(test::value(kernel, 0, 3, "current_offset")), 20, 1e-3);
}

}  // namespace
}  // namespace proleg
