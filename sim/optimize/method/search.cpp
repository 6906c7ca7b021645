#include "sim/optimize/method/search.hpp"

#include <algorithm>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/method/genetic.hpp"
#include "sim/optimize/method/great_deluge.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"

namespace proleg::optimize {
namespace {

[[noreturn]] void refuse(const Experiment& experiment, const std::string& found, const std::string& expected) {
  throw InputError(experiment.path, experiment.method_line, found, expected);
}

void check_objectives(const Experiment& experiment, const std::string& method, PagmoAlgorithm::Objectives known) {
  const std::size_t count = experiment.objectives.size();
  const std::string found = std::to_string(count) + (count == 1 ? " objective" : " objectives") + " for " + method;
  if (known == PagmoAlgorithm::Objectives::one && count != 1) {
    refuse(experiment, found,
           "one objective (a weighted sum of measures is one), or a method for several: " +
               std::string("nsga2, moead, nspso, maco, ihs"));
  }
  if (known == PagmoAlgorithm::Objectives::several && count < 2) {
    refuse(experiment, found, "at least two objectives");
  }
}

void check_number(const Experiment& experiment, const PagmoAlgorithm& algorithm, std::string_view option,
                  const std::optional<double>& value, bool may_be_zero) {
  if (!value) {
    return;
  }
  const std::string name(algorithm.name);
  if (const std::vector<std::string> known = pagmo_options(name); std::ranges::count(known, option) == 0) {
    refuse(experiment, std::string(option) + " for " + name,
           known.empty() ? "no such setting: " + name + " has none" : "one of its settings: " + listed(known));
  }
  if (!(*value > 0.0 && *value <= 1.0) && !(*value == 0.0 && may_be_zero)) {
    refuse(experiment, std::string(option) + " " + std::to_string(*value),
           may_be_zero ? "a number from 0 to 1" : "a number above 0, at most 1");
  }
}

void check_pagmo(const Experiment& experiment, const PagmoSettings& settings) {
  const PagmoAlgorithm* const algorithm = find_pagmo_algorithm(settings.algorithm);
  if (algorithm == nullptr) {
    std::vector<std::string> known;
    for (const PagmoAlgorithm& each : pagmo_algorithms()) {
      known.emplace_back(each.name);
    }
    refuse(experiment, "algorithm " + in_quotes(settings.algorithm), "one of " + listed(known));
  }
  check_objectives(experiment, settings.algorithm, algorithm->objectives);
  if (settings.population < algorithm->min_population || settings.population % algorithm->population_multiple != 0) {
    std::string expected = "at least " + std::to_string(algorithm->min_population);
    if (algorithm->population_multiple > 1) {
      expected += ", and a multiple of " + std::to_string(algorithm->population_multiple);
    }
    refuse(experiment, "a population of " + std::to_string(settings.population) + " for " + settings.algorithm,
           expected);
  }
  check_number(experiment, *algorithm, "sigma0", settings.sigma0, false);
  check_number(experiment, *algorithm, "crossover", settings.crossover, true);
  check_number(experiment, *algorithm, "scale", settings.scale, true);
  check_number(experiment, *algorithm, "mutation", settings.mutation, true);
}

/// A repeated evaluation with the same random numbers gives no information.
void check_reevaluations(const Experiment& experiment, const GreatDelugeSettings& settings) {
  if (settings.reevaluations > 0 && experiment.trials.random_numbers == RandomNumbers::common &&
      depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread)) {
    refuse(experiment, std::to_string(settings.reevaluations) + " reevaluations that are all equal",
           "0, or randomNumbers=\"fresh\" in <trials>");
  }
}

bool has_one_candidate(const SearchSpace& space) {
  return std::ranges::all_of(space.dimensions, [](const Dimension& dimension) { return dimension.values.size() == 1; });
}

}  // namespace

void check_method(const Experiment& experiment) {
  if (const auto* settings = std::get_if<PagmoSettings>(&experiment.method)) {
    check_pagmo(experiment, *settings);
  } else if (const auto* deluge = std::get_if<GreatDelugeSettings>(&experiment.method)) {
    check_objectives(experiment, "great-deluge", PagmoAlgorithm::Objectives::one);
    check_reevaluations(experiment, *deluge);
  } else {
    check_objectives(experiment, "genetic", PagmoAlgorithm::Objectives::one);
  }
}

std::uint64_t planned_evaluations(const Experiment& experiment) {
  const auto* const settings = std::get_if<PagmoSettings>(&experiment.method);
  if (settings == nullptr) {
    return experiment.evaluations;
  }
  const std::uint64_t all =
      (std::uint64_t{settings->generations} + 1) * settings->population + (experiment.has_baseline ? 1 : 0);
  return experiment.evaluations == 0 ? all : std::min(all, experiment.evaluations);
}

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
  return search_with_pagmo(experiment, run, source);
}

}  // namespace proleg::optimize
