// The figures are computed by hand from the equations of the thesis, chapters 2 and 3, for 9.81 m/s^2, a stride of 0.1
// m and a friction of 0.3, and for the thesis's gait of 40 and 30 degrees with 55 degrees of phase difference.

#include "sim/measure/crawling_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace proleg::sim {
namespace {

constexpr double gravity = 9.81;
constexpr double stride = 0.1;
constexpr double friction = 0.3;
constexpr double degree = std::numbers::pi / 180.0;

TEST(CrawlingModels, FrictionAndInertiaCostTheSameAtTheCrossoverSpeed) {
  const double two_anchor = two_anchor_crossover_speed(friction, stride, gravity);
  EXPECT_NEAR(two_anchor, 0.46981, 5e-6);
  CrawlingWork work = two_anchor_work(friction, two_anchor, stride, gravity);
  EXPECT_NEAR(work.friction, 2.943, 1e-9);
  EXPECT_NEAR(work.inertia, work.friction, 1e-9);

  const double peristalsis = peristalsis_crossover_speed(friction, 0.4, stride, gravity);
  EXPECT_NEAR(peristalsis, 0.30688, 5e-6);
  work = peristalsis_work(friction, 0.4, peristalsis, stride, gravity);
  EXPECT_NEAR(work.friction, 2.943, 1e-9);
  EXPECT_NEAR(work.inertia, work.friction, 1e-9);

  const double serpentine = serpentine_crossover_speed(friction, 30 * degree, stride, gravity);
  EXPECT_NEAR(serpentine, 1.00970, 5e-6);
  work = serpentine_work(friction, 30 * degree, serpentine, stride, gravity);
  EXPECT_NEAR(work.friction, 3.39828, 5e-6);
  EXPECT_NEAR(work.inertia, work.friction, 1e-9);
}

TEST(CrawlingModels, InertiaCostsWithTheSquareOfTheSpeedAndFrictionDoesNot) {
  const auto expect_square = [](const CrawlingWork& slow, const CrawlingWork& fast) {
    EXPECT_EQ(fast.friction, slow.friction);
    EXPECT_NEAR(fast.inertia, 9 * slow.inertia, 1e-12);
  };
  expect_square(two_anchor_work(friction, 0.1, stride, gravity), two_anchor_work(friction, 0.3, stride, gravity));
  expect_square(peristalsis_work(friction, 0.4, 0.1, stride, gravity),
                peristalsis_work(friction, 0.4, 0.3, stride, gravity));
  expect_square(serpentine_work(friction, 0.5, 0.1, stride, gravity),
                serpentine_work(friction, 0.5, 0.3, stride, gravity));
}

TEST(CrawlingModels, PropulsionNeedsFrictionThatDiffersByDirection) {
  EXPECT_DOUBLE_EQ(max_moving_share(0.3, 0.3), 0.5);
  EXPECT_DOUBLE_EQ(max_moving_share(0.1, 0.3), 0.75);
  EXPECT_DOUBLE_EQ(min_bend(0.3, 0.3), 45 * degree);
  EXPECT_NEAR(std::tan(min_bend(0.1, 0.4)), 0.25, 1e-12);
}

TEST(BodyWave, ItsNumberIsCountedByJointsOrByLinks) {
  EXPECT_NEAR(wave_count(55 * degree, 5), 0.7639, 5e-5);
  EXPECT_NEAR(wave_count(55 * degree, 6), 0.9167, 5e-5);
  EXPECT_EQ(wave_count(-55 * degree, 5), wave_count(55 * degree, 5));
}

TEST(BodyWave, IsASerpenoidCurve) {
  const double alpha = winding_angle(40 * degree, 55 * degree);
  EXPECT_NEAR(alpha / degree, 43.31, 5e-3);
  EXPECT_EQ(winding_angle(40 * degree, -55 * degree), alpha);
  EXPECT_NEAR(serpenoid_shortening(alpha), 0.86215, 5e-6);
  EXPECT_NEAR(winding_angle(30 * degree, 55 * degree) / degree, 32.49, 5e-3);
  EXPECT_NEAR(serpenoid_shortening(winding_angle(30 * degree, 55 * degree)), 0.92124, 5e-6);
}

// By its definition: the mean of the cosine of the heading along the curve.
TEST(BodyWave, HasTheLengthOfTheCurveDrawnPointByPoint) {
  for (const double alpha : {0.0, 0.1, 0.5, 1.0, 2.0, 2.4}) {
    double sum = 0.0;
    constexpr int points = 1000;
    for (int i = 0; i < points; ++i) {
      sum += std::cos(alpha * std::cos(2 * std::numbers::pi * i / points));
    }
    EXPECT_NEAR(serpenoid_shortening(alpha), sum / points, 1e-12) << alpha;
  }
}

TEST(BodyWave, PredictsTheStepOfTheGaitsOfTheThesis) {
  constexpr double length = 6 * 0.072;
  const auto step = [](double amplitude, double count) {
    return predicted_step_length(length, wave_count(55 * degree, count),
                                 winding_angle(amplitude * degree, 55 * degree));
  };
  EXPECT_NEAR(step(40, 5), 0.0780, 5e-5);
  EXPECT_NEAR(step(40, 6), 0.0650, 5e-5);
  EXPECT_NEAR(step(30, 5), 0.0445, 5e-5);
  EXPECT_NEAR(step(30, 6), 0.0371, 5e-5);
  EXPECT_EQ(step(0, 5), 0.0) << "a straight robot makes no step";
}

}  // namespace
}  // namespace proleg::sim
