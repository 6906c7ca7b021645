#include "sim/optimize/evaluation/scenario_runs.hpp"

#include <algorithm>
#include <chrono>

#include "sim/loop/simulation.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// What follows a tick. Returns whether the simulation continues.
bool watch_tick(const RunWatch& watch, std::size_t i, const sim::Simulation& simulation, std::uint32_t ticks,
                TrialResult& result) {
  if (simulation.tick() == ticks) {
    watch.at_end(i, simulation, result);
    return false;
  }
  if (watch.after_tick) {
    watch.after_tick(i, simulation, result);
  }
  return !result.given_up;
}

void run_alone(const sim::Scenario& scenario, const RunWatch& watch, std::size_t i, TrialResult& result) {
  const std::uint32_t ticks = sim::tick_count(scenario);
  sim::Simulation simulation(scenario);
  simulation.leave_out_hashes();
  try {
    do {
      simulation.advance();
    } while (watch_tick(watch, i, simulation, ticks, result));
  } catch (const sim::PhysicsError& error) {
    result.failure = error.what();
  }
  result.simulated_s = simulation.time_s();
}

/// first: place of the first scenario.
void run_batch(std::span<const sim::Scenario> scenarios, const RunWatch& watch, std::size_t first,
               std::span<TrialResult> results) {
  std::vector<const sim::Scenario*> members;
  for (const sim::Scenario& scenario : scenarios) {
    members.push_back(&scenario);
  }
  sim::SimulationBatch batch(members);
  for (std::size_t running = batch.size(); running > 0;) {
    batch.advance();
    running = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (batch.runs(i) &&
          !watch_tick(watch, first + i, batch.simulation(i), sim::tick_count(scenarios[i]), results[i])) {
        batch.stop(i);
      }
      running += batch.runs(i) ? 1U : 0U;
    }
  }
  for (std::size_t i = 0; i < batch.size(); ++i) {
    results[i].failure = batch.failure(i);
    results[i].simulated_s = batch.simulation(i).time_s();
  }
}

/// Whether the worlds of the scenarios can make their steps together.
bool fit_together(const sim::Scenario& one, const sim::Scenario& other) {
  return !sim::find_contradiction(other) && one.kernel.tick_period_us == other.kernel.tick_period_us &&
         one.step_s == other.step_s;
}

}  // namespace

std::vector<TrialResult> run_scenarios(std::span<const sim::Scenario> scenarios, const RunWatch& watch) {
  std::vector<TrialResult> results(scenarios.size());
  for (std::size_t first = 0; first < scenarios.size();) {
    if (const auto contradiction = sim::find_contradiction(scenarios[first])) {
      results[first].failure = "found " + contradiction->found + ", expected " + contradiction->expected;
      ++first;
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const std::size_t most = std::min(sim::batch_size(scenarios[first]), scenarios.size() - first);
    std::size_t count = 1;
    while (count < most && sim::batch_size(scenarios[first + count]) > 1 &&
           fit_together(scenarios[first], scenarios[first + count])) {
      ++count;
    }
    if (count == 1) {
      run_alone(scenarios[first], watch, first, results[first]);
    } else {
      run_batch(scenarios.subspan(first, count), watch, first, std::span(results).subspan(first, count));
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    for (std::size_t i = first; i < first + count; ++i) {
      results[i].wall_s = passed.count() / static_cast<double>(count);
    }
    first += count;
  }
  return results;
}

}  // namespace proleg::optimize
