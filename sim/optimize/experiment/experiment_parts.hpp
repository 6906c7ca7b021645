#pragma once

#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// A part of an experiment as exact text: two experiments agree in the part if the texts are equal.
struct ExperimentPart {
  std::string name;  ///< for messages: "method", "search space"
  std::string text;
};

/// All parts that determine the results, except the scenario. The fingerprint is made of them, and a store keeps them
/// to name differences.
[[nodiscard]] std::vector<ExperimentPart> parts_of(const Experiment& experiment);

/// Text of an objective: weight * measure + ...
[[nodiscard]] std::string terms_text(const Objective& objective);

}  // namespace proleg::optimize
