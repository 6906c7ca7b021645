#pragma once

// The option --faults of `proleg hil`: one schedule, or a campaign of random ones.

#include <cstdint>
#include <optional>
#include <string>

#include "sim/fault/fault.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/hil/hil_modules.hpp"
#include "tools/proleg/hil/hil_options.hpp"

namespace proleg::tools {

/// The value of --faults.
struct FaultPlan {
  sim::FaultSchedule schedule;        ///< schedule of one run
  std::uint64_t seed = 0;             ///< seed of the first schedule of a campaign
  std::optional<std::uint32_t> runs;  ///< runs of a campaign; nothing: one run with the schedule
};

/// Reads FILE, SEED or SEED:COUNT. Throws InputError.
[[nodiscard]] FaultPlan read_fault_plan(const HilOptions& options, const ScenarioRun& run, bool any_virtual);

/// Prints a warning for each fault that only a virtual chip can play, at a module that is none.
void warn_of_faults_without_effect(const sim::FaultSchedule& schedule, const ScenarioRun& run,
                                   const HilModules& modules);

/// Runs the schedules of a campaign and prints a summary. With virtual chips, schedules that native modules can play
/// too are run with both and compared. Returns the exit status.
[[nodiscard]] int run_fault_campaign(const HilOptions& options, const ScenarioRun& run, HilModules& modules,
                                     const FaultPlan& plan);

}  // namespace proleg::tools
