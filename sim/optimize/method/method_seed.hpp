#pragma once

#include <cstdint>

#include "sim/optimize/experiment/scatter.hpp"

namespace proleg::optimize {

/// Seed of the random numbers of an optimiser in a run of an experiment. It differs from the seeds of the trials.
[[nodiscard]] constexpr std::uint64_t method_seed(std::uint64_t experiment_seed, std::uint32_t run) {
  return scatter(scatter(experiment_seed ^ 0x6D6574686F64U) + run);
}

}  // namespace proleg::optimize
