#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {
class Simulation;
}

namespace proleg::optimize {

/// The result of a simulation.
struct TrialResult {
  sim::MeasureValues measures;
  double simulated_s = 0.0;
  double wall_s = 0.0;               ///< what the worker needed, its share of a batch; processor time would not
                                     ///< include waiting
  bool given_up = false;             ///< racing stopped it; distance and speed are extrapolated
  std::string failure;               ///< why the simulation failed; empty if it did not
  std::uint32_t limited_joints = 0;  ///< whose servos cannot follow the gait; only sweeps count them
};

/// What becomes of a simulation's result. i: place of its scenario.
struct RunWatch {
  /// Called after each tick before the last; sets given_up to end the simulation. Null: nothing is done.
  std::function<void(std::size_t i, const sim::Simulation& simulation, TrialResult& result)> after_tick;
  /// Called at the end of a simulation that neither failed nor was given up.
  std::function<void(std::size_t i, const sim::Simulation& simulation, TrialResult& result)> at_end;
};

/// Simulates scenarios, in batches where it is worth it (sim::batch_size). Each result, except its wall_s, is the one
/// that its scenario has alone. Failed simulations (PhysicsError) have a `failure`, and so has a scenario with
/// parameters that contradict each other, which is not simulated.
[[nodiscard]] std::vector<TrialResult> run_scenarios(std::span<const sim::Scenario> scenarios, const RunWatch& watch);

}  // namespace proleg::optimize
