// This source replaces the others if MuJoCo is not installed.

#include "shared/computer/errors/input_error.hpp"
#include "sim/mujoco/mujoco_world.hpp"

namespace proleg::sim::mujoco {

bool is_built_in() { return false; }

std::unique_ptr<World> make_mujoco_world(const RobotModel& /*robot*/, const EnvironmentModel& /*environment*/,
                                         double /*step_s*/, const std::string& file, Integrator /*integrator*/) {
  throw InputError(file, 0, "the engine MuJoCo, which is not built in",
                   "one of the other engines, or a program that was built where libmujoco-dev 2.2.2 is installed");
}

}  // namespace proleg::sim::mujoco
