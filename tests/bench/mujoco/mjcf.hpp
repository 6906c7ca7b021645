#pragma once

#include <cstdint>
#include <string>

#include "sim/environment/environment_model.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::bench {

enum class MujocoIntegrator : std::uint8_t {
  implicit,  ///< in the velocity; what MuJoCo advises for articulated bodies that turn fast
  euler,     ///< semi-implicit, as the Open Dynamics Engine
};

/// A robot and its environment as MJCF, MuJoCo's XML, with what MuJoCo has that comes closest to sim/physics:
/// - a pair of geometries for everything that may touch, with the friction that sim/physics gives it; neighbouring
///   links have none;
/// - contacts and joint limits that are hard, and give back a fifth of their depth in a step;
/// - pyramids of friction, and Newton's solver;
/// - hinges, named "joint 0" from the head on, whose dry friction is the motor: see MujocoWorld.
/// The root of the tree is the head.
[[nodiscard]] std::string write_mjcf(const sim::RobotModel& robot, const sim::EnvironmentModel& environment,
                                     double step_s, MujocoIntegrator integrator);

}  // namespace proleg::bench
