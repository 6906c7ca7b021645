#pragma once

// The command line of `proleg hil`.

#include <optional>
#include <string>
#include <vector>

#include "sim/hardware_loop/hardware_loop.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/hil/hil_modules.hpp"

namespace proleg::tools {

struct HilOptions : ScenarioOptions, ModuleOptions {
  std::vector<std::string> resets;
  std::vector<std::string> frames;
  std::optional<std::string> bit_errors;
  std::optional<std::string> can_log;
  std::optional<std::string> faults;
};

void add_hil_options(CommandLine& command_line, HilOptions& options);

/// Options with the losses, restarts, injected frames and bit errors of a run, which must outlive the result. Throws
/// InputError.
[[nodiscard]] sim::HardwareOptions hardware_options(const HilOptions& options, const ScenarioRun& run);

}  // namespace proleg::tools
