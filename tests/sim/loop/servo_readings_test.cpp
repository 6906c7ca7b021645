// What a simulated servo draws, and where it is.

#include <gtest/gtest.h>

#include <numbers>

#include "shared/kernel/servo_pulses.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {
namespace {

constexpr ServoCurrent default_current;

double in_radians(std::int32_t angle) { return angle * (std::numbers::pi / 2.0 / quarter_turn); }

TEST(ServoReadings, AreTheActualAnglesAndCurrentsBetweenIdleAndStall) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  double sum_ma = 0.0;
  unsigned count = 0;
  while (simulation.tick() < 500) {
    simulation.advance();
    for (std::size_t joint = 0; joint < scenario.robot.joints.size(); ++joint) {
      const ServoReadings readings = simulation.plant().servo_readings(joint);
      ASSERT_TRUE(readings.angle);
      EXPECT_NEAR(in_radians(*readings.angle), simulation.plant().joint_angles()[joint], 2e-9);
      EXPECT_GE(readings.current_ma, default_current.idle_ma);
      EXPECT_LE(readings.current_ma, default_current.stall_ma);
      EXPECT_EQ(readings.temperature_c, 25);
      sum_ma += readings.current_ma;
      ++count;
    }
  }
  EXPECT_GT(sum_ma / count, 50.0);
  EXPECT_LT(sum_ma / count, 400.0) << "a robot that crawls on the flat is far from stall";
}

TEST(ServoReadings, OfAServoThatIsHeldOrLimp) {
  Scenario scenario = shipped("travelling_wave/uniform");
  for (Joint& joint : scenario.robot.joints) {
    joint.max_torque = 1e-6;  // cannot lift the robot
  }
  Plant plant(scenario);
  EXPECT_EQ(plant.servo_readings(2).current_ma, default_current.idle_ma) << "nothing has happened yet";
  plant.set_command(2, 30'000);
  plant.step();
  EXPECT_NEAR(plant.servo_readings(2).current_ma, default_current.stall_ma, 1.0);
  plant.release(2);
  plant.step();
  EXPECT_EQ(plant.servo_readings(2).current_ma, default_current.idle_ma);
}

}  // namespace
}  // namespace proleg::sim
