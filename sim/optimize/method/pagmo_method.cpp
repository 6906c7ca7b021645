#include "sim/optimize/method/pagmo_method.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <vector>

#include "sim/optimize/experiment/scatter.hpp"
#include "sim/optimize/method/gait_problem.hpp"
#include "sim/optimize/method/method_seed.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/optimize/method/request_predictor.hpp"

namespace proleg::optimize {

namespace {

double spread_of_costs(const pagmo::population& population) {
  const auto [min, max] = std::ranges::minmax(population.get_f(), {}, [](const auto& costs) { return costs[0]; });
  const double spread = max[0] - min[0];
  return spread > 0.0 ? spread : 1.0;
}

double max_index(const GaitProblemHub& hub) {
  double max = 0.0;
  for (std::size_t i = 0; i < hub.size(); ++i) {
    max = std::max(max, hub.last_index(i));
  }
  return max;
}

/// Whether all individuals are the same candidate.
bool is_one_candidate(const pagmo::population& population, const GaitProblemHub& hub) {
  const auto& places = population.get_x();
  const Candidate first = hub.candidate(places.front());
  return std::ranges::all_of(places, [&](const auto& place) { return hub.candidate(place) == first; });
}

/// Runs searches one after another, each from its own population, until the generations are used up.
class PagmoSearch {
 public:
  PagmoSearch(const Experiment& experiment, std::uint64_t seed, FitnessSource& source)
      : settings_(std::get<PagmoSettings>(experiment.method)),
        chosen_(*find_pagmo_algorithm(settings_.algorithm)),
        seed_(seed),
        hub_(experiment.space, experiment.objectives, source),
        own_values_(settings_.start == Start::scenario
                        ? std::optional(hub_.numbers(experiment.space.nearest(experiment.scenario)))
                        : std::nullopt),
        problem_(GaitProblem{hub_}),
        generations_(chosen_.evolves_by_generation ? settings_.generations : std::min(settings_.generations, 1U)) {
    source.set_needed_score(std::nullopt);
  }

  std::string run() {
    for (std::uint64_t start = 0;; ++start) {
      const std::string ending = run_from(start == 0 ? seed_ : scatter(seed_ + start));
      if (settings_.restart_after == 0 || !chosen_.evolves_by_generation || generations_ == 0) {
        return ending;
      }
    }
  }

 private:
  /// Searches for at least one generation, until none is left or the search converges. Returns why it ended.
  std::string run_from(std::uint64_t seed) {
    RequestPredictor predictor(hub_, settings_.population, chosen_.stagnates);
    try {
      pagmo::population population;
      predictor.run([&] { static_cast<void>(make_population(seed)); }, [&] { population = make_population(seed); });
      own_values_.reset();
      const pagmo::algorithm algorithm = chosen_.make({.settings = settings_,
                                                       .seed = static_cast<unsigned>(seed >> 32U),
                                                       .variables = hub_.size(),
                                                       .max_index = max_index(hub_),
                                                       .cost_spread = spread_of_costs(population),
                                                       .objectives = hub_.objectives()});
      double best = best_cost(population);
      std::uint32_t without_gain = 0;
      while (generations_ > 0 && (without_gain < settings_.restart_after || settings_.restart_after == 0)) {
        --generations_;
        // evolve() changes the state of the algorithm; the copy has the state before it.
        const pagmo::algorithm before = algorithm;
        const std::uint64_t asked_before = predictor.asked();
        predictor.run([&] { static_cast<void>(pagmo::algorithm(before).evolve(population)); },
                      [&] { population = algorithm.evolve(population); });
        const std::uint64_t due =
            chosen_.evolves_by_generation ? 1 : std::uint64_t{settings_.generations} * settings_.population;
        if (predictor.asked() - asked_before < due || (chosen_.stagnates && is_one_candidate(population, hub_))) {
          return "converged";
        }
        const double now = best_cost(population);
        const bool gained = now < best && best - now >= 0.001 * std::abs(best);
        without_gain = gained ? 0 : without_gain + 1;
        best = gained ? now : best;
      }
    } catch (const RequestPredictor::Stagnated&) {
      return "converged";
    }
    return "generations used up";
  }

  [[nodiscard]] pagmo::population make_population(std::uint64_t seed) const {
    const std::uint32_t random = settings_.population - (own_values_ ? 1 : 0);
    pagmo::population population(problem_, random, static_cast<unsigned>(seed));
    if (own_values_) {
      population.push_back(*own_values_);
    }
    return population;
  }

  /// Best cost of the first objective.
  static double best_cost(const pagmo::population& population) {
    return std::ranges::min(population.get_f(), {}, [](const auto& costs) { return costs[0]; })[0];
  }

  const PagmoSettings& settings_;
  const PagmoAlgorithm& chosen_;
  std::uint64_t seed_;
  GaitProblemHub hub_;
  std::optional<std::vector<double>> own_values_;  ///< values in the first population of the first start
  pagmo::problem problem_;
  std::uint64_t generations_;  ///< number of generations left
};

}  // namespace

std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  return PagmoSearch(experiment, method_seed(experiment.seed, run), source).run();
}

}  // namespace proleg::optimize
