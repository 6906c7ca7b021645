#pragma once

#include <nlohmann/json_fwd.hpp>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The document `recording` (docs/page-interface.md): where it comes from, its figures, and the marks on its time line.
[[nodiscard]] nlohmann::json recording_document(const sim::Recording& recording);

/// False if where the robot was is not known: modules do not measure it, and `proleg drive` records its place at the
/// start.
[[nodiscard]] bool has_path(const sim::Recording& recording);

/// The document `parameters` with the values at the start of the recording. scenario: of the recording.
[[nodiscard]] nlohmann::json recorded_parameters_document(const sim::Recording& recording,
                                                          const sim::Scenario& scenario);

/// The scenario of a recording. Throws InputError if the recording's files cannot be read, or if its slots have other
/// algorithms, or these other internal values, than those that were recorded. overrides: as in recorded_scenario().
[[nodiscard]] sim::Scenario scenario_of(const sim::Recording& recording, const sim::Overrides& overrides = {});

}  // namespace proleg::tools
