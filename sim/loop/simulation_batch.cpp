#include "sim/loop/simulation_batch.hpp"

#include <cstdint>
#include <utility>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim {
namespace {

std::vector<reduced::WorldInput> inputs_of(std::span<const Scenario* const> scenarios) {
  std::vector<reduced::WorldInput> inputs;
  for (const Scenario* scenario : scenarios) {
    inputs.push_back({&scenario->robot, &scenario->environment, scenario->step_s, scenario->path});
  }
  return inputs;
}

}  // namespace

std::size_t batch_size(const Scenario& scenario) {
  constexpr std::size_t enough = 64;
  return scenario.environment.engine == PhysicsEngine::reduced && scenario.moves.empty() ? enough : 1;
}

SimulationBatch::SimulationBatch(std::span<const Scenario* const> scenarios, const reduced::ChainKernel* kernel)
    : worlds_(inputs_of(scenarios), kernel) {
  std::vector<std::unique_ptr<World>> worlds = worlds_.take_worlds();
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    members_.push_back({std::make_unique<Simulation>(*scenarios[i], std::move(worlds[i]))});
    members_.back().simulation->leave_out_hashes();
  }
}

template <typename Do>
void SimulationBatch::for_all(const Do& act) {
  for (Member& member : members_) {
    if (!member.runs) {
      continue;
    }
    try {
      act(*member.simulation);
    } catch (const PhysicsError& error) {
      member.failure = error.what();
      member.runs = false;
    }
  }
}

void SimulationBatch::advance() {
  for_all([](Simulation& simulation) {
    simulation.begin_tick();
    simulation.begin_step(0);
  });
  const std::uint32_t steps = members_.front().simulation->plant().steps_per_tick();
  for (std::uint32_t step = 0; step < steps; ++step) {
    worlds_.step();
    const bool is_last = step + 1 == steps;
    // A simulation ends its step and begins the next one while its numbers are in the cache.
    for_all([&](Simulation& simulation) {
      simulation.finish_step();
      if (is_last) {
        simulation.end_tick();
      } else {
        simulation.begin_step(step + 1);
      }
    });
  }
}

}  // namespace proleg::sim
