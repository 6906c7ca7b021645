#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// What becomes of a simulation's result. i: place of its scenario.
struct RunWatch {
  /// After each tick before the last; sets given_up to end the simulation. Null: nothing is done.
  std::function<void(std::size_t i, const sim::Simulation& simulation, TrialResult& result)> after_tick;
  /// At the end of a simulation that neither failed nor was given up.
  std::function<void(std::size_t i, const sim::Simulation& simulation, TrialResult& result)> at_end;
};

/// Simulates scenarios, in batches where it is worth it (sim::batch_size). Each result, except its wall_s, is the one
/// that its scenario has alone. Failed simulations (PhysicsError) have a `failure`.
[[nodiscard]] std::vector<TrialResult> run_scenarios(std::span<const sim::Scenario> scenarios, const RunWatch& watch);

}  // namespace proleg::optimize
