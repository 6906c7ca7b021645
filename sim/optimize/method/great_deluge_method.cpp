#include "sim/optimize/method/great_deluge_method.hpp"

#include <algorithm>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <vector>

#include "sim/optimize/method/gait_problem.hpp"
#include "sim/optimize/method/great_deluge.hpp"
#include "sim/optimize/method/method_seed.hpp"

namespace proleg::optimize {
namespace {

Candidate draw_start(const SearchSpace& space, std::uint64_t seed, std::uint32_t chain) {
  Pcg32 noise(scatter(seed ^ 0x7374617274U), chain);
  Candidate start;
  for (const Dimension& dimension : space.dimensions) {
    start.push_back(noise.below(static_cast<std::uint32_t>(dimension.values.size())));
  }
  return start;
}

}  // namespace

std::string search_great_deluge(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  auto settings = std::get<GreatDelugeSettings>(experiment.method);
  const std::uint64_t seed = method_seed(experiment.seed, run);
  const std::uint32_t chains = std::max(settings.chains, 1U);

  std::vector<Candidate> starts;
  for (std::uint32_t chain = 0; chain < chains; ++chain) {
    starts.push_back(settings.start == Start::scenario ? experiment.space.nearest(experiment.scenario)
                                                       : draw_start(experiment.space, seed, chain));
  }
  source.set_needed_score(settings.first_must_pass ? std::optional(settings.water_level) : std::nullopt);
  source.expect(starts);

  // The algorithm maximises. To minimise an objective, it maximises the negative.
  if (experiment.objectives.front().goal == Goal::minimise) {
    settings.water_level = -settings.water_level;
    if (settings.target) {
      settings.target = -*settings.target;
    }
  }
  GaitProblemHub hub(experiment.space, experiment.objectives, source);
  pagmo::population population{pagmo::problem{GaitProblem{hub}}, 0U, static_cast<unsigned>(seed)};
  for (const Candidate& start : starts) {
    population.push_back(hub.numbers(start));
  }
  GreatDeluge deluge(settings, seed);
  deluge.set_scores_depend_on_level(experiment.racing.on());
  const pagmo::algorithm algorithm{deluge};
  population = algorithm.evolve(population);
  return algorithm.extract<GreatDeluge>()->ending();
}

}  // namespace proleg::optimize
