#pragma once

#include <optional>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The scenario of a recording, read from the files that the recording holds; nothing if they cannot be read or do not
/// fit its joints and links. Options of the command line (--set, --friction ...) that the run was started with have no
/// effect on it; `overrides` do.
[[nodiscard]] std::optional<Scenario> recorded_scenario(const Recording& recording, const Overrides& overrides = {});

}  // namespace proleg::sim
