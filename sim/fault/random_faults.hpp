#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/fault/fault.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What random schedules may contain.
struct RandomFaults {
  std::uint64_t seed = 0;
  std::uint64_t run_us = 5'000'000;  ///< at least min_random_run_us
  bool has_chips = false;            ///< also faults that only a virtual chip can play
  bool only_at_ticks = false;        ///< only such that act_at_ticks() holds
};

/// All random faults are over this long before the end of a run, so that each module has come to rest in a safe state
/// by then.
inline constexpr std::uint64_t rest_after_faults_us = 2'000'000;
/// Shorter runs have no room for random faults.
inline constexpr std::uint64_t min_random_run_us = rest_after_faults_us + 500'000;

/// A schedule of one to four faults of any kind, that follows from the seed alone (and the robot). Times, durations and
/// places are random; of each kind, mild and severe cases come.
[[nodiscard]] FaultSchedule random_faults(const RandomFaults& settings, const Scenario& scenario);

}  // namespace proleg::sim
