#include "host/remote/bound_elements.hpp"

#include <gtest/gtest.h>

#include "obedient_robot.hpp"

namespace proleg::host {
namespace {

ParameterBinding binding(double lower, double upper, double step) {
  return {{"amplitude"}, lower, upper, step, 0, 1, true};
}

double value_at(const ParameterBinding& binding, double position) {
  return linear_value(binding, ElementKind::axis, position);
}

TEST(LinearMethod, GoesFromTheLowerToTheUpperLimit) {
  EXPECT_EQ(value_at(binding(10, 50, 1), -1), 10);
  EXPECT_EQ(value_at(binding(10, 50, 1), 0), 30);
  EXPECT_EQ(value_at(binding(10, 50, 1), 1), 50);
  EXPECT_EQ(value_at(binding(50, 10, 1), -1), 50);
  EXPECT_EQ(linear_value(binding(10, 50, 1), ElementKind::button, 0), 10);
  EXPECT_EQ(linear_value(binding(10, 50, 1), ElementKind::button, 1), 50);
}

TEST(LinearMethod, RoundsToStepsFromTheLowerLimit) {
  EXPECT_EQ(stepped_value(binding(1, 10, 2), 5.9), 5);
  EXPECT_EQ(stepped_value(binding(1, 10, 2), 6.1), 7);
  EXPECT_EQ(stepped_value(binding(10, 1, 2), 5.2), 6);
}

TEST(LinearMethod, ReachesTheUpperLimitAlsoWithinAStep) {
  EXPECT_EQ(stepped_value(binding(0, 10, 3), 10), 10);
  EXPECT_EQ(stepped_value(binding(0, 10, 3), 9.6), 10);
  EXPECT_EQ(stepped_value(binding(0, 10, 3), 9.4), 9);
}

TEST(LinearMethod, HasADeadZoneWithoutAJumpBeyondIt) {
  ParameterBinding dead = binding(-1, 1, 0.01);
  dead.dead_zone = 0.2;
  EXPECT_EQ(value_at(dead, 0.2), 0);
  EXPECT_EQ(value_at(dead, -0.2), 0);
  EXPECT_NEAR(value_at(dead, 0.6), 0.5, 1e-12);
  EXPECT_EQ(value_at(dead, 1), 1);
}

TEST(LinearMethod, IsFinerInTheMiddleWithACurve) {
  ParameterBinding curved = binding(-1, 1, 0.01);
  curved.curve = 2;
  EXPECT_NEAR(value_at(curved, 0.5), 0.25, 1e-12);
  EXPECT_NEAR(value_at(curved, -0.5), -0.25, 1e-12);
  EXPECT_EQ(value_at(curved, 1), 1);
}

class Motion : public testing::Test {
 protected:
  Motion() { robot.values["amplitude"] = 30; }
  /// The value after a movement; nothing: no change.
  std::optional<double> move(double position, bool begins = false) {
    const auto values = motion.move(position, begins, robot);
    if (values.empty()) {
      return std::nullopt;
    }
    robot.values["amplitude"] = values[0].value;
    return values[0].value;
  }

  ObedientRobot robot;
  ParameterMotion motion{binding(0, 100, 1), ElementKind::axis};
};

TEST_F(Motion, HasNoEffectUntilItPassesThePresentValue) {
  motion.place(-1);
  EXPECT_EQ(move(-0.9), std::nullopt);  // 5
  EXPECT_EQ(move(-0.5), std::nullopt);  // 25
  EXPECT_EQ(motion.taken(), std::vector<bool>{false});
  EXPECT_EQ(move(-0.3), 35);  // past 30
  EXPECT_EQ(motion.taken(), std::vector<bool>{true});
  EXPECT_EQ(move(-0.9), 5);
}

TEST_F(Motion, PassesAlsoFromAbove) {
  motion.place(1);
  EXPECT_EQ(move(0), std::nullopt);
  EXPECT_EQ(move(-0.5), 25);
}

TEST_F(Motion, LosesAParameterThatSomebodyElseHasChangedWhileItRested) {
  motion.place(-0.4);
  EXPECT_EQ(move(-0.38), 31);
  robot.values["amplitude"] = 80;
  EXPECT_EQ(move(-0.2, true), std::nullopt);
  EXPECT_EQ(move(0.7), 85);
}

TEST_F(Motion, ChangesNothingWithinAStep) {
  motion.place(-0.4);
  EXPECT_EQ(move(-0.38), 31);
  EXPECT_EQ(move(-0.379), std::nullopt);
  EXPECT_EQ(move(-0.369), std::nullopt);  // 31.55: nearer to 32, but a hand trembles
  EXPECT_EQ(move(-0.366), 32);
}

TEST_F(Motion, MovesWithoutTakeUpAtOnce) {
  ParameterBinding direct = binding(0, 100, 1);
  direct.take_up = false;
  motion = ParameterMotion(direct, ElementKind::axis);
  motion.place(-1);
  EXPECT_EQ(move(-0.9), 5);
}

TEST_F(Motion, HasNoEffectWhereItIsPlaced) {
  motion.place(-0.4);
  EXPECT_EQ(motion.value(), 30);
  EXPECT_EQ(move(-0.4), std::nullopt);
}

}  // namespace
}  // namespace proleg::host
