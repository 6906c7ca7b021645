#pragma once

// The results of an experiment of the thesis, for machines.

#include <vector>

#include "sim/optimize/report/thesis_experiment.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/search/experiment_methods.hpp"
#include "tools/proleg/search/gait_checks.hpp"
#include "tools/proleg/search/repetitions.hpp"

namespace proleg::tools {

/// results: one for each chosen method. checks: may be empty.
[[nodiscard]] Json experiment_json(const std::vector<ChosenMethod>& chosen, const std::vector<MethodResult>& results,
                                   const std::vector<optimize::Reference>& references,
                                   const std::vector<CheckedGait>& checks);

}  // namespace proleg::tools
