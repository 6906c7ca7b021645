#pragma once

#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// A part of an experiment in words, exact: two experiments whose texts are equal agree in it.
struct ExperimentPart {
  std::string name;  ///< for messages: "method", "search space"
  std::string text;
};

/// All that determines the results, but the scenario. The fingerprint is made of it, and a store keeps it to say what
/// differs.
[[nodiscard]] std::vector<ExperimentPart> parts_of(const Experiment& experiment);

/// weight * measure + ...
[[nodiscard]] std::string terms_text(const Objective& objective);

}  // namespace proleg::optimize
