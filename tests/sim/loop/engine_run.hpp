#pragma once

#include <optional>
#include <string>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {

/// A shipped scenario, run to its end.
struct EngineRun {
  double distance;  // m
  std::string setpoints;
  std::optional<std::string> world;
};

inline EngineRun run_in(PhysicsEngine engine, const std::string& name) {
  Scenario scenario = shipped(name);
  scenario.environment.engine = engine;
  Simulation simulation(scenario);
  while (simulation.tick() < tick_count(scenario)) {
    simulation.advance();
  }
  return {simulation.plant().displacement(), simulation.setpoint_hash().hex(), simulation.world_hash()};
}

}  // namespace proleg::sim
