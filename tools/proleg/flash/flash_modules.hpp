#pragma once

// The modules of a robot for proleg flash and proleg recover: who is there, with which program and settings.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/flash/module_program.hpp"
#include "host/robot/parameter_file.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

struct FoundModules {
  std::vector<host::FlashCandidate> modules;  ///< by node id, those without one last
  std::vector<std::uint8_t> foreign;          ///< nodes that are no joint modules
  std::vector<std::uint8_t> silent;           ///< node ids that sent frames, and belong to no module that was found
};

enum class SilentSearch : std::uint8_t { after_signs, always };

/// Who is on the bus, perhaps no module; their programs are not asked for. search: when modules without a node id, and
/// those that are Stopped, are searched for: after signs of them, or always. Throws std::runtime_error if the
/// connection is lost.
[[nodiscard]] FoundModules look_for_modules(BusAccess& bus, SilentSearch search);

/// Modules that are not among the known ones, by LSS, which all of them serve at any time.
[[nodiscard]] std::vector<host::FlashCandidate> find_silent_modules(BusAccess& bus,
                                                                    std::span<const host::FlashCandidate> known);

/// Asks the modules for their programs.
void ask_programs(BusAccess& bus, std::span<host::FlashCandidate> modules);

/// nodes: only these. Modules without a node id, and those that are Stopped because two have the same one, are searched
/// for if there are signs of them. Throws std::runtime_error if none is found or the connection is lost.
[[nodiscard]] FoundModules find_modules(BusAccess& bus, const std::optional<std::vector<std::uint8_t>>& nodes);

/// What these nodes keep in flash, except their node ids. A node that does not answer has no values.
[[nodiscard]] std::vector<host::ModuleParameters> read_settings(BusAccess& bus, const std::vector<std::uint8_t>& nodes);

/// A line for each value that differs: "node 3: 0x2009:1 (Potentiometer fitted): 1 before, 0 now".
[[nodiscard]] std::vector<std::string> compare_settings(const host::ModuleParameters& before,
                                                        const host::ModuleParameters& after);

/// If a module is in a session with another host, such as one that was stopped in the middle of a transfer, waits until
/// the module must have ended it by itself.
void wait_for_sessions(BusAccess& bus, const std::vector<host::FlashCandidate>& modules);

/// "node 3", or "the module 0x12345678" without a node id.
[[nodiscard]] std::string name_of(const host::FlashCandidate& module);

}  // namespace proleg::tools
