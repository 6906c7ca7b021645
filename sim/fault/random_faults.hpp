#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/fault/fault.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Settings for random schedules.
struct RandomFaults {
  std::uint64_t seed = 0;
  std::uint64_t run_us = 5'000'000;  ///< at least min_random_run_us
  bool has_chips = false;            ///< whether to draw faults that only a virtual chip can play
  bool only_at_ticks = false;        ///< whether act_at_ticks() must be true
};

/// Time between the end of all random faults and the end of a run, so that each module comes to rest in a safe state.
inline constexpr std::uint64_t rest_after_faults_us = 2'000'000;
/// Shortest run with random faults.
inline constexpr std::uint64_t min_random_run_us = rest_after_faults_us + 500'000;

/// Draws one to four faults of any kind, which depend only on the seed and the robot. Times, durations and places are
/// random; each kind has mild and severe cases.
[[nodiscard]] FaultSchedule random_faults(const RandomFaults& settings, const Scenario& scenario);

}  // namespace proleg::sim
