#include "sim/optimize/method/search.hpp"

#include <algorithm>

#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/optimize/method/genetic.hpp"
#include "sim/optimize/method/great_deluge.hpp"
#include "sim/optimize/method/map_elites.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"

namespace proleg::optimize {
namespace {

bool has_one_candidate(const SearchSpace& space) {
  return std::ranges::all_of(space.dimensions, [](const Dimension& dimension) { return dimension.values.size() == 1; });
}

}  // namespace

std::string search(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  check_method(experiment);
  if (has_one_candidate(experiment.space)) {
    static_cast<void>(source.fitness(Candidate(experiment.space.dimensions.size(), 0)));
    return "there is one candidate only";
  }
  if (experiment.has_baseline) {
    source.set_needed_score(std::nullopt);
    static_cast<void>(source.fitness(experiment.space.nearest(experiment.scenario)));
  }
  if (std::holds_alternative<GreatDelugeSettings>(experiment.method)) {
    return search_great_deluge(experiment, run, source);
  }
  if (std::holds_alternative<GeneticSettings>(experiment.method)) {
    return search_genetic(experiment, run, source);
  }
  if (std::holds_alternative<MapElitesSettings>(experiment.method)) {
    return search_map_elites(experiment, run, source);
  }
  return search_with_pagmo(experiment, run, source);
}

}  // namespace proleg::optimize
