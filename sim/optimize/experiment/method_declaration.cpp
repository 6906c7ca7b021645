#include "sim/optimize/experiment/method_declaration.hpp"

#include <algorithm>
#include <optional>
#include <variant>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {
namespace {

constexpr std::array<PagmoDeclaration, 19> pagmo_entries = {{
    // Columns: name, objectives, min_population, population_multiple, title, help. (The third column is what pagmo 2.18
    // asks for.)
    {"bee_colony", ObjectiveCount::one, 2, 1, "Artificial bee colony",
     "looks around many places, and gives up the poor ones"},
    {"cmaes", ObjectiveCount::one, 5, 1, "CMA-ES",
     "learns which values belong together; for most searches, it needs the fewest evaluations"},
    {"compass_search", ObjectiveCount::one, 1, 1, "Compass search",
     "tries one value after the other up and down; local"},
    {"de", ObjectiveCount::one, 5, 1, "Differential evolution",
     "steps along differences of candidates; for rugged scores"},
    {"de1220", ObjectiveCount::one, 7, 1, "Differential evolution, self-adaptive (pDE)",
     "chooses its own settings and variants"},
    {"gaco", ObjectiveCount::one, 2, 1, "Extended ant colony", "draws candidates around an archive of good ones"},
    {"gwo", ObjectiveCount::one, 3, 1, "Grey wolf optimizer", "moves all candidates towards the three best"},
    {"ihs", ObjectiveCount::any, 1, 1, "Improved harmony search",
     "puts candidates together of values of others; for one objective or more"},
    {"maco", ObjectiveCount::several, 2, 1, "Ant colony, several objectives",
     "draws candidates around an archive of good ones"},
    {"moead", ObjectiveCount::several, 3, 1, "MOEA/D", "divides several objectives into many weighted sums"},
    {"nsga2", ObjectiveCount::several, 8, 4, "NSGA-II",
     "for several objectives: finds the candidates that no other beats in all of them"},
    {"nspso", ObjectiveCount::several, 2, 1, "Particle swarm, several objectives",
     "moves candidates towards the best front"},
    {"pso", ObjectiveCount::one, 2, 1, "Particle swarm", "moves candidates towards the best ones that they know"},
    {"pso_gen", ObjectiveCount::one, 2, 1, "Particle swarm, by generation", "as particle swarm, but all move at once"},
    {"sade", ObjectiveCount::one, 7, 1, "Differential evolution, self-adaptive (SADE)", "chooses its own settings"},
    {"sea", ObjectiveCount::one, 1, 1, "Simple evolution", "changes one value of the best candidate at a time"},
    {"sga", ObjectiveCount::one, 2, 1, "Genetic algorithm of pagmo", "crosses and mutates candidates"},
    {"simulated_annealing", ObjectiveCount::one, 1, 1, "Simulated annealing", "accepts worse candidates less and less"},
    {"xnes", ObjectiveCount::one, 4, 1, "xNES",
     "follows the natural gradient of a normal distribution; near to CMA-ES"},
}};

[[noreturn]] void refuse(const Experiment& experiment, const std::string& found, const std::string& expected) {
  throw InputError(experiment.path, experiment.method_line, found, expected);
}

void check_objectives(const Experiment& experiment, const std::string& method, ObjectiveCount known) {
  const std::size_t count = experiment.objectives.size();
  const std::string found = std::to_string(count) + (count == 1 ? " objective" : " objectives") + " for " + method;
  if (known == ObjectiveCount::one && count != 1) {
    refuse(experiment, found,
           "one objective (a weighted sum of measures is one), or a method for several: " +
               std::string("nsga2, moead, nspso, maco, ihs"));
  }
  if (known == ObjectiveCount::several && count < 2) {
    refuse(experiment, found, "at least two objectives");
  }
}

void check_number(const Experiment& experiment, const PagmoDeclaration& algorithm, std::string_view option,
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
  const auto* const algorithm = std::ranges::find(pagmo_entries, settings.algorithm, &PagmoDeclaration::name);
  if (algorithm == pagmo_entries.end()) {
    std::vector<std::string> known;
    known.reserve(pagmo_entries.size());
    for (const PagmoDeclaration& each : pagmo_entries) {
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

/// The axes have measures of their own: only the first objective rates.
void check_map(const Experiment& experiment) {
  const std::size_t count = experiment.axes.size();
  if (count < min_map_axes || count > max_map_axes) {
    refuse(experiment, std::to_string(count) + (count == 1 ? " <axis>" : " <axis>es") + " in <fitness>", "two to four");
  }
  const std::uint32_t centroids = std::get<MapElitesSettings>(experiment.method).centroids;
  if (centroids > 0 && centroids < min_centroids) {
    refuse(experiment, std::to_string(centroids) + " centroid",
           std::to_string(min_centroids) + " or more, or 0 for a grid");
  }
  std::size_t cells = 1;
  for (const MapAxis& axis : experiment.axes) {
    cells *= axis.cells;
    if (cells > max_map_cells) {
      refuse(experiment, "more than " + std::to_string(max_map_cells) + " cells of the map", "fewer, in all");
    }
  }
  const std::size_t objectives = experiment.objectives.size() - count;
  if (objectives != 1) {
    refuse(experiment, std::to_string(objectives) + " objectives for map-elites",
           "one objective (a weighted sum of measures is one)");
  }
}

}  // namespace

std::span<const PagmoDeclaration> pagmo_declarations() { return pagmo_entries; }

void check_method(const Experiment& experiment) {
  if (const auto* settings = std::get_if<PagmoSettings>(&experiment.method)) {
    check_pagmo(experiment, *settings);
  } else if (const auto* deluge = std::get_if<GreatDelugeSettings>(&experiment.method)) {
    check_objectives(experiment, "great-deluge", ObjectiveCount::one);
    check_reevaluations(experiment, *deluge);
  } else if (std::holds_alternative<MapElitesSettings>(experiment.method)) {
    check_map(experiment);
  } else {
    check_objectives(experiment, "genetic", ObjectiveCount::one);
  }
}

}  // namespace proleg::optimize
