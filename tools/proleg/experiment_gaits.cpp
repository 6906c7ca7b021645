#include "tools/proleg/experiment_gaits.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "shared/computer/output/output.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// A scenario of the experiment that has no search, in the engine of the searches.
sim::Scenario reference_scenario(const optimize::ReferenceScenario& reference, const optimize::Experiment& experiment,
                                 const fs::path& folder) {
  if (reference.file.empty()) {
    return experiment.scenario;
  }
  sim::DiskFiles files;
  sim::Scenario scenario = sim::read_scenario(folder / reference.file, files);
  scenario.environment.engine = experiment.scenario.environment.engine;
  return scenario;
}

/// The scenario with the best values that a method has found.
sim::Scenario best_scenario(const optimize::Experiment& experiment, const MethodResult& result) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(result.best->candidate, scenario);
  return scenario;
}

std::vector<NamedGait> gaits_to_check(const optimize::ThesisExperiment& thesis, const std::vector<ChosenMethod>& chosen,
                                      const std::vector<MethodResult>& results, const fs::path& scenarios) {
  std::vector<NamedGait> gaits;
  for (const optimize::ReferenceScenario& reference : thesis.references) {
    if (reference.file != thesis.level_ground) {
      gaits.push_back(
          {std::string(reference.short_name), reference_scenario(reference, chosen.front().experiment, scenarios)});
    }
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    gaits.push_back({results[i].runs.method, best_scenario(chosen[i].experiment, results[i])});
  }
  return gaits;
}

}  // namespace

std::vector<optimize::Reference> reference_distances(const optimize::ThesisExperiment& thesis,
                                                     const optimize::Experiment& experiment,
                                                     const fs::path& scenarios) {
  std::vector<optimize::Reference> references;
  for (const optimize::ReferenceScenario& reference : thesis.references) {
    optimize::Experiment without_search = experiment;
    without_search.scenario = reference_scenario(reference, experiment, scenarios);
    without_search.space.dimensions.clear();
    optimize::Task task;
    const optimize::Objective& distance = experiment.objectives.front();
    const double searched = distance.score(optimize::run_trial(without_search, task).measures);
    double judged = searched;
    if (optimize::is_judged(experiment)) {
      task.trial = experiment.trials.count;
      judged = distance.score(optimize::run_trial(without_search, task).measures);
    }
    references.push_back({&reference, searched, judged});
  }
  return references;
}

std::vector<CheckedGait> check_gaits(const optimize::ThesisExperiment& thesis, const std::vector<ChosenMethod>& chosen,
                                     const std::vector<MethodResult>& results, const fs::path& scenarios,
                                     const fs::path& folder) {
  const optimize::Experiment& first = chosen.front().experiment;
  const auto level = std::ranges::find(thesis.references, thesis.level_ground, &optimize::ReferenceScenario::file);
  const sim::EnvironmentModel level_ground = reference_scenario(*level, first, scenarios).environment;
  std::vector<CheckedGait> checks;
  std::vector<optimize::RulerMark> marks;
  for (NamedGait& gait : gaits_to_check(thesis, chosen, results, scenarios)) {
    checks.push_back(check_gait(std::move(gait), level_ground, first.objectives.front()));
    marks.push_back({checks.back().name, checks.back().distance_m});
  }
  const auto score = [](const MethodResult& result) { return result.best->scores.front(); };
  const auto farthest = std::ranges::max_element(results, {}, score);
  const sim::Scenario best =
      best_scenario(chosen[static_cast<std::size_t>(farthest - results.begin())].experiment, *farthest);
  write_file(folder / "figure_6_8.svg", optimize::draw_crossing(best, crossing_stages(best)));
  write_file(folder / "figure_7_3.svg", optimize::draw_distances(best, marks));
  return checks;
}

}  // namespace proleg::tools
