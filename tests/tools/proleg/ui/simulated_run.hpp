#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/robot_move.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {

/// What `proleg simulate` gives for the words of --set and --move after this number of ticks.
struct Hashes {
  std::string setpoints;
  std::string servos;
  double displacement;
  bool operator==(const Hashes&) const = default;
};

inline Hashes hashes_of(const sim::Simulation& simulation) {
  return {simulation.setpoint_hash().hex(), simulation.servo_hash().hex(), simulation.plant().displacement()};
}

inline Hashes simulated(const sim::Scenario& file, const std::vector<std::string>& words, std::uint32_t ticks,
                        const std::vector<std::string>& moves = {}) {
  sim::Scenario scenario = file;
  for (const std::string& word : words) {
    sim::apply_setting(scenario, word);
  }
  for (const std::string& move : moves) {
    sim::add_move(scenario, move);
  }
  sim::Simulation simulation(scenario);
  while (simulation.tick() < ticks) {
    simulation.advance();
  }
  return hashes_of(simulation);
}

}  // namespace proleg::tools
