#pragma once

// The results of a run of `proleg hil`, and their output.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/hardware_loop/hardware_loop.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/hil/hil_modules.hpp"
#include "tools/proleg/hil/hil_options.hpp"

namespace proleg::tools {

struct RestartReport {
  std::uint8_t node;
  std::string joint;
  std::uint32_t tick;
  std::optional<std::uint32_t> joined_tick;
};

struct HilResult {
  std::uint32_t ticks = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
  double displacement_m = 0.0;
  double contacts_mean = 0.0;
  std::uint64_t differences = 0;
  std::string first_difference;
  std::uint64_t lost_frames = 0;
  std::uint64_t receptions = 0;
  std::uint64_t bit_errors = 0;
  std::uint64_t frames = 0;
  std::uint64_t setup_frames = 0;
  double bus_load = 0.0;
  std::string setpoint_hash;
  std::string servo_hash;
  std::optional<std::string> world_hash;
  std::string motion_hash;
  std::vector<std::uint32_t> clipped_ticks;    ///< number of clipped ticks by joint
  std::vector<std::uint32_t> dropped_changes;  ///< ticks of the changes that did not take effect
  std::vector<RestartReport> restarts;
  std::vector<sim::ModuleFailure> failures;
  std::vector<sim::ModuleProblem> problems;
  std::optional<HilModules::CostliestTick> costliest_tick;
  Durations command_latency_ns;  ///< that of HardwareLoop
  RunMeasures measures;
  std::vector<sim::SensorSummary> sensors;
  // Results of a run with faults.
  sim::FaultSchedule faults;
  std::optional<std::uint32_t> first_fault_tick;  ///< the first tick that was not compared
  std::vector<sim::ModuleEvent> module_events;
  std::vector<sim::JointEnd> joint_ends;  ///< end of each joint
  std::vector<std::string> violations;
  sim::MotionWatch::Worst worst_motion;

  [[nodiscard]] double real_time_factor() const { return simulated_s / wall_s; }
};

/// Text of a joint: "J3 (node 3)".
[[nodiscard]] std::string joint_and_node(const ScenarioRun& run, std::uint32_t joint);

/// The worst motion of a run, or of a campaign, against the limits of a module that fails.
[[nodiscard]] std::string worst_values(const sim::MotionWatch::Worst& worst);
[[nodiscard]] Json worst_object(const sim::MotionWatch::Worst& worst);

[[nodiscard]] Json hil_json(const HilOptions& options, const ScenarioRun& run, const HilModules& modules,
                            const HilResult& result);

/// Prints the results on standard output, for people.
void print_hil_table(const HilOptions& options, const ScenarioRun& run, const HilModules& modules,
                     const HilResult& result);

/// Text with the ticks of the changes that did not take effect: "31, 33, 35".
[[nodiscard]] std::string list_dropped_changes(const HilResult& result);

/// The results for the recording's table of results.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> hil_summary(const ScenarioRun& run,
                                                                           const HilResult& result);

}  // namespace proleg::tools
