#pragma once

// The scenario of a recording, and the algorithms with which the recording was made: the core, and the users'
// algorithms that ran in it.

#include <optional>
#include <string>
#include <vector>

#include "shared/kernel/kernel_configuration.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The scenario of a recording, read from the files that the recording holds; nothing if they cannot be read or do not
/// fit its joints and links. Options of the command line (--set, --friction ...) that the run was started with have no
/// effect on it; `overrides` do.
[[nodiscard]] std::optional<Scenario> recorded_scenario(const Recording& recording, const Overrides& overrides = {});

/// "steep_wave 0x12345678, ...": the users' algorithms of a gait, with their sources as in the object 0x200F; empty
/// without them.
[[nodiscard]] std::string user_algorithms_text(const KernelConfiguration& kernel);

/// The processor of this computer: its architecture, and its name where the system gives one.
[[nodiscard]] std::string processor_text();

/// The options of the command line (--engine, --friction ...) that the run was started with.
[[nodiscard]] OverrideWords recorded_overrides(const Recording& recording);

/// Why this program may move the world of a recording otherwise, a sentence each without a full stop: the recording was
/// made by another program, or on another processor. build_id: of this program.
[[nodiscard]] std::vector<std::string> other_program(const Recording& recording, const std::string& build_id);

/// What this program has in place of what a recording was made with, a sentence each without a full stop: another core,
/// or a user's algorithm with other sources. Empty if there is nothing to report; an algorithm that this program does
/// not have is not named.
[[nodiscard]] std::vector<std::string> other_algorithms(const Recording& recording);

}  // namespace proleg::sim
