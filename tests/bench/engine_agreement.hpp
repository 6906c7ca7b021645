#pragma once

// How far candidates crawl in each physics engine, and how well the engines agree.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "sim/loop/simulation_batch.hpp"

namespace proleg::bench {

inline constexpr std::size_t batch_size = 64;

[[nodiscard]] inline std::vector<sim::Scenario> with_engine(std::vector<sim::Scenario> candidates,
                                                            sim::PhysicsEngine engine) {
  for (sim::Scenario& candidate : candidates) {
    candidate.environment.engine = engine;
  }
  return candidates;
}

using MakeWorld = std::function<std::unique_ptr<sim::World>(const sim::Scenario&)>;

/// m, of whole runs one after the other. make_world: null for the engine of the scenario.
[[nodiscard]] inline std::vector<double> distances_alone(std::span<const sim::Scenario> candidates,
                                                         const MakeWorld& make_world = nullptr) {
  std::vector<double> distances;
  for (const sim::Scenario& candidate : candidates) {
    sim::Simulation simulation(candidate, make_world ? make_world(candidate) : nullptr);
    simulation.leave_out_hashes();
    while (simulation.tick() < sim::tick_count(candidate)) {
      simulation.advance();
    }
    distances.push_back(simulation.measures()[sim::Measure::distance]);
  }
  return distances;
}

/// The same for the reduced engine, in batches. kernel: nothing: the fastest one.
[[nodiscard]] inline std::vector<double> distances_together(std::span<const sim::Scenario> candidates,
                                                            const sim::reduced::ChainKernel* kernel = nullptr) {
  std::vector<double> distances;
  for (std::size_t first = 0; first < candidates.size(); first += batch_size) {
    std::vector<const sim::Scenario*> scenarios;
    for (std::size_t i = first; i < std::min(first + batch_size, candidates.size()); ++i) {
      scenarios.push_back(&candidates[i]);
    }
    sim::SimulationBatch batch(scenarios, kernel);
    for (std::uint32_t tick = 0; tick < sim::tick_count(*scenarios.front()); ++tick) {
      batch.advance();
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      distances.push_back(batch.simulation(i).measures()[sim::Measure::distance]);
    }
  }
  return distances;
}

/// Of the distances of the same candidates.
struct EngineAgreement {
  double rank_correlation = 0.0;    ///< Spearman's
  std::vector<double> differences;  ///< m, ascending
  std::vector<double> relative;     ///< of the distance in ODE, ascending
};

[[nodiscard]] inline double quantile(const std::vector<double>& ascending, double share) {
  return ascending[static_cast<std::size_t>(share * static_cast<double>(ascending.size() - 1))];
}

[[nodiscard]] inline std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    ranks[order[rank]] = static_cast<double>(rank);
  }
  return ranks;
}

/// At least two candidates, no two of which crawl equally far.
[[nodiscard]] inline EngineAgreement agreement_of(const std::vector<double>& ode, const std::vector<double>& reduced) {
  const std::vector<double> ranks_in_ode = ranks_of(ode);
  const std::vector<double> ranks_in_reduced = ranks_of(reduced);
  EngineAgreement result;
  double squares = 0.0;
  for (std::size_t i = 0; i < ode.size(); ++i) {
    squares += (ranks_in_ode[i] - ranks_in_reduced[i]) * (ranks_in_ode[i] - ranks_in_reduced[i]);
    result.differences.push_back(std::abs(ode[i] - reduced[i]));
    result.relative.push_back(result.differences.back() / ode[i]);
  }
  const auto n = static_cast<double>(ode.size());
  result.rank_correlation = 1.0 - 6.0 * squares / (n * (n * n - 1.0));
  std::ranges::sort(result.differences);
  std::ranges::sort(result.relative);
  return result;
}

}  // namespace proleg::bench
