#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// Solvers for contact and joint forces.
enum class Stepper : std::uint8_t {
  automatic,  ///< direct, but iterative while contacts are many for longer than a moment (StepBudget)
  direct,     ///< dWorldStep: exact, repeatable on each thread; the faster one up to about 8 links
  iterative,  ///< dWorldQuickStep, 20 iterations: faster for more links, and repeatable on each thread. Only one
              ///< thread of a process is in it at a time (sim/ode/engine.hpp, SolverRandomNumbers).
};

/// The time of a direct step grows with the cube of the contact points: 128 of them, as the feet of eight links on a
/// floor have, take 64 times as long as 32. The budget lets a world have many for a moment, as when it is put on the
/// floor, and says when a step has to be iterative. It counts points, not time, so a run repeats.
class StepBudget {
 public:
  /// Points of a step that the budget pays for without end.
  static constexpr double lasting_points = 40;
  /// Counts a step with so many contact points. Returns whether it is to be direct.
  bool take(std::size_t points);

 private:
  double spent_ = 0.0;  ///< cubes of points
};

/// A world in the Open Dynamics Engine. step_s: length of a step, above 0. The models must be valid (sim/scenario
/// checks them).
[[nodiscard]] std::unique_ptr<World> make_ode_world(const RobotModel& robot, const EnvironmentModel& environment,
                                                    double step_s, Stepper stepper);

/// Number of steps so far that an automatic world computed iteratively, because contact points were many. 0 for a world
/// of another engine.
[[nodiscard]] std::size_t relieved_steps(const World& world);

}  // namespace proleg::sim
