#pragma once

// The repetitions of an experiment with one method.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/report/best_curves.hpp"

namespace proleg::tools {

struct MethodResult {
  optimize::MethodRuns runs;
  std::vector<std::string> endings;
  std::optional<optimize::Evaluation> best;
  double wall_s = 0.0;
};

/// Runs the repetitions; what the store in the folder has is not simulated again. Fewer if the user interrupts. If
/// there are enough of them, each worker has repetitions of its own: a worker that serves one search alone waits less,
/// and its batches are larger. The result does not depend on the number of workers. Throws BadInput, and
/// std::runtime_error if no evaluation of a repetition has a score.
[[nodiscard]] MethodResult run_repetitions(const std::string& name, const optimize::Experiment& experiment,
                                           std::uint32_t repetitions, std::uint32_t workers,
                                           const std::filesystem::path& folder);

}  // namespace proleg::tools
