#include "sim/optimize/method/pagmo_method.hpp"

#include <algorithm>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "sim/optimize/method/foresight.hpp"
#include "sim/optimize/method/gait_problem.hpp"
#include "sim/optimize/method/method_seed.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"

namespace proleg::optimize {

namespace {

double spread_of_costs(const pagmo::population& population) {
  const auto [least, most] = std::ranges::minmax(population.get_f(), {}, [](const auto& costs) { return costs[0]; });
  const double spread = most[0] - least[0];
  return spread > 0.0 ? spread : 1.0;
}

double largest_index(const GaitProblemHub& hub) {
  double largest = 0.0;
  for (std::size_t i = 0; i < hub.size(); ++i) {
    largest = std::max(largest, hub.last_index(i));
  }
  return largest;
}

/// Whether all individuals are the same candidate.
bool is_one_candidate(const pagmo::population& population, const GaitProblemHub& hub) {
  const auto& places = population.get_x();
  const Candidate first = hub.candidate(places.front());
  return std::ranges::all_of(places, [&](const auto& place) { return hub.candidate(place) == first; });
}

}  // namespace

std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  const auto& settings = std::get<PagmoSettings>(experiment.method);
  const PagmoAlgorithm& chosen = *find_pagmo_algorithm(settings.algorithm);
  const std::uint64_t seed = method_seed(experiment.seed, run);
  const auto population_seed = static_cast<unsigned>(seed);
  const auto algorithm_seed = static_cast<unsigned>(seed >> 32U);

  GaitProblemHub hub(experiment.space, experiment.objectives, source);
  Foresight foresight(hub, settings.population, chosen.settles);
  const pagmo::problem problem{GaitProblem{hub}};
  source.set_needed_score(std::nullopt);

  pagmo::population population;
  const auto make_population = [&] { return pagmo::population(problem, settings.population, population_seed); };
  foresight.run([&] { static_cast<void>(make_population()); }, [&] { population = make_population(); });

  const pagmo::algorithm algorithm = chosen.make({.settings = settings,
                                                  .seed = algorithm_seed,
                                                  .variables = hub.size(),
                                                  .largest_index = largest_index(hub),
                                                  .spread = spread_of_costs(population),
                                                  .objectives = hub.objectives()});
  const std::uint64_t generations = chosen.goes_on ? settings.generations : std::min(settings.generations, 1U);
  try {
    for (std::uint64_t generation = 0; generation < generations; ++generation) {
      // evolve() changes what the algorithm remembers; a copy remembers what was before.
      const pagmo::algorithm before = algorithm;
      const std::uint64_t asked_before = foresight.asked();
      foresight.run([&] { static_cast<void>(pagmo::algorithm(before).evolve(population)); },
                    [&] { population = algorithm.evolve(population); });
      const std::uint64_t due = chosen.goes_on ? 1 : std::uint64_t{settings.generations} * settings.population;
      if (foresight.asked() - asked_before < due || (chosen.settles && is_one_candidate(population, hub))) {
        return "converged";
      }
    }
  } catch (const Foresight::Settled&) {
    return "converged";
  }
  return "generations used up";
}

}  // namespace proleg::optimize
