#pragma once

// An image goes to some modules, for proleg flash and proleg recover.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/flash/module_program.hpp"
#include "host/flash/robot_update.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

struct UpdateDurations {
  double transfer_s = 0;
  double installation_s = 0;
  double restart_s = 0;  ///< and confirmation

  [[nodiscard]] double all() const { return transfer_s + installation_s + restart_s; }
};

struct UpdateRun {
  std::vector<host::UpdatedModule> modules;  ///< in the order given
  UpdateDurations durations;
};

/// The number of a session: of the clock, so that two hosts rarely have the same one.
[[nodiscard]] std::uint8_t new_session(BusAccess& bus);

/// Brings an image to modules at once, and shows a bar for each until all have ended, or reports the events `progress`
/// and `ended`. through_its_line: as host::UpdateOptions has it. Throws std::runtime_error if the user interrupts;
/// hint: the end of that message, with a separator, or empty.
[[nodiscard]] UpdateRun run_update(BusAccess& bus, std::span<const std::uint8_t> image,
                                   std::span<const host::FlashCandidate> modules, bool through_its_line,
                                   const ProgramReport& report, const std::string& hint = {});

}  // namespace proleg::tools
