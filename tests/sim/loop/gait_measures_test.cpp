// The measures of the shipped gaits, against theory and other calculations from the same run.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "sim/measure/stride.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

void run_on(Simulation& simulation, double seconds) {
  while (simulation.time_s() < seconds - 1e-9) {
    simulation.advance();
  }
}

MeasureValues measured(const Scenario& scenario, double seconds) {
  Simulation simulation(scenario);
  run_on(simulation, seconds);
  return simulation.measures();
}

TEST(GaitMeasures, AreUndefinedBeforeTheFirstTickAndDefinedAfterTheGaitHasStarted) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  const MeasureValues start = simulation.measures();
  for (const double value : start.all()) {
    EXPECT_TRUE(std::isnan(value));
  }
  run_on(simulation, 3);
  const MeasureValues values = simulation.measures();
  for (const MeasureDeclaration& declaration : measures()) {
    EXPECT_TRUE(std::isfinite(values[declaration.measure])) << declaration.name;
  }
}

// Thesis, equation 3.2: the step of a wave that does not slip. No gait of this wave exceeds it; on a flat floor with
// the shipped friction the robot reaches more than half of it.
TEST(GaitMeasures, TheTravellingWaveTakesMoreThanHalfOfThePredictedStep) {
  constexpr double degree = std::numbers::pi / 180.0;
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  run_on(simulation, 30);
  const MeasureValues values = simulation.measures();
  // Five joints, 55 degrees apart, swing by 40 degrees; the chain of four whole and two half links is 360 mm long.
  const double predicted =
      predicted_step_length(0.360, wave_count(55 * degree, 5), winding_angle(40 * degree, 55 * degree));
  EXPECT_LT(values[Measure::stride_length], predicted);
  EXPECT_GT(values[Measure::stride_length], 0.5 * predicted);
  EXPECT_NEAR(values[Measure::stride_frequency], 1.0, 1e-3);
  EXPECT_NEAR(values[Measure::wave_count], 0.7639, 5e-4) << "thesis, section 6.2, footnote 8";
  EXPECT_NEAR(values[Measure::predicted_distance], 30 * predicted, 0.02);
  EXPECT_EQ(values[Measure::distance], simulation.plant().displacement());
  EXPECT_NEAR(values[Measure::stride_length], values[Measure::distance] / 30, 1e-4);
  EXPECT_NEAR(values[Measure::froude_number],
              std::pow(values[Measure::distance] / 30, 2) / 9.81 / values[Measure::stride_length], 1e-9);
}

TEST(GaitMeasures, ADistanceIsPredictedOnlyWhereTheEquationHolds) {
  const auto predicted = [](const char* name, const std::vector<std::string>& settings) {
    Scenario scenario = shipped(name);
    for (const std::string& setting : settings) {
      apply_setting(scenario, setting);
    }
    Simulation simulation(scenario);
    run_on(simulation, 5);
    return simulation.measures()[Measure::predicted_distance];
  };
  EXPECT_TRUE(std::isfinite(predicted("travelling_wave/uniform", {})));
  // Five joints: half a wave at 36 degrees.
  EXPECT_TRUE(std::isfinite(predicted("travelling_wave/uniform", {"phase_difference=37"})));
  EXPECT_TRUE(std::isnan(predicted("travelling_wave/uniform", {"phase_difference=35"})));
  EXPECT_TRUE(std::isnan(predicted("travelling_wave/uniform", {"phase_difference=1"})));
  // 70 degrees, 37 degrees apart: 110 degrees of winding angle.
  EXPECT_TRUE(std::isnan(predicted("travelling_wave/uniform", {"phase_difference=37", "amplitude=70"})));
  EXPECT_TRUE(std::isnan(predicted("gaits/serpentine", {}))) << "its joints bend it to the sides";
}

// Anchors that hold better slip less.
TEST(GaitMeasures, SlipFallsWithFriction) {
  double before = std::numeric_limits<double>::infinity();
  for (const double friction : {0.1, 0.3, 0.9}) {
    Scenario scenario = shipped("travelling_wave/uniform");
    scenario.environment.objects[0].geometries[0].friction = friction;
    for (Link& link : scenario.robot.links) {
      for (Geometry& geometry : link.geometries) {
        geometry.friction = friction;
      }
    }
    const double slip = measured(scenario, 10)[Measure::slip];
    EXPECT_GT(slip, 0.0);
    EXPECT_LT(slip, before) << "friction " << friction;
    before = slip;
  }
}

TEST(GaitMeasures, AGaitThatIsTooFastForTheServosShowsInTheTracking) {
  Scenario scenario = shipped("travelling_wave/uniform");
  const MeasureValues slow = measured(scenario, 5);
  EXPECT_LT(slow[Measure::at_speed_limit], 0.1) << "40 degrees at 1 Hz need 4.39 rad/s, the servos have 4.5";
  apply_setting(scenario, "frequency=2");
  const MeasureValues fast = measured(scenario, 5);
  EXPECT_GT(fast[Measure::at_speed_limit], 0.5) << "8.8 rad/s";
  EXPECT_GT(fast[Measure::tracking_error], 2 * slow[Measure::tracking_error]);
}

TEST(GaitMeasures, EnergiesLieBetweenWhatPhysicsAndTheServosAllow) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  const MeasureValues values = measured(scenario, 10);
  double power = 0.0;  // W, of all motors at full power
  double mass = 0.0;
  for (const Joint& joint : scenario.robot.joints) {
    power += joint.max_torque * joint.max_speed;
  }
  for (const Link& link : scenario.robot.links) {
    mass += link.mass.mass;
  }
  // A crawler works against the friction of its floor, since its links slide forth and back.
  EXPECT_GT(values[Measure::mechanical_energy], 0.1 * mass * 9.81 * values[Measure::distance]);
  EXPECT_LT(values[Measure::mechanical_energy], 10 * power);
  EXPECT_GT(values[Measure::electrical_energy], 10 * 5 * 6 * 0.010);
  EXPECT_LT(values[Measure::electrical_energy], 10 * 5 * 6 * 1.5);
  EXPECT_NEAR(values[Measure::cost_of_transport] * mass * values[Measure::distance], values[Measure::mechanical_energy],
              1e-9);
  EXPECT_NEAR(values[Measure::specific_resistance] * 9.81, values[Measure::cost_of_transport], 1e-9);
}

TEST(GaitMeasures, CurrentsOfTheTicksAddUpToTheElectricalEnergyAndTorquesStayWithinTheMotors) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  double charge = 0.0;  // A s
  double largest_torque = 0.0;
  while (simulation.tick() < 300) {
    simulation.advance();
    const TickSample sample = simulation.sample();
    for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
      charge += sample.servo_currents[joint] * 1e-3 * 0.01;
      largest_torque = std::max(largest_torque, std::abs(sample.motor_torques[joint]));
    }
  }
  const double energy = simulation.measures()[Measure::electrical_energy];
  EXPECT_NEAR(charge * 6.0, energy, 1e-9 * energy);
  EXPECT_LE(largest_torque, 0.4 + 1e-12);
  EXPECT_GT(largest_torque, 0.1);
}

TEST(GaitMeasures, EnergiesOfTheBodyAddUpToThatOfTheWorld) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  double sum = 0.0;
  int ticks = 0;
  while (simulation.time_s() < 5.0 - 1e-9) {
    simulation.advance();
    sum += simulation.plant().energy_balance().stored;
    ++ticks;
  }
  const MeasureValues values = simulation.measures();
  const double both = values[Measure::potential_energy] + values[Measure::kinetic_energy];
  // The engine's kinetic energy is that at the end of a tick, the measure's that of the tick's mean velocity.
  EXPECT_NEAR(both, sum / ticks, 0.02 * sum / ticks);
  EXPECT_GT(values[Measure::kinetic_energy], 0.0);
  EXPECT_GT(values[Measure::elastic_energy], 0.0);
  EXPECT_GE(values[Measure::largest_acceleration], values[Measure::smoothness]);
  EXPECT_NEAR(values[Measure::lifted_links], 6 * (1 - values[Measure::duty_factor]), 1e-9);
}

TEST(GaitMeasures, EnergiesNeverDecrease) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  Simulation simulation(scenario);
  double mechanical = 0.0;
  double electrical = 0.0;
  for (int i = 0; i < 200; ++i) {
    simulation.advance();
    const MeasureValues values = simulation.measures();
    EXPECT_GE(values[Measure::mechanical_energy], mechanical);
    EXPECT_GT(values[Measure::electrical_energy], electrical);
    mechanical = values[Measure::mechanical_energy];
    electrical = values[Measure::electrical_energy];
  }
}

TEST(GaitMeasures, AWaveInTheOtherDirectionCrawlsBackwards) {
  Scenario scenario = shipped("travelling_wave/uniform");
  const double forwards = measured(scenario, 5)[Measure::speed];
  apply_setting(scenario, "phase_difference=-55");
  const MeasureValues backwards = measured(scenario, 5);
  EXPECT_GT(forwards, 0.02);
  EXPECT_LT(backwards[Measure::speed], -0.02);
}

TEST(GaitMeasures, SpeedFollowsTheHeading) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  run_on(simulation, 5);
  const auto speed = [&](double heading) { return simulation.measures(heading)[Measure::speed]; };
  EXPECT_NEAR(speed(180), -speed(0), 1e-12);
  EXPECT_NEAR(speed(-90), -speed(90), 1e-12);
  EXPECT_NEAR(std::hypot(speed(0), speed(90)), simulation.plant().displacement() / 5, 1e-12);
  EXPECT_LT(std::abs(speed(90)), 0.1 * speed(0)) << "with pitch joints alone it crawls straight ahead";
}

TEST(GaitMeasures, DoNotDependOnTheDirectionOfTheRobotAtTheStart) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  const MeasureValues expected = measured(scenario, 5);
  for (const double heading : {45.0, 90.0, 200.0}) {
    Scenario turned_scenario = scenario;
    turned_scenario.environment.robot_pose.orientation =
        Eigen::Quaterniond(Eigen::AngleAxisd(heading * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ())) *
        scenario.environment.robot_pose.orientation;
    const MeasureValues turned = measured(turned_scenario, 5);
    for (const Measure measure : {Measure::distance, Measure::speed, Measure::mechanical_energy,
                                  Measure::electrical_energy, Measure::smoothness}) {
      EXPECT_NEAR(turned[measure], expected[measure], 0.01 * expected[measure])
          << declaration_of(measure).name << " at " << heading << " degrees";
    }
    EXPECT_NEAR(turned[Measure::stability_margin], expected[Measure::stability_margin], 0.005) << "sensors flicker";
  }
}

TEST(GaitMeasures, ARobotTwiceAsHeavyWithMotorsTwiceAsStrongNeedsTwiceTheEnergy) {
  Scenario scenario = shipped("travelling_wave/uniform");
  const MeasureValues light = measured(scenario, 1);
  for (Link& link : scenario.robot.links) {
    link.mass.mass *= 2;
    link.mass.inertia *= 2;
  }
  for (Joint& joint : scenario.robot.joints) {
    joint.max_torque *= 2;
  }
  const MeasureValues heavy = measured(scenario, 1);
  EXPECT_NEAR(heavy[Measure::mechanical_energy], 2 * light[Measure::mechanical_energy],
              0.01 * light[Measure::mechanical_energy]);
  EXPECT_NEAR(heavy[Measure::cost_of_transport], light[Measure::cost_of_transport],
              0.02 * light[Measure::cost_of_transport]);
}

TEST(GaitMeasures, DutyFactorsAreThoseOfTheContacts) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  std::vector<std::vector<bool>> contacts;
  while (simulation.tick() < 500) {
    simulation.advance();
    contacts.emplace_back();
    for (const std::uint8_t sensors : simulation.plant().link_contacts()) {
      contacts.back().push_back(sensors != 0);
    }
  }
  const std::vector<double> factors = simulation.link_duty_factors();
  ASSERT_EQ(factors.size(), 6U);
  const auto stride = simulation.plant().meter().stride();
  ASSERT_TRUE(stride);
  EXPECT_NEAR(static_cast<double>(stride->end_tick - stride->first_tick), 300, 100.5) << "whole strides of 100 ticks";
  double sum = 0.0;
  for (std::size_t link = 0; link < 6; ++link) {
    double expected = 0.0;
    for (std::size_t tick = stride->first_tick; tick < stride->end_tick; ++tick) {
      expected += contacts[tick][link] ? 1.0 : 0.0;
    }
    expected /= static_cast<double>(stride->end_tick - stride->first_tick);
    EXPECT_NEAR(factors[link], expected, 1e-12) << "link " << link;
    sum += factors[link];
  }
  EXPECT_NEAR(simulation.measures()[Measure::duty_factor], sum / 6, 1e-12);
}

}  // namespace
}  // namespace proleg::sim
