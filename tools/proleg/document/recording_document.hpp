#pragma once

#include <nlohmann/json_fwd.hpp>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The document `recording` (docs/page-interface.md): origin, figures, and the marks on its time line.
[[nodiscard]] nlohmann::json recording_document(const sim::Recording& recording);

/// Whether the robot's path is known: modules do not measure it, and `proleg drive` records only the place at the
/// start.
[[nodiscard]] bool has_path(const sim::Recording& recording);

/// The document `parameters` with the values at the start of the recording. scenario: the recording's scenario.
[[nodiscard]] nlohmann::json recorded_parameters_document(const sim::Recording& recording,
                                                          const sim::Scenario& scenario);

/// The scenario of a recording. Throws InputError if the recording's files cannot be read, or if its slots do not have
/// the recorded algorithms and internal values. overrides: those of recorded_scenario().
[[nodiscard]] sim::Scenario scenario_of(const sim::Recording& recording, const sim::Overrides& overrides = {});

}  // namespace proleg::tools
