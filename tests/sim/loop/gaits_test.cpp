// The gaits that ship, each with the displacement or turn that it must show.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "shared/fixed/decimal.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

MeasureValues measured(const Scenario& scenario) {
  Simulation simulation(scenario);
  while (simulation.tick() < tick_count(scenario)) {
    simulation.advance();
  }
  return simulation.measures();
}

TEST(Gaits, ForwardGoesStraightAhead) {
  const MeasureValues values = measured(shipped("gaits/forward"));
  EXPECT_GT(values[Measure::speed], 0.1);
  EXPECT_LT(std::abs(values[Measure::heading]), 5.0);
}

TEST(Gaits, ReverseGoesAsFarStraightBack) {
  const MeasureValues forward = measured(shipped("gaits/forward"));
  const MeasureValues reverse = measured(shipped("gaits/reverse"));
  EXPECT_NEAR(reverse[Measure::speed], -forward[Measure::speed], 0.1 * forward[Measure::speed]);
  EXPECT_GT(std::abs(reverse[Measure::heading]), 175.0);
}

// Thesis, section 2.5.2: like the caterpillar's, with a smaller amplitude; slow, and the body stays low.
TEST(Gaits, RectilinearIsSlowerAndLowerThanForward) {
  const MeasureValues forward = measured(shipped("gaits/forward"));
  const MeasureValues rectilinear = measured(shipped("gaits/rectilinear"));
  EXPECT_GT(rectilinear[Measure::speed], 0.03);
  EXPECT_LT(rectilinear[Measure::speed], 0.6 * forward[Measure::speed]);
  EXPECT_LT(rectilinear[Measure::potential_energy], 0.6 * forward[Measure::potential_energy]);
}

// Thesis, section 2.4.1: the fastest gait of caterpillars.
TEST(Gaits, BackwardRollTurnsTheBodyOverAndIsFasterThanForward) {
  const Scenario scenario = shipped("gaits/backward_roll");
  Simulation simulation(scenario);
  double turned = 0.0;  // of the middle link, about the axis of its joint
  Eigen::Quaterniond before = simulation.plant().link_poses()[4].orientation;
  while (simulation.tick() < tick_count(scenario)) {
    simulation.advance();
    const Eigen::Quaterniond now = simulation.plant().link_poses()[4].orientation;
    turned += 2.0 * (before.conjugate() * now).vec().x();
    before = now;
  }
  const MeasureValues values = simulation.measures();
  EXPECT_GT(turned / (2.0 * std::numbers::pi), 3.0) << "whole turns, head over tail";
  EXPECT_LT(values[Measure::speed], -0.2) << "backwards";
  EXPECT_GT(values[Measure::distance], measured(shipped("gaits/forward"))[Measure::distance]);
}

TEST(Gaits, TurningTurnsToTheSideOfItsOffset) {
  Scenario scenario = shipped("gaits/turning");
  const MeasureValues left = measured(scenario);
  EXPECT_GT(left[Measure::yaw_rate], 1.5);
  EXPECT_GT(left[Measure::distance], 0.4);
  for (Setting& setting : scenario.settings) {
    const Declaration& declaration = scenario.kernel.slots[setting.slot].algorithm->declaration();
    if (setting.slot == 1 && declaration.parameters[setting.index].name == "offset") {
      setting.value = -setting.value;
    }
  }
  EXPECT_LT(measured(scenario)[Measure::yaw_rate], -1.5);
}

TEST(Gaits, SidewindingGoesSideways) {
  const MeasureValues values = measured(shipped("gaits/sidewinding"));
  EXPECT_GT(std::abs(values[Measure::sideways_speed]), 0.1);
  EXPECT_GT(std::abs(values[Measure::sideways_speed]), 5.0 * std::abs(values[Measure::speed]));
}

TEST(Gaits, SerpentineLivesOnFrictionThatIsGreaterSidewaysThanForwards) {
  Scenario scenario = shipped("gaits/serpentine");
  const MeasureValues snake = measured(scenario);
  EXPECT_GT(snake[Measure::speed], 0.2);
  EXPECT_LT(std::abs(snake[Measure::heading]), 10.0);
  for (Link& link : scenario.robot.links) {
    for (Geometry& geometry : link.geometries) {
      ASSERT_GT(geometry.friction_across.value(), geometry.friction.value());
      geometry.friction_across.reset();
    }
  }
  EXPECT_LT(measured(scenario)[Measure::distance], 0.2 * snake[Measure::distance]) << "the same in every direction";
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
      setting.index = static_cast<std::uint8_t>(find_parameter(declaration, name));
      setting.value = parse_decimal(std::to_string(value), declaration.parameters[setting.index].unit).raw;
      change.settings.push_back(setting);
    }
  }
  return change;
}

// Left, right, faster, another wave, stop: no set-point jumps, whatever changes.
TEST(Gaits, SteeringAndRampsMakeNoJump) {
  Scenario scenario = shipped("gaits/turning");
  scenario.changes = {
      change_of(scenario, 300, 1, "offset", -10.0),           change_of(scenario, 700, 1, "offset", 10.0),
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
  // The wave itself moves by 2 pi f A = 2.45 degrees in a tick; the phase shift adds to its frequency.
  EXPECT_LT(largest, 4.0);
  EXPECT_GT(largest, 1.5);
  EXPECT_LT(stopped, 0.01) << "it has come to rest";
}

}  // namespace
}  // namespace proleg::sim
