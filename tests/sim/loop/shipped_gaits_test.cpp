// The shipped gaits go where docs/gaits.md says. The bounds leave room for other compilers and libraries, whose last
// digits lead to another path.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"

namespace proleg::sim {
namespace {

/// Measures of the first 20 s.
MeasureValues played(const std::string& gait) {
  Simulation simulation(shipped("gaits/" + gait));
  while (simulation.time_s() < 20 - 1e-9) {
    simulation.advance();
  }
  return simulation.measures();
}

/// Deviation of the direction of travel from a heading, in degrees.
double beside(const MeasureValues& values, double heading) {
  return std::abs(std::remainder(values[Measure::heading] - heading, 360));
}

TEST(ShippedGaits, ForwardAndReverseAreTheSameWaveInBothDirections) {
  const MeasureValues forward = played("forward");
  const MeasureValues reverse = played("reverse");
  EXPECT_NEAR(forward[Measure::distance], 1.13, 0.15);
  EXPECT_LT(beside(forward, 0), 2);
  EXPECT_NEAR(reverse[Measure::distance], 1.13, 0.15);
  EXPECT_LT(beside(reverse, 180), 2);
}

TEST(ShippedGaits, RectilinearGoesStraightWithHalfOfTheAmplitude) {
  const MeasureValues values = played("rectilinear");
  EXPECT_NEAR(values[Measure::distance], 0.67, 0.1);
  EXPECT_LT(beside(values, 0), 2);
}

// Caterpillars escape by rolling, their fastest gait (thesis, section 2.3).
TEST(ShippedGaits, TheBackwardRollGoesBackThreeTimesAsFastAsTheWave) {
  const MeasureValues values = played("backward_roll");
  EXPECT_GT(values[Measure::distance], 3 * 1.13);
  EXPECT_LT(beside(values, 180), 5);
}

TEST(ShippedGaits, TurningGoesAroundAnArcToTheLeft) {
  const MeasureValues values = played("turning");
  EXPECT_NEAR(values[Measure::yaw_rate], 4.9, 0.8);
  EXPECT_GT(values[Measure::distance], 0.8);
}

TEST(ShippedGaits, SidewindingAndRollingGoToTheLeft) {
  for (const std::string gait : {"sidewinding", "rolling"}) {
    const MeasureValues values = played(gait);
    EXPECT_GT(values[Measure::distance], gait == "rolling" ? 1.4 : 2.5) << gait;
    EXPECT_LT(beside(values, 90), 15) << gait;
  }
}

// From a random start: the time to find the wave is part of the way.
TEST(ShippedGaits, EveryNetworkOfOscillatorsCrawlsForward) {
  const struct {
    std::string gait;
    double distance;
  } gaits[] = {{"asymmetric", 0.9},  {"hopf", 0.9},      {"matsuoka", 0.7},
               {"half_centre", 0.6}, {"push_pull", 0.7}, {"mtran", 0.35}};
  for (const auto& [gait, distance] : gaits) {
    const MeasureValues values = played(gait);
    EXPECT_GT(values[Measure::distance], distance) << gait;
    EXPECT_LT(beside(values, 0), 5) << gait;
  }
}

}  // namespace
}  // namespace proleg::sim
