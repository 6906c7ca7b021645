#include "tools/proleg/ui/driven_robot.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

namespace proleg::tools {
namespace {

constexpr std::int32_t degree = (1 << 30) / 90;
constexpr std::uint32_t period_us = 10'000;

std::vector<AngleLimits> limits(std::size_t joints) {
  return std::vector<AngleLimits>(joints, {-60 * degree, 60 * degree});
}

TEST(JointTargets, GoToTheirGoalsInTheTimeThatTheSpeedTakes) {
  JointTargets targets(limits(2), period_us);
  targets.place(0, 10 * degree);
  targets.go_to(0, 40 * degree, 60.0);
  for (int tick = 0; tick < 49; ++tick) {
    targets.advance();
  }
  EXPECT_NEAR(targets.positions()[0], 39.4 * degree, degree * 0.01);
  targets.advance();
  targets.advance();
  EXPECT_EQ(targets.positions()[0], 40 * degree);
  EXPECT_EQ(targets.positions()[1], 0) << "a joint without a goal stays";
}

TEST(JointTargets, StayWithinTheLimits) {
  JointTargets targets(limits(2), period_us);
  targets.go_to(0, 90 * degree, 180.0);
  targets.go_to(1, -90 * degree, 180.0);
  for (int tick = 0; tick < 100; ++tick) {
    targets.advance();
  }
  EXPECT_EQ(targets.positions()[0], 60 * degree);
  EXPECT_EQ(targets.positions()[1], -60 * degree);
}

TEST(JointTargets, NoTickMovesAJointFasterThanItsSpeed) {
  std::mt19937 random(20261122);
  JointTargets targets(limits(3), period_us);
  std::vector<double> speeds(3, 1.0);
  for (int tick = 0; tick < 10'000; ++tick) {
    const unsigned joint = random() % 3;
    if (random() % 10 == 0) {
      speeds[joint] = 1.0 + random() % 180;
      targets.go_to(joint, static_cast<std::int32_t>(random()), speeds[joint]);
    }
    const std::vector<std::int32_t> before(targets.positions().begin(), targets.positions().end());
    targets.advance();
    for (unsigned i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(std::int64_t{targets.positions()[i]} - before[i]), speeds[i] * 0.01 * (1 << 30) / 90.0);
    }
  }
}

TEST(JointTargets, HaltWhereTheyAre) {
  JointTargets targets(limits(1), period_us);
  targets.go_to(0, 50 * degree, 100.0);
  targets.advance();
  const std::int32_t position = targets.positions()[0];
  targets.halt();
  targets.advance();
  EXPECT_EQ(targets.positions()[0], position);
}

TEST(JointTargets, EachJointThatMovesGetsItsTurn) {
  JointTargets targets(limits(60), period_us);
  for (unsigned joint = 0; joint < 60; ++joint) {
    targets.go_to(joint, 50 * degree, 10.0);
  }
  std::multiset<unsigned> turns;
  for (int tick = 0; tick < 60; ++tick) {
    targets.advance();
    const std::vector<unsigned> moved = targets.take_moved(16);
    EXPECT_EQ(moved.size(), 16U);
    turns.insert(moved.begin(), moved.end());
  }
  for (unsigned joint = 0; joint < 60; ++joint) {
    EXPECT_EQ(turns.count(joint), 16U);
  }
}

TEST(JointTargets, AJointThatHasComeIsTakenOnce) {
  JointTargets targets(limits(2), period_us);
  targets.go_to(1, degree / 100, 180.0);
  targets.advance();
  EXPECT_EQ(targets.take_moved(16), (std::vector<unsigned>{1}));
  targets.advance();
  EXPECT_TRUE(targets.take_moved(16).empty());
}

}  // namespace
}  // namespace proleg::tools
