#pragma once

// The algorithms of pagmo 2.18 that search without derivatives, the needs of each, and a search with one of them.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"

namespace pagmo {
class algorithm;
}

namespace proleg::optimize {

/// The inputs for making an algorithm. PagmoSettings without a value have pagmo's default.
struct PagmoSetup {
  const PagmoSettings& settings;
  unsigned seed;
  std::size_t variables;  ///< number of variables of the problem
  double max_index;       ///< upper end of the widest variable, in steps
  double cost_spread;     ///< spread of the costs in the first population; above 0
  std::size_t objectives;
};

struct PagmoAlgorithm {
  std::string_view name;  ///< as in its declaration
  /// Whether one evolve() for each generation has the result of one for all, because the algorithm keeps its state or
  /// has none. Other algorithms (with a cooling schedule, for example) are made for all generations and evolve once.
  bool evolves_by_generation;
  /// Whether the algorithm can find nothing new when its candidates no longer differ.
  bool stagnates;
  pagmo::algorithm (*make)(const PagmoSetup& setup);

  [[nodiscard]] const PagmoDeclaration& declaration() const;
};

/// All algorithms, sorted by name.
[[nodiscard]] std::span<const PagmoAlgorithm> pagmo_algorithms();

/// Finds an algorithm by its name; null if none has it.
[[nodiscard]] const PagmoAlgorithm* find_pagmo_algorithm(std::string_view name);

/// Implements search() for an experiment whose method is PagmoSettings that check_method() accepts, and that has more
/// than one candidate.
///
/// It returns "generations used up", or earlier "converged": when the algorithm has no further requests. An algorithm
/// that stagnates also converges when the whole population is one candidate, or when all requests of a generation lie
/// within half a step of each value set.
[[nodiscard]] std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
