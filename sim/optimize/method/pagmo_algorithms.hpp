#pragma once

// The algorithms of pagmo 2.18 that search without derivatives, and what each of them needs.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/optimize/experiment/method_settings.hpp"

namespace pagmo {
class algorithm;
}

namespace proleg::optimize {

/// What an algorithm is made from. PagmoSettings without a value have pagmo's default.
struct PagmoSetup {
  const PagmoSettings& settings;
  unsigned seed;
  std::size_t variables;  ///< of the problem
  double max_index;       ///< upper end of the widest variable, in steps
  double cost_spread;     ///< of the costs in the first population; above 0
  std::size_t objectives;
};

struct PagmoAlgorithm {
  enum class Objectives : std::uint8_t { one, several, any };

  std::string_view name;              ///< pagmo's
  Objectives objectives;              ///< that it can deal with
  std::uint32_t min_population;       ///< below it pagmo throws or crashes
  std::uint32_t population_multiple;  ///< the population must be a multiple of this
  /// Whether one evolve() for each generation equals one for all: the algorithm keeps what it needs, or needs nothing.
  /// The others (with a cooling schedule, for example) are made for all generations and evolve once.
  bool evolves_by_generation;
  /// Whether it cannot find anything new when its candidates no longer differ.
  bool stagnates;
  pagmo::algorithm (*make)(const PagmoSetup& setup);
};

/// By name.
[[nodiscard]] std::span<const PagmoAlgorithm> pagmo_algorithms();

/// Null if there is none of that name.
[[nodiscard]] const PagmoAlgorithm* find_pagmo_algorithm(std::string_view name);

}  // namespace proleg::optimize
