#include "sim/optimize/method/pagmo_method.hpp"

#include <algorithm>
#include <cmath>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "sim/optimize/experiment/scatter.hpp"
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

/// One search after another, each from a population of its own, until the generations are used up.
class PagmoSearch {
 public:
  PagmoSearch(const Experiment& experiment, std::uint64_t seed, FitnessSource& source)
      : settings_(std::get<PagmoSettings>(experiment.method)),
        chosen_(*find_pagmo_algorithm(settings_.algorithm)),
        seed_(seed),
        hub_(experiment.space, experiment.objectives, source),
        problem_(GaitProblem{hub_}),
        generations_(chosen_.goes_on ? settings_.generations : std::min(settings_.generations, 1U)) {
    source.set_needed_score(std::nullopt);
  }

  std::string run() {
    for (std::uint64_t start = 0;; ++start) {
      const std::string ending = run_from(start == 0 ? seed_ : scatter(seed_ + start));
      if (settings_.restart_after == 0 || !chosen_.goes_on || generations_ == 0) {
        return ending;
      }
    }
  }

 private:
  /// Uses generations up until there are none, or nothing more to gain; returns which. At least one is used.
  std::string run_from(std::uint64_t seed) {
    Foresight foresight(hub_, settings_.population, chosen_.settles);
    try {
      pagmo::population population;
      const auto make_population = [&] {
        return pagmo::population(problem_, settings_.population, static_cast<unsigned>(seed));
      };
      foresight.run([&] { static_cast<void>(make_population()); }, [&] { population = make_population(); });
      const pagmo::algorithm algorithm = chosen_.make({.settings = settings_,
                                                       .seed = static_cast<unsigned>(seed >> 32U),
                                                       .variables = hub_.size(),
                                                       .largest_index = largest_index(hub_),
                                                       .spread = spread_of_costs(population),
                                                       .objectives = hub_.objectives()});
      double best = best_cost(population);
      std::uint32_t without_gain = 0;
      while (generations_ > 0 && (without_gain < settings_.restart_after || settings_.restart_after == 0)) {
        --generations_;
        // evolve() changes what the algorithm remembers; a copy remembers what was before.
        const pagmo::algorithm before = algorithm;
        const std::uint64_t asked_before = foresight.asked();
        foresight.run([&] { static_cast<void>(pagmo::algorithm(before).evolve(population)); },
                      [&] { population = algorithm.evolve(population); });
        const std::uint64_t due = chosen_.goes_on ? 1 : std::uint64_t{settings_.generations} * settings_.population;
        if (foresight.asked() - asked_before < due || (chosen_.settles && is_one_candidate(population, hub_))) {
          return "converged";
        }
        const double now = best_cost(population);
        const bool gained = best - now >= 0.001 * std::abs(best);
        without_gain = gained ? 0 : without_gain + 1;
        best = gained ? now : best;
      }
    } catch (const Foresight::Settled&) {
      return "converged";  // which takes a generation to see
    }
    return "generations used up";
  }

  /// Of the first objective.
  static double best_cost(const pagmo::population& population) {
    return std::ranges::min(population.get_f(), {}, [](const auto& costs) { return costs[0]; })[0];
  }

  const PagmoSettings& settings_;
  const PagmoAlgorithm& chosen_;
  std::uint64_t seed_;
  GaitProblemHub hub_;
  pagmo::problem problem_;
  std::uint64_t generations_;  ///< left
};

}  // namespace

std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  return PagmoSearch(experiment, method_seed(experiment.seed, run), source).run();
}

}  // namespace proleg::optimize
