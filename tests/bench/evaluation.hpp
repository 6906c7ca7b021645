#pragma once

#include "sim/loop/simulation.hpp"
#include "tests/bench/workload.hpp"

namespace proleg::bench {

/// The result of one evaluation of a candidate.
struct Evaluation {
  double displacement = 0.0;   ///< m
  double mean_contacts = 0.0;  ///< contact points in a step
};

/// Runs a new simulation to its end, as an optimiser does for one candidate.
[[nodiscard]] inline Evaluation evaluate(const sim::Scenario& scenario, const Workload& workload) {
  sim::Simulation simulation(scenario);
  while (simulation.tick() < workload.ticks()) {
    simulation.advance();
  }
  return {simulation.plant().displacement(), simulation.plant().mean_contacts()};
}

}  // namespace proleg::bench
