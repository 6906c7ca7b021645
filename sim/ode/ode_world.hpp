#pragma once

#include <cstdint>
#include <memory>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Solvers for contact and joint forces.
enum class Stepper : std::uint8_t {
  direct,     ///< dWorldStep: exact, repeatable on each thread; the faster one up to about 8 links
  iterative,  ///< dWorldQuickStep, 20 iterations: faster for more links, and repeatable on each thread. Only one
              ///< thread of a process is in it at a time (sim/ode/engine.hpp, SolverRandomNumbers).
};

/// A world in the Open Dynamics Engine. step_s: length of a step, above 0. The models must be valid (sim/scenario
/// checks them).
[[nodiscard]] std::unique_ptr<World> make_ode_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                    double step_s, Stepper stepper);

}  // namespace proleg::sim
