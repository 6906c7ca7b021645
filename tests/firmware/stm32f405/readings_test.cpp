// Conversion of readings of the ADC, compared with the straight lines in floating point, for every possible reading.

#include "firmware/stm32f405/readings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace proleg::stm32f405 {
namespace {

TEST(ReadingsTest, TheCurrentIsOneVoltPerAmpereToTheNearestMilliampere) {
  for (std::uint32_t reading = 0; reading <= 4095; ++reading) {
    EXPECT_EQ(current_of(reading), std::lround(reading * 3300.0 / 4095.0)) << reading;
  }
  EXPECT_EQ(current_of(4095), 3300);
}

TEST(ReadingsTest, TheTemperatureIsOnTheLineThroughTheFactorysTwoPoints) {
  constexpr TemperatureCalibration calibration{943, 1195};  // a typical chip
  EXPECT_EQ(temperature_of(943, calibration), 30);
  EXPECT_EQ(temperature_of(1195, calibration), 110);
  for (std::uint32_t reading = 0; reading <= 4095; ++reading) {
    const double exact = 30.0 + (reading - 943.0) * 80.0 / 252.0;
    EXPECT_EQ(temperature_of(reading, calibration), std::lround(std::clamp(exact, -128.0, 127.0))) << reading;
  }
}

TEST(ReadingsTest, AChipWithoutCalibrationHasNoTemperature) {
  EXPECT_EQ(temperature_of(1000, {0xFFFF, 0xFFFF}), -128);
  EXPECT_EQ(temperature_of(1000, {}), -128);
  EXPECT_EQ(temperature_of(1000, {1195, 943}), -128);
}

class FeedbackTest : public testing::TestWithParam<std::pair<std::uint16_t, std::uint16_t>> {};

TEST_P(FeedbackTest, TheAngleIsOnTheLineThroughTheRecordsTwoPoints) {
  const auto [minus, plus] = GetParam();
  EXPECT_EQ(feedback_angle_of(minus, minus, plus), -(1 << 30));
  EXPECT_EQ(feedback_angle_of(plus, minus, plus), 1 << 30);
  for (std::uint32_t reading = 0; reading <= 4095; ++reading) {
    const double fraction = (double(reading) - minus) / (double(plus) - minus);
    const double exact = std::clamp((2.0 * fraction - 1.0) * (1 << 30), double(std::numeric_limits<int>::min()),
                                    double(std::numeric_limits<int>::max()));
    EXPECT_NEAR(feedback_angle_of(reading, minus, plus), exact, 0.5001) << reading;
  }
}

INSTANTIATE_TEST_SUITE_P(Potentiometers, FeedbackTest,
                         testing::Values(std::pair{600, 3500}, std::pair{3500, 600}, std::pair{0, 4095},
                                         std::pair{4095, 0}, std::pair{2000, 2001}, std::pair{2001, 2000}));

}  // namespace
}  // namespace proleg::stm32f405
