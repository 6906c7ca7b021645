#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::mujoco {

enum class Integrator : std::uint8_t {
  implicit,  ///< implicit in the velocity; MuJoCo advises it for articulated bodies that turn fast
  euler,     ///< semi-implicit, as in ODE
};

/// Writes a robot and its environment as MJCF, MuJoCo's XML, with the settings of MuJoCo that come closest to sim/ode:
/// - a pair of geometries for everything that may touch, with the friction of friction_of(); neighbouring links have
///   none;
/// - contacts and joint limits that are hard, and give back a fifth of their depth in a step;
/// - cones of friction, the same in every direction, and Newton's solver;
/// - hinges whose dry friction is the motor: see mujoco_world.cpp.
/// The world is MuJoCo's body 0. Link i is body i + 1; the head, body 1, has the free joint 0. Joint j is MuJoCo's
/// joint j + 1. The objects that move follow, each with a free joint.
[[nodiscard]] std::string write_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                     Integrator integrator);

/// Whether the program is built with MuJoCo, which is optional.
[[nodiscard]] bool is_built_in();

/// Makes a world in MuJoCo. file: name for messages. step_s: length of a step, above 0. Throws InputError if MuJoCo
/// lacks a feature that robot or environment needs, or is not built in.
[[nodiscard]] std::unique_ptr<World> make_mujoco_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                       double step_s, const std::string& file,
                                                       Integrator integrator = Integrator::implicit);

}  // namespace proleg::sim::mujoco
