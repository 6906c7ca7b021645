#pragma once

// What proleg drive says at its end.

#include <cstdint>
#include <optional>
#include <string>

#include "host/robot/bus_connection.hpp"
#include "shared/computer/durations/durations.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/robot/gait_check.hpp"
#include "tools/proleg/robot/mirror.hpp"

namespace proleg::tools {

struct DriveOptions : ScenarioOptions {
  BusOptions bus;
  bool fast = false;
  bool ends_with_input = false;
  std::optional<std::string> longest_silence;  ///< of standard input, in seconds
  bool only_checks = false;
  std::optional<std::string> mirror;
};

struct DriveResult {
  std::uint32_t ticks = 0;
  std::uint32_t restarts = 0;
  std::uint64_t dropped_changes = 0;
  host::Statistics bus;
  Durations answers_us;       ///< of modules to SDO requests
  Durations acknowledged_us;  ///< changes, by all modules
  Durations ticks_to_effect;  ///< of changes without a tick
};

/// Text or, with --json, one object. seconds: of the gait. mirrored: null without --mirror.
void print_result(const DriveOptions& options, const DriveResult& result, const GaitCheck& check, double seconds,
                  const MirroredRun* mirrored);

}  // namespace proleg::tools
