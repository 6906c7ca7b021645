// The figures are computed by hand from the equations of the thesis, for its gait of 40 and 30 degrees with 55 degrees
// of phase difference.

#include "sim/measure/stride.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

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

/// Target angles of joints: amplitude * sin(2 pi f t + joint * phase difference), in ticks of 10 ms.
std::vector<double> wave_angles(const std::vector<double>& amplitudes, double phase_difference, double frequency,
                                int ticks) {
  std::vector<double> angles;
  for (int tick = 1; tick <= ticks; ++tick) {
    for (std::size_t joint = 0; joint < amplitudes.size(); ++joint) {
      angles.push_back(amplitudes[joint] * std::sin(2 * std::numbers::pi * frequency * tick * 0.01 +
                                                    static_cast<double>(joint) * phase_difference));
    }
  }
  return angles;
}

TEST(BodyWave, IsFoundInTheAnglesOfJoints) {
  const std::vector<std::size_t> joints{0, 1, 2, 3, 4};
  for (const double difference : {-120.0, -55.0, -5.0, 30.0, 90.0, 170.0}) {
    const std::vector<double> angles = wave_angles({0.7, 0.7, 0.7, 0.7, 0.7}, difference * degree, 1.0, 1000);
    const SignalTable table{angles, 5};
    const std::optional<Stride> stride = find_stride(table, 0.01);
    ASSERT_TRUE(stride);
    const std::optional<BodyWave> wave = find_body_wave(table, joints, *stride, 0.01);
    ASSERT_TRUE(wave);
    EXPECT_NEAR(wave->phase_difference / degree, difference, 0.05);
    EXPECT_NEAR(wave->amplitude, 0.7, 0.002);
    EXPECT_EQ(wave->joints, 5U);
  }
}

TEST(BodyWave, LeavesOutAJointAtRestAndJointsOfAnotherPlane) {
  const std::vector<double> angles = wave_angles({0.5, 0.5, 0.0, 0.5, 0.5}, 40 * degree, 1.3, 1000);
  const SignalTable table{angles, 5};
  const std::optional<Stride> stride = find_stride(table, 0.01);
  ASSERT_TRUE(stride);
  const std::vector<std::size_t> all{0, 1, 2, 3, 4};
  EXPECT_NEAR(find_body_wave(table, all, *stride, 0.01)->phase_difference / degree, 40, 0.3);
  EXPECT_NEAR(find_body_wave(table, all, *stride, 0.01)->amplitude, 0.4, 0.004) << "the mean of all five";
  const std::vector<std::size_t> every_second{1, 3};
  EXPECT_NEAR(find_body_wave(table, every_second, *stride, 0.01)->phase_difference / degree, 80, 0.3);
}

TEST(BodyWave, IsNoneForOneJointOrJointsAtRest) {
  const std::vector<double> angles = wave_angles({0.5, 0.0, 0.0}, 0.7, 1.0, 500);
  const SignalTable table{angles, 3};
  const std::optional<Stride> stride = find_stride(table, 0.01);
  ASSERT_TRUE(stride);
  EXPECT_FALSE(find_body_wave(table, std::vector<std::size_t>{0}, *stride, 0.01));
  EXPECT_FALSE(find_body_wave(table, std::vector<std::size_t>{1, 2}, *stride, 0.01));
}

}  // namespace
}  // namespace proleg::sim
