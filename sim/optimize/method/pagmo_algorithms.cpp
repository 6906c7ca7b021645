#include "sim/optimize/method/pagmo_algorithms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/bee_colony.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/compass_search.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/de1220.hpp>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/gwo.hpp>
#include <pagmo/algorithms/ihs.hpp>
#include <pagmo/algorithms/maco.hpp>
#include <pagmo/algorithms/moead.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/algorithms/pso.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/algorithms/sade.hpp>
#include <pagmo/algorithms/sea.hpp>
#include <pagmo/algorithms/sga.hpp>
#include <pagmo/algorithms/simulated_annealing.hpp>
#include <pagmo/algorithms/xnes.hpp>

namespace proleg::optimize {

namespace {

using pagmo::algorithm;
using enum PagmoAlgorithm::Objectives;

/// pagmo's criteria of convergence compare with absolute numbers, which know neither scores nor steps: never.
constexpr double never = 0.0;
constexpr unsigned one_generation = 1;
constexpr bool remember = true;
constexpr bool inside_bounds = true;

unsigned evaluations(const PagmoMaking& making) {
  const std::uint64_t count = std::uint64_t{making.settings.generations} * making.settings.population;
  return static_cast<unsigned>(std::min<std::uint64_t>(count, std::numeric_limits<unsigned>::max()));
}

algorithm make_bee_colony(const PagmoMaking& making) {
  return algorithm{pagmo::bee_colony(making.settings.generations, 20, making.seed)};
}

algorithm make_cmaes(const PagmoMaking& making) {
  return algorithm{pagmo::cmaes(one_generation, -1, -1, -1, -1, making.settings.sigma0.value_or(0.5), never, never,
                                remember, inside_bounds, making.seed)};
}

algorithm make_compass_search(const PagmoMaking& making) {
  // Down to half a step of the widest variable; then it has tried all neighbours.
  return algorithm{pagmo::compass_search(evaluations(making), 0.5, 0.5 / (making.largest_index + 1.0), 0.5)};
}

algorithm make_de(const PagmoMaking& making) {
  return algorithm{pagmo::de(one_generation, making.settings.scale.value_or(0.8),
                             making.settings.crossover.value_or(0.9), 2, never, never, making.seed)};
}

algorithm make_de1220(const PagmoMaking& making) {
  return algorithm{pagmo::de1220(one_generation, pagmo::de1220_statics<void>::allowed_variants, 1, never, never,
                                 remember, making.seed)};
}

algorithm make_gaco(const PagmoMaking& making) {
  const unsigned archive = making.settings.population;
  return algorithm{pagmo::gaco(one_generation, archive, 1.0, 0.0, 0.01, 1, 7, std::numeric_limits<unsigned>::max(),
                               std::numeric_limits<unsigned>::max(), 0.0, remember, making.seed)};
}

algorithm make_gwo(const PagmoMaking& making) {
  return algorithm{pagmo::gwo(making.settings.generations, making.seed)};
}

algorithm make_ihs(const PagmoMaking& making) {
  return algorithm{pagmo::ihs(evaluations(making), 0.85, 0.35, 0.99, 1e-5, 1.0, making.seed)};
}

algorithm make_maco(const PagmoMaking& making) {
  const unsigned archive = making.settings.population;
  return algorithm{pagmo::maco(one_generation, archive, 1.0, 1, 7, std::numeric_limits<unsigned>::max(), 0.0, remember,
                               making.seed)};
}

algorithm make_moead(const PagmoMaking& making) {
  // A grid of weights for three objectives exists for some sizes of the population only.
  const char* weights = making.objectives == 2 ? "grid" : "low discrepancy";
  return algorithm{pagmo::moead(one_generation, weights, "tchebycheff", std::min(20U, making.settings.population - 1),
                                1.0, 0.5, 20.0, 0.9, 2, true, making.seed)};
}

algorithm make_nsga2(const PagmoMaking& making) {
  const double below_one = std::nextafter(1.0, 0.0);  // which pagmo demands
  return algorithm{pagmo::nsga2(one_generation, std::min(making.settings.crossover.value_or(0.95), below_one), 10.0,
                                making.settings.mutation.value_or(0.01), 50.0, making.seed)};
}

algorithm make_nspso(const PagmoMaking& making) {
  return algorithm{
      pagmo::nspso(one_generation, 0.6, 2.0, 2.0, 1.0, 0.5, 60, "crowding distance", remember, making.seed)};
}

algorithm make_pso(const PagmoMaking& making) {
  return algorithm{pagmo::pso(making.settings.generations, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, false, making.seed)};
}

algorithm make_pso_gen(const PagmoMaking& making) {
  return algorithm{pagmo::pso_gen(making.settings.generations, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, false, making.seed)};
}

algorithm make_sade(const PagmoMaking& making) {
  return algorithm{pagmo::sade(one_generation, 2, 1, never, never, remember, making.seed)};
}

algorithm make_sea(const PagmoMaking& making) {
  // Its generation is one evaluation.
  return algorithm{pagmo::sea(making.settings.population, making.seed)};
}

algorithm make_sga(const PagmoMaking& making) {
  return algorithm{pagmo::sga(one_generation, making.settings.crossover.value_or(0.9), 1.0,
                              making.settings.mutation.value_or(0.02), 1.0, 2, "binomial", "uniform", "tournament",
                              making.seed)};
}

algorithm make_simulated_annealing(const PagmoMaking& making) {
  // The temperature has the unit of the cost: from the differences in the first population down to a hundredth of them.
  constexpr unsigned bin = 20;
  const std::uint64_t evaluations_each = bin * making.variables;
  const std::uint64_t temperatures = (evaluations(making) + evaluations_each - 1) / evaluations_each;
  return algorithm{pagmo::simulated_annealing(making.spread, making.spread / 100.0, static_cast<unsigned>(temperatures),
                                              1, bin, 1.0, making.seed)};
}

algorithm make_xnes(const PagmoMaking& making) {
  return algorithm{pagmo::xnes(one_generation, -1, -1, -1, making.settings.sigma0.value_or(-1.0), never, never,
                               remember, inside_bounds, making.seed)};
}

constexpr std::array<PagmoAlgorithm, 19> table = {{
    // name, objectives, least population and its multiple, goes on, settles
    {"bee_colony", one, 2, 1, false, false, make_bee_colony},
    {"cmaes", one, 5, 1, true, true, make_cmaes},
    {"compass_search", one, 1, 1, false, false, make_compass_search},
    {"de", one, 5, 1, true, true, make_de},
    {"de1220", one, 7, 1, true, true, make_de1220},
    {"gaco", one, 2, 1, true, true, make_gaco},
    {"gwo", one, 3, 1, false, true, make_gwo},
    {"ihs", any, 1, 1, false, false, make_ihs},
    {"maco", several, 2, 1, true, false, make_maco},
    {"moead", several, 3, 1, true, false, make_moead},
    {"nsga2", several, 8, 4, true, false, make_nsga2},
    {"nspso", several, 2, 1, true, false, make_nspso},
    {"pso", one, 2, 1, false, true, make_pso},
    {"pso_gen", one, 2, 1, false, true, make_pso_gen},
    {"sade", one, 7, 1, true, true, make_sade},
    {"sea", one, 1, 1, true, false, make_sea},
    {"sga", one, 2, 1, true, false, make_sga},
    {"simulated_annealing", one, 1, 1, false, false, make_simulated_annealing},
    {"xnes", one, 4, 1, true, true, make_xnes},
}};

}  // namespace

std::span<const PagmoAlgorithm> pagmo_algorithms() { return table; }

const PagmoAlgorithm* find_pagmo_algorithm(std::string_view name) {
  const auto* const found = std::ranges::find(table, name, &PagmoAlgorithm::name);
  return found == table.end() ? nullptr : found;
}

}  // namespace proleg::optimize
