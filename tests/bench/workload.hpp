#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/scenario/scenario.hpp"

namespace proleg::bench {

/// The duration and time steps with which an optimiser simulates one candidate.
struct Workload {
  std::string_view name;
  std::uint32_t steps;    ///< of the physics
  std::uint32_t step_us;  ///< length of a step
  std::uint32_t tick_us;  ///< between two computations of the gait; a whole number of steps
  [[nodiscard]] double seconds() const { return 1e-6 * step_us * steps; }
  [[nodiscard]] std::uint32_t ticks() const { return steps / (tick_us / step_us); }
};

/// The defaults of two published optimisers of robots, and ours.
inline constexpr std::array<Workload, 3> workloads{{
    {"RoboGen", 1'600, 5'000, 40'000},    // 8 s, control at 25 Hz
    {"Revolve2", 30'000, 1'000, 50'000},  // 30 s, control at 20 Hz
    {"Proleg", 30'000, 1'000, 10'000},    // 30 s, control at 100 Hz
}};

/// The scenario with the times of a workload. The period of its servos does not change.
[[nodiscard]] inline sim::Scenario with_workload(sim::Scenario scenario, const Workload& workload) {
  scenario.step_s = 1e-6 * workload.step_us;
  scenario.kernel.tick_period_us = workload.tick_us;
  scenario.duration_s = workload.seconds();
  return scenario;
}

}  // namespace proleg::bench
