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

/// pagmo's criteria of convergence are absolute numbers, which fit no scale of scores and steps: they are off.
constexpr double never = 0.0;
constexpr unsigned one_generation = 1;
constexpr bool remember = true;
constexpr bool inside_bounds = true;

unsigned evaluations(const PagmoSetup& setup) {
  const std::uint64_t count = std::uint64_t{setup.settings.generations} * setup.settings.population;
  return static_cast<unsigned>(std::min<std::uint64_t>(count, std::numeric_limits<unsigned>::max()));
}

algorithm make_bee_colony(const PagmoSetup& setup) {
  return algorithm{pagmo::bee_colony(setup.settings.generations, 20, setup.seed)};
}

algorithm make_cmaes(const PagmoSetup& setup) {
  return algorithm{pagmo::cmaes(one_generation, -1, -1, -1, -1, setup.settings.sigma0.value_or(0.5), never, never,
                                remember, inside_bounds, setup.seed)};
}

algorithm make_compass_search(const PagmoSetup& setup) {
  // The search ends at half a step of the widest variable: then it has tried all neighbours.
  return algorithm{pagmo::compass_search(evaluations(setup), 0.5, 0.5 / (setup.max_index + 1.0), 0.5)};
}

algorithm make_de(const PagmoSetup& setup) {
  return algorithm{pagmo::de(one_generation, setup.settings.scale.value_or(0.8), setup.settings.crossover.value_or(0.9),
                             2, never, never, setup.seed)};
}

algorithm make_de1220(const PagmoSetup& setup) {
  return algorithm{pagmo::de1220(one_generation, pagmo::de1220_statics<void>::allowed_variants, 1, never, never,
                                 remember, setup.seed)};
}

algorithm make_gaco(const PagmoSetup& setup) {
  const unsigned archive = setup.settings.population;
  return algorithm{pagmo::gaco(one_generation, archive, 1.0, 0.0, 0.01, 1, 7, std::numeric_limits<unsigned>::max(),
                               std::numeric_limits<unsigned>::max(), 0.0, remember, setup.seed)};
}

algorithm make_gwo(const PagmoSetup& setup) { return algorithm{pagmo::gwo(setup.settings.generations, setup.seed)}; }

algorithm make_ihs(const PagmoSetup& setup) {
  return algorithm{pagmo::ihs(evaluations(setup), 0.85, 0.35, 0.99, 1e-5, 1.0, setup.seed)};
}

algorithm make_maco(const PagmoSetup& setup) {
  const unsigned archive = setup.settings.population;
  return algorithm{
      pagmo::maco(one_generation, archive, 1.0, 1, 7, std::numeric_limits<unsigned>::max(), 0.0, remember, setup.seed)};
}

algorithm make_moead(const PagmoSetup& setup) {
  // For three objectives a grid of weights exists only for some sizes of the population.
  const char* weights = setup.objectives == 2 ? "grid" : "low discrepancy";
  return algorithm{pagmo::moead(one_generation, weights, "tchebycheff", std::min(20U, setup.settings.population - 1),
                                1.0, 0.5, 20.0, 0.9, 2, true, setup.seed)};
}

algorithm make_nsga2(const PagmoSetup& setup) {
  const double below_one = std::nextafter(1.0, 0.0);  // pagmo accepts no larger number
  return algorithm{pagmo::nsga2(one_generation, std::min(setup.settings.crossover.value_or(0.95), below_one), 10.0,
                                setup.settings.mutation.value_or(0.01), 50.0, setup.seed)};
}

algorithm make_nspso(const PagmoSetup& setup) {
  return algorithm{
      pagmo::nspso(one_generation, 0.6, 2.0, 2.0, 1.0, 0.5, 60, "crowding distance", remember, setup.seed)};
}

algorithm make_pso(const PagmoSetup& setup) {
  return algorithm{pagmo::pso(setup.settings.generations, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, false, setup.seed)};
}

algorithm make_pso_gen(const PagmoSetup& setup) {
  return algorithm{pagmo::pso_gen(setup.settings.generations, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, false, setup.seed)};
}

algorithm make_sade(const PagmoSetup& setup) {
  return algorithm{pagmo::sade(one_generation, 2, 1, never, never, remember, setup.seed)};
}

algorithm make_sea(const PagmoSetup& setup) {
  // A generation of this algorithm is one evaluation.
  return algorithm{pagmo::sea(setup.settings.population, setup.seed)};
}

algorithm make_sga(const PagmoSetup& setup) {
  return algorithm{pagmo::sga(one_generation, setup.settings.crossover.value_or(0.9), 1.0,
                              setup.settings.mutation.value_or(0.02), 1.0, 2, "binomial", "uniform", "tournament",
                              setup.seed)};
}

algorithm make_simulated_annealing(const PagmoSetup& setup) {
  // The temperature has the unit of the cost. It falls from the differences in the first population to a hundredth of
  // them.
  constexpr unsigned bin = 20;
  const std::uint64_t evaluations_each = bin * setup.variables;
  const std::uint64_t temperatures = (evaluations(setup) + evaluations_each - 1) / evaluations_each;
  return algorithm{pagmo::simulated_annealing(setup.cost_spread, setup.cost_spread / 100.0,
                                              static_cast<unsigned>(temperatures), 1, bin, 1.0, setup.seed)};
}

algorithm make_xnes(const PagmoSetup& setup) {
  return algorithm{pagmo::xnes(one_generation, -1, -1, -1, setup.settings.sigma0.value_or(-1.0), never, never, remember,
                               inside_bounds, setup.seed)};
}

constexpr std::array<PagmoAlgorithm, 19> table = {{
    // Columns: name, evolves_by_generation, stagnates.
    {"bee_colony", false, false, make_bee_colony},
    {"cmaes", true, true, make_cmaes},
    {"compass_search", false, false, make_compass_search},
    {"de", true, true, make_de},
    {"de1220", true, true, make_de1220},
    {"gaco", true, true, make_gaco},
    {"gwo", false, true, make_gwo},
    {"ihs", false, false, make_ihs},
    {"maco", true, false, make_maco},
    {"moead", true, false, make_moead},
    {"nsga2", true, false, make_nsga2},
    {"nspso", true, false, make_nspso},
    {"pso", false, true, make_pso},
    {"pso_gen", false, true, make_pso_gen},
    {"sade", true, true, make_sade},
    {"sea", true, false, make_sea},
    {"sga", true, false, make_sga},
    {"simulated_annealing", false, false, make_simulated_annealing},
    {"xnes", true, true, make_xnes},
}};

}  // namespace

std::span<const PagmoAlgorithm> pagmo_algorithms() { return table; }

const PagmoDeclaration& PagmoAlgorithm::declaration() const {
  return *std::ranges::find(pagmo_declarations(), name, &PagmoDeclaration::name);
}

const PagmoAlgorithm* find_pagmo_algorithm(std::string_view name) {
  const auto* const found = std::ranges::find(table, name, &PagmoAlgorithm::name);
  return found == table.end() ? nullptr : found;
}

}  // namespace proleg::optimize
