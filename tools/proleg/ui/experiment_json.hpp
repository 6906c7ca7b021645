#pragma once

// Experiments as the page has them (docs/page-interface.md, Searches).

#include <nlohmann/json_fwd.hpp>

#include "sim/optimize/experiment/experiment_form.hpp"

namespace proleg::tools {

/// Throws InputError, which names the field, for a member that is missing or of another kind.
[[nodiscard]] optimize::ExperimentForm read_experiment_json(const nlohmann::json& experiment);
[[nodiscard]] nlohmann::json experiment_json(const optimize::ExperimentForm& form);

/// The document `search_methods`.
[[nodiscard]] nlohmann::json search_methods_json();

}  // namespace proleg::tools
