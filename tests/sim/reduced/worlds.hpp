#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sim/ode/ode_world.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim::reduced {

inline std::unique_ptr<World> ode_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::direct);
}

inline EnvironmentModel weightless() {
  EnvironmentModel environment;
  environment.gravity.setZero();
  return environment;
}

inline Eigen::Quaterniond turn(double rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, axis.normalized()));
}

inline void expect_near(const Pose& pose, const Pose& expected, double tolerance, const std::string& name) {
  EXPECT_LT((pose.position - expected.position).norm(), tolerance) << name;
  EXPECT_LT(pose.orientation.angularDistance(expected.orientation), tolerance) << name;
}

}  // namespace proleg::sim::reduced
