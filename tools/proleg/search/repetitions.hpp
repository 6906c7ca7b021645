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

inline constexpr std::uint32_t max_repetitions = 1000;

struct MethodResult {
  optimize::MethodRuns runs;
  std::vector<std::string> endings;
  std::optional<optimize::Evaluation> best;
  double wall_s = 0.0;
};

/// Runs the repetitions side by side, with shared workers; evaluations in the folder's store are not simulated again.
/// The result has fewer repetitions if the user interrupts. It does not depend on the number of workers. repetitions:
/// at most max_repetitions. Throws BadInput, and std::runtime_error if no evaluation of a repetition has a score.
[[nodiscard]] MethodResult run_repetitions(const std::string& name, const optimize::Experiment& experiment,
                                           std::uint32_t repetitions, std::uint32_t workers,
                                           const std::filesystem::path& folder);

}  // namespace proleg::tools
