// The shipped gaits go where docs/gaits.md says. The bounds leave room for other compilers and libraries, whose last
// digits lead to another path.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "shared/fixed/decimal.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"

namespace proleg::sim {
namespace {

/// Measures of the first 20 s.
MeasureValues played(const Scenario& scenario) {
  Simulation simulation(scenario);
  while (simulation.time_s() < 20 - 1e-9) {
    simulation.advance();
  }
  return simulation.measures();
}
MeasureValues played(const std::string& gait) { return played(shipped("gaits/" + gait)); }

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

TEST(ShippedGaits, SerpentineLivesOnFrictionThatIsGreaterSidewaysThanForwards) {
  Scenario scenario = shipped("gaits/serpentine");
  const MeasureValues snake = played(scenario);
  EXPECT_GT(snake[Measure::speed], 0.2);
  EXPECT_LT(std::abs(snake[Measure::heading]), 10.0);
  for (Link& link : scenario.robot.links) {
    for (Geometry& geometry : link.geometries) {
      ASSERT_GT(geometry.friction_across.value(), geometry.friction.value());
      geometry.friction_across.reset();
    }
  }
  EXPECT_LT(played(scenario)[Measure::distance], 0.2 * snake[Measure::distance]) << "the same in every direction";
}

Change change_of(const Scenario& scenario, std::uint32_t tick, unsigned slot, const char* name, double value) {
  Change change;
  change.tick = tick;
  for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
    if (scenario.kernel.slots[slot].group.contains(joint)) {
      const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
      Setting setting;
      setting.slot = static_cast<std::uint8_t>(slot);
      setting.joint = static_cast<std::uint8_t>(joint);
      setting.number = static_cast<std::uint8_t>(find_parameter(declaration, name));
      setting.value = parse_decimal(std::to_string(value), declaration.parameters[setting.number].unit).raw;
      change.settings.push_back(setting);
    }
  }
  return change;
}

// Left, right, faster, another wave, stop: no set-point jumps, whatever changes.
TEST(ShippedGaits, SteeringAndRampsMakeNoJump) {
  Scenario scenario = shipped("gaits/turning");
  scenario.changes = {
      change_of(scenario, 300, 1, "offset", -15.0),           change_of(scenario, 700, 1, "offset", 15.0),
      change_of(scenario, 800, 0, "frequency", 1.3),          change_of(scenario, 900, 0, "amplitude", 20.0),
      change_of(scenario, 1000, 0, "phase_difference", 90.0), change_of(scenario, 1200, 0, "amplitude", 0.0)};
  Simulation simulation(scenario);
  std::vector<std::int32_t> before(simulation.setpoints().begin(), simulation.setpoints().end());
  before.resize(scenario.kernel.joint_count);
  constexpr double degree = quarter_turn / 90.0;
  double largest = 0.0;
  double stopped = 0.0;
  while (simulation.tick() < 1500) {
    simulation.advance();
    for (std::size_t joint = 0; joint < before.size(); ++joint) {
      const double step = std::abs(static_cast<double>(simulation.setpoints()[joint]) - before[joint]) / degree;
      largest = std::max(largest, step);
      stopped = simulation.tick() > 1450 ? std::max(stopped, step) : 0.0;
      before[joint] = simulation.setpoints()[joint];
    }
  }
  // The wave itself moves by 2 pi f A = 3.27 degrees in a tick; the phase shift adds to its frequency.
  EXPECT_LT(largest, 5.0);
  EXPECT_GT(largest, 1.5);
  EXPECT_LT(stopped, 0.01) << "it has come to rest";
}

}  // namespace
}  // namespace proleg::sim
