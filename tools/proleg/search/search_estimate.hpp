#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::tools {

/// How long a search takes on this computer.
struct SearchEstimate {
  double evaluation_s = 0.0;             ///< of one evaluation, beside those of the other workers
  double confirmation_s = 0.0;           ///< what follows the search: fresh runs, the runs of the best scenario
  std::optional<std::uint64_t> planned;  ///< evaluations at most; nothing: the method decides

  /// Nothing if the number of evaluations is not known.
  [[nodiscard]] std::optional<double> seconds() const;
};

/// Makes the search without a store for some seconds, and measures what an evaluation and a fresh run take. others:
/// number of candidates that are rated with the best ones (confirm_best()).
[[nodiscard]] SearchEstimate estimate_search(const optimize::Experiment& experiment, optimize::Workers& workers,
                                             std::size_t others = 0);

}  // namespace proleg::tools
