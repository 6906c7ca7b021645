#pragma once

// The algorithms of pagmo 2.18 that search without derivatives, and what each of them wants.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/optimize/experiment/method_settings.hpp"

namespace pagmo {
class algorithm;
}

namespace proleg::optimize {

/// What an algorithm is made from. PagmoSettings that are not given have pagmo's default.
struct PagmoMaking {
  const PagmoSettings& settings;
  unsigned seed;
  std::size_t variables;  ///< of the problem
  double largest_index;   ///< upper end of the widest variable, in steps
  double spread;          ///< of the costs in the first population; above 0
  std::size_t objectives;
};

struct PagmoAlgorithm {
  enum class Objectives : std::uint8_t { one, several, any };

  std::string_view name;              ///< pagmo's
  Objectives objectives;              ///< that it can deal with
  std::uint32_t least_population;     ///< that pagmo accepts without refusal (or crash)
  std::uint32_t population_multiple;  ///< the population must be one of this
  /// Whether one evolve() a generation is as good as one for all generations: the algorithm remembers what it needs, or
  /// needs nothing. The others (a cooling schedule, say) are made for all generations and evolve once.
  bool goes_on;
  /// Whether it is stuck when its candidates do not differ any more.
  bool settles;
  pagmo::algorithm (*make)(const PagmoMaking& making);
};

/// By name.
[[nodiscard]] std::span<const PagmoAlgorithm> pagmo_algorithms();

/// Null if there is none of that name.
[[nodiscard]] const PagmoAlgorithm* find_pagmo_algorithm(std::string_view name);

}  // namespace proleg::optimize
