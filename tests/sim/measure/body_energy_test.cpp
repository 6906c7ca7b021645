// Energies of motions that can be computed by hand.

#include "sim/measure/gait_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_robot.hpp"

namespace proleg::sim {
namespace {

constexpr double tick_length_s = 0.01;

std::vector<Pose> moved_links(const RobotModel& robot, const Pose& motion) {
  std::vector<Pose> poses;
  for (const Link& link : robot.links) {
    poses.push_back(motion * link.pose);
  }
  return poses;
}

TEST(BodyEnergy, OfARobotThatMovesWithoutTurningIsThatOfItsMass) {
  const RobotModel robot = straight_robot(3);  // 0.3 kg
  BodyEnergy energy(robot, {}, 9.81, tick_length_s);
  for (int tick = 1; tick <= 100; ++tick) {
    Pose motion;
    motion.position = {0.003 * tick, 0.004 * tick, tick == 1 ? 0.0 : 0.02};
    energy.add_tick(moved_links(robot, motion), {}, {}, {});
  }
  // 0.5 m/s in all ticks; in the second one it also rises by 20 mm: 2 m/s.
  EXPECT_NEAR(energy.mean_kinetic(), 0.5 * 0.3 * (0.25 + 4.0 / 100), 1e-9);
  EXPECT_NEAR(energy.mean_potential(), 0.3 * 9.81 * 0.02 * 0.99, 1e-9);
  EXPECT_EQ(energy.mean_elastic(), 0.0);
}

TEST(BodyEnergy, OfALinkThatTurnsIsThatOfItsInertia) {
  RobotModel robot = straight_robot(1);
  robot.links[0].mass.inertia = Eigen::Vector3d(2e-4, 3e-4, 5e-4).asDiagonal();
  for (const Eigen::Index axis : {0, 1, 2}) {
    BodyEnergy energy(robot, {}, 9.81, tick_length_s);
    constexpr double speed = 3.0;  // rad/s
    for (int tick = 1; tick <= 300; ++tick) {
      Pose motion;
      motion.orientation = Eigen::AngleAxisd(speed * tick * tick_length_s, Eigen::Vector3d::Unit(axis));
      energy.add_tick(moved_links(robot, motion), {}, {}, {});
    }
    const double inertia = robot.links[0].mass.inertia(axis, axis);
    EXPECT_NEAR(energy.mean_kinetic(), 0.5 * inertia * speed * speed, 1e-3 * inertia * speed * speed);
  }
}

TEST(BodyEnergy, OfAServoIsThatOfASpring) {
  const RobotModel robot = straight_robot(2);
  BodyEnergy energy(robot, {}, 9.81, tick_length_s);
  const double angle = 0.1;
  const double target = 0.3;
  const double torque = -0.25;
  energy.add_tick(moved_links(robot, {}), {&angle, 1}, {&target, 1}, {&torque, 1});
  EXPECT_DOUBLE_EQ(energy.mean_elastic(), 0.5 * 0.25 * 0.2);
}

TEST(BodyEnergy, IsRelativeToTheStart) {
  const RobotModel robot = straight_robot(4);
  Pose start;
  start.position = {1, 2, 3};
  start.orientation = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
  BodyEnergy energy(robot, start, 9.81, tick_length_s);
  energy.add_tick(moved_links(robot, start), {}, {}, {});
  EXPECT_NEAR(energy.mean_potential(), 0.0, 1e-12);
  EXPECT_NEAR(energy.mean_kinetic(), 0.0, 1e-12);
}

TEST(BodyEnergy, IsNotANumberBeforeTheFirstTick) {
  const BodyEnergy energy(straight_robot(2), {}, 9.81, tick_length_s);
  EXPECT_TRUE(std::isnan(energy.mean_potential()));
}

}  // namespace
}  // namespace proleg::sim
