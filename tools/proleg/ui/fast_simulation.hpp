#pragma once

// Simulations beside everything else: what a page shows before anybody asks for it.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "sim/loop/simulation.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Gives the calling thread a low priority: the live robot and the server come first.
void lower_thread_priority();

/// Processor time that the calling thread has used: what is limited by it does not depend on other programs.
[[nodiscard]] std::chrono::nanoseconds thread_time();

/// A simulation without hashes with the fastest engine that has such a scenario: the reduced one, else ODE. Sets the
/// engine of the scenario, which must outlive the simulation. Throws as Simulation.
[[nodiscard]] std::unique_ptr<sim::Simulation> make_fast_simulation(sim::Scenario& scenario);

/// Why the engine that a scenario names does not have such a scenario; nothing if it has.
[[nodiscard]] std::optional<std::string> refusal_of_engine(const sim::Scenario& scenario);

}  // namespace proleg::tools
