#pragma once

// A robot and its environment as MJCF, MuJoCo's XML: for our engine in MuJoCo, and for users of MuJoCo.

#include <cstdint>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::mujoco {

enum class Integrator : std::uint8_t {
  implicit,  ///< implicit in the velocity; MuJoCo advises it for articulated bodies that turn fast
  euler,     ///< semi-implicit, as in ODE
};

/// Writes a robot and its environment as MJCF, with the settings of MuJoCo that come closest to sim/ode:
/// - a pair of geometries for everything that may touch, with the friction of friction_of(); neighbouring links have
///   none;
/// - contacts and joint limits that are hard, and give back a fifth of their depth in a step;
/// - cones of friction, the same in every direction, and Newton's solver;
/// - hinges whose dry friction is the motor: see sim/mujoco/mujoco_world.cpp.
/// The world is MuJoCo's body 0. Link i is body i + 1; the head, body 1, has the free joint 0. Joint j is MuJoCo's
/// joint j + 1. The objects that move follow, each with a free joint. Heights of height fields are not in the text.
[[nodiscard]] std::string write_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                     Integrator integrator);

struct MjcfExport {
  std::string text;
  std::vector<std::string> lost;  ///< what MuJoCo or the file has not, one line each
};

/// The same model for MuJoCo 3, complete in one file: bodies and joints have the names of links and
/// joints, each joint has an actuator of its name whose control is the set-point in rad, and the keyframe "start" is
/// the start of the scenario.
[[nodiscard]] MjcfExport export_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s);

}  // namespace proleg::sim::mujoco
