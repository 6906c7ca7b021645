#pragma once

#include <memory>
#include <string>

#include "sim/environment/environment_model.hpp"
#include "sim/mjcf/mjcf.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::mujoco {

/// Whether the program is built with MuJoCo, which is optional.
[[nodiscard]] bool is_built_in();

/// Makes a world in MuJoCo. file: name for messages. step_s: length of a step, above 0. Throws InputError if MuJoCo
/// lacks a feature that robot or environment needs, or is not built in.
[[nodiscard]] std::unique_ptr<World> make_mujoco_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                       double step_s, const std::string& file,
                                                       Integrator integrator = Integrator::implicit);

}  // namespace proleg::sim::mujoco
