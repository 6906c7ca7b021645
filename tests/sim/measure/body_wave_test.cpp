// The figures are computed by hand from the equations of the thesis, for its gait of 40 and 30 degrees with 55 degrees
// of phase difference.

#include "body_wave.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test_units.hpp"

namespace proleg::sim {
namespace {

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
