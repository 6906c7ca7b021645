// proleg experiment: repeats an experiment of the thesis and writes its tables and figures beside the published ones.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/environment/physics_engine.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/optimize/report/crossing_figure.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/thesis_experiment.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/gait_checks.hpp"
#include "tools/proleg/json_output.hpp"
#include "tools/proleg/optimisation.hpp"
#include "tools/proleg/repetitions.hpp"
#include "tools/proleg/scenario_run.hpp"
#include "tools/proleg/search_result.hpp"
#include "tools/proleg/worker_count.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
namespace fs = std::filesystem;

struct Options : ExperimentOptions {
  std::string name;
  std::optional<std::string> repetitions;
  std::vector<std::string> methods;
  std::optional<std::string> workers;
  std::optional<std::string> out;
  std::optional<std::string> scenarios;
  bool json = false;
};

/// A method of the experiment, and whether its file is for it; else another algorithm of pagmo searches the file's
/// space.
struct Method {
  std::string name;
  std::string file;
  std::string table;
  std::string runs_figure;
  std::string spread_figure;
  bool shipped = true;
};

/// The methods of the experiment, and the other algorithms of pagmo that search for one objective.
std::vector<Method> all_methods(const optimize::ThesisExperiment& thesis) {
  std::vector<Method> methods;
  for (const optimize::ThesisMethod& method : thesis.methods) {
    methods.push_back({std::string(method.name), std::string(method.file), std::string(method.table),
                       std::string(method.runs_figure), std::string(method.spread_figure)});
  }
  for (const optimize::PagmoAlgorithm& algorithm : optimize::pagmo_algorithms()) {
    const std::string name(algorithm.name);
    if (algorithm.objectives != optimize::PagmoAlgorithm::Objectives::several && name != "cmaes") {
      methods.push_back({name, "cma_es.optimise.xml", "table_" + name + ".tsv", "figure_" + name + "_runs.svg",
                         "figure_" + name + "_spread.svg", false});
    }
  }
  return methods;
}

const optimize::ThesisExperiment& find_experiment(const std::string& name) {
  std::vector<std::string> names;
  for (const optimize::ThesisExperiment* experiment : optimize::thesis_experiments()) {
    if (experiment->name == name) {
      return *experiment;
    }
    names.push_back(in_quotes(experiment->name));
  }
  throw InputError(name, 0, "unknown experiment " + in_quotes(name), listed(names));
}

/// Throws InputError unless there is a method of that name.
void check_method_name(const std::vector<Method>& methods, const std::string& name) {
  if (std::ranges::count(methods, name, &Method::name) == 0) {
    std::vector<std::string> names;
    std::ranges::transform(methods, std::back_inserter(names), &Method::name);
    throw InputError("--method", 0, in_quotes(name), "one of " + listed(names));
  }
}

/// The folder of the scenarios: below the working directory, or below a folder above this program.
fs::path find_scenarios(const Options& options, const std::string& file) {
  const fs::path inside = fs::path("sim") / "scenarios" / options.name;
  std::vector<fs::path> candidates;
  if (options.scenarios) {
    candidates.emplace_back(*options.scenarios);
  } else {
    candidates.push_back(inside);
    std::error_code error;
    for (fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path(); folder.has_relative_path();
         folder = folder.parent_path()) {
      candidates.push_back(folder / inside);
    }
  }
  for (const fs::path& folder : candidates) {
    if (fs::is_regular_file(folder / file)) {
      return folder;
    }
  }
  throw InputError(options.scenarios ? "--scenarios" : options.name, 0, "no " + (candidates.front() / file).string(),
                   "the experiment's files; give their folder with --scenarios");
}

/// A method that takes part, and what it searches.
struct ChosenMethod {
  const Method* method;
  optimize::Experiment experiment;
};

optimize::Experiment read(const Options& options, const fs::path& folder, const Method& method) {
  sim::DiskFiles files;
  optimize::Experiment experiment = optimize::read_experiment(folder / method.file, files);
  if (!method.shipped) {
    optimize::PagmoSettings settings;
    settings.algorithm = method.name;
    experiment.method = settings;
  }
  experiment.has_baseline = false;  // the thesis's searches have none; the references are in the summary
  apply_options(options, experiment);
  return experiment;
}

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

std::vector<optimize::Reference> reference_distances(const optimize::ThesisExperiment& thesis,
                                                     const optimize::Experiment& experiment, const fs::path& folder) {
  std::vector<optimize::Reference> references;
  for (const optimize::ReferenceScenario& reference : thesis.references) {
    optimize::Experiment without_search = experiment;
    without_search.scenario = reference_scenario(reference, experiment, folder);
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

/// The scenario with the best values that a method has found.
sim::Scenario best_scenario(const optimize::Experiment& experiment, const MethodResult& result) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(result.best->candidate, scenario);
  return scenario;
}

/// Whether the store in a folder has all repetitions of this experiment. Its method is then part of the comparison,
/// even if it is not asked for now.
bool is_complete(const optimize::Experiment& experiment, std::uint32_t repetitions, const fs::path& folder) {
  try {
    optimize::Store store(store_path(folder), experiment, result_key, optimize::Store::Opening::resume);
    for (std::uint32_t run = 0; run < repetitions; ++run) {
      if (!has_ended(store, experiment, run)) {
        return false;
      }
    }
    return true;
  } catch (const optimize::StoreError&) {
    return false;  // no store, or one of another experiment
  }
}

/// The mean of the best so far after 100, 200, 400, ... evaluations.
Json course(const optimize::BestCurves& curves) {
  Json means = Json::empty_object();
  for (std::size_t evaluations = 100; evaluations <= curves.mean.size(); evaluations *= 2) {
    means.add(std::to_string(evaluations), curves.mean[evaluations - 1]);
  }
  return means;
}

Json to_json(const MethodResult& result, const optimize::SearchSpace& space, double reference_m) {
  Json runs = Json::empty_array();
  double sum = 0.0;
  for (std::size_t run = 0; run < result.runs.runs.size(); ++run) {
    const double searched = optimize::best_so_far(result.runs.runs[run]).back();
    const double best = result.runs.judged.empty() ? searched : result.runs.judged[run].scores.front();
    sum += best;
    runs.append({{"evaluations", result.runs.runs[run].size()},
                 {"best", best},
                 {"best_in_search", searched},
                 {"ended", result.endings[run]}});
  }
  return {{"method", result.runs.method},
          {"best_score", result.best->scores.front()},
          {"best_values", values_object(space, result.best->candidate)},
          {"gain", result.best->scores.front() / reference_m - 1.0},
          {"mean_best", sum / static_cast<double>(result.runs.runs.size())},
          {"runs", runs},
          {"wall_s", result.wall_s}};
}

/// The references on the obstacle, and the best of each method.
std::vector<NamedGait> gaits_to_check(const optimize::ThesisExperiment& thesis,
                                      const std::vector<MethodResult>& results, const std::vector<ChosenMethod>& chosen,
                                      const fs::path& scenarios) {
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

/// The best of each method in other worlds, the crossing of the farthest one, and all distances on a ruler.
std::vector<CheckedGait> check_gaits(const optimize::ThesisExperiment& thesis, const std::vector<MethodResult>& results,
                                     const std::vector<ChosenMethod>& chosen, const fs::path& scenarios,
                                     const fs::path& folder) {
  const optimize::Experiment& first = chosen.front().experiment;
  const auto level = std::ranges::find(thesis.references, thesis.level_ground, &optimize::ReferenceScenario::file);
  const sim::EnvironmentModel level_ground = reference_scenario(*level, first, scenarios).environment;
  std::vector<CheckedGait> checks;
  std::vector<optimize::RulerMark> marks;
  for (NamedGait& gait : gaits_to_check(thesis, results, chosen, scenarios)) {
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

int say_interrupted(const fs::path& folder) {
  std::cerr << "proleg experiment: interrupted; the same command continues in " << folder.string() << '\n';
  return exit_failed;
}

int experiment(Options options) {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {
    throw BadInput(
        "found mpirun, expected none: an experiment runs on one computer; use 'proleg optimise' on a cluster");
  }
  const optimize::ThesisExperiment& thesis = find_experiment(options.name);
  const std::string repetitions_word = options.repetitions.value_or(std::string(thesis.repetitions));
  const std::optional<std::uint32_t> repetitions = parse_whole<std::uint32_t>(repetitions_word);
  if (!repetitions || *repetitions == 0 || *repetitions > max_repetitions) {
    throw InputError("--repetitions", 0, in_quotes(repetitions_word), "1 to " + std::to_string(max_repetitions));
  }
  if (!options.engine && !thesis.engine.empty()) {
    options.engine = thesis.engine;
  }
  const std::uint32_t worker_count = parse_workers(options.workers);
  const std::vector<Method> methods = all_methods(thesis);
  for (const std::string& name : options.methods) {
    check_method_name(methods, name);
  }
  const fs::path scenarios = find_scenarios(options, methods.front().file);
  const fs::path folder = options.out.value_or(options.name + "_experiment");
  if (folder.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  std::vector<ChosenMethod> chosen;
  for (const Method& method : methods) {
    const bool asked_for =
        options.methods.empty() ? method.shipped : std::ranges::count(options.methods, method.name) > 0;
    if (asked_for || fs::exists(store_path(folder / method.name))) {
      optimize::Experiment experiment = read(options, scenarios, method);
      if (asked_for || is_complete(experiment, *repetitions, folder / method.name)) {
        refuse_overwriting(experiment, folder / method.name);
        chosen.push_back({&method, std::move(experiment)});
      }
    }
  }

  catch_interrupts();
  const auto started = std::chrono::steady_clock::now();
  const std::vector<optimize::Reference> references = reference_distances(thesis, chosen.front().experiment, scenarios);
  const double reference_m = references.front().judged_m;
  std::vector<MethodResult> results;
  std::vector<optimize::MethodRuns> all_runs;
  for (const auto& [method, experiment] : chosen) {
    MethodResult result = run_repetitions(method->name, experiment, *repetitions, worker_count, folder / method->name);
    if (result.runs.runs.size() < *repetitions) {
      return say_interrupted(folder);
    }
    write_file(folder / method->table, optimize::experiment_table(thesis, result.runs));
    write_file(folder / method->runs_figure, optimize::draw_every_run(thesis, result.runs, references));
    write_file(folder / method->spread_figure, optimize::draw_run_spread(thesis, result.runs, references));
    optimize::write_scenario(experiment, *result.best, folder / method->name, "best");
    all_runs.push_back(result.runs);
    results.push_back(std::move(result));
  }
  write_file(folder / thesis.comparison_figure, optimize::draw_method_comparison(thesis, all_runs, references));
  std::vector<CheckedGait> checks;
  if (!thesis.level_ground.empty()) {
    try {
      checks = check_gaits(thesis, results, chosen, scenarios, folder);
    } catch (const CheckInterrupted&) {
      return say_interrupted(folder);
    }
  }
  const std::string engine(sim::name_of(chosen.front().experiment.scenario.environment.engine));
  const std::string judge =
      optimize::is_judged(chosen.front().experiment)
          ? "; the best ten of each run were rated again in " + std::string(sim::name_of(optimize::judging_engine))
          : "";
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  std::array<char, 64> time{};
  std::snprintf(time.data(), time.size(), "time: %.1f min with %u workers\n", wall_s / 60.0, worker_count);
  const std::string summary = optimize::experiment_summary(thesis, all_runs, references) +
                              (checks.empty() ? "" : "\n" + gait_checks_text(checks)) + "\nengine: " + engine + judge +
                              "\n" + time.data();
  write_file(folder / "summary.txt", summary);

  if (!options.json) {
    std::cout << summary << "\ntables, figures and stores are in " << folder.string() << '\n';
    return exit_success;
  }
  std::map<std::string, optimize::BestCurves> curves;
  for (const optimize::MethodRuns& runs : all_runs) {
    curves[runs.method] = optimize::best_curves(runs);
  }
  const auto deluge = curves.find("great-deluge");
  const auto genetic = curves.find("genetic");
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    Json entry = to_json(results[i], chosen[i].experiment.space, reference_m);
    entry.add("mean_best_after", course(curves[results[i].runs.method]));
    if (deluge != curves.end()) {
      entry.add("reaches_mean_of_great_deluge_after",
                optimize::evaluations_to_reach(curves[results[i].runs.method], deluge->second.mean.back()));
    }
    list.append(entry);
  }
  Json differences = Json::empty_array();
  for (const optimize::MethodDifference& difference : optimize::method_differences(all_runs)) {
    differences.append({{"one", difference.one},
                        {"other", difference.other},
                        {"share_above", difference.share_above},
                        {"p_value", difference.p_value}});
  }
  Json distances = Json::empty_object();
  for (const optimize::Reference& reference : references) {
    distances.add(std::string(reference.scenario->short_name), reference.judged_m);
  }
  Json object{{"experiment", options.name}, {"engine", engine}, {"references", distances}, {"methods", list},
              {"differences", differences}, {"wall_s", wall_s}, {"out", folder.string()},  {"build_id", build_id}};
  if (!checks.empty()) {
    object.add("gaits", gait_checks_json(checks));
  }
  if (deluge != curves.end() && genetic != curves.end()) {
    object.add("great_deluge_above_genetic_after", optimize::overtaking(deluge->second, genetic->second));
  }
  std::cout << object.text() << '\n';
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg experiment",
      "Repeats an experiment of the thesis with several methods. Writes its tables and figures with the published "
      "numbers beside. Continues where it was interrupted.");
  Options options;
  command_line
      .add_option("NAME", options.name,
                  "travelling_wave: the amplitudes of section 6.1; adaptive_touch: the constants of section 6.2")
      .required();
  command_line.add_option(
      "--repetitions", options.repetitions,
      "number of searches with each method; default: 3 of travelling_wave, where the thesis made 30; 20 of "
      "adaptive_touch, as the thesis");
  command_line.add_option(
      "--method", options.methods,
      "great-deluge, genetic, cma-es, or another algorithm of pagmo; adaptive_touch also has great-deluge-bounded; may "
      "be repeated; default: those of the thesis, and cma-es. "
      "Methods that the folder already has are shown, too.");
  add_engine_option(command_line, options);
  command_line.add_option("--evaluations", options.evaluations,
                          "maximum number of evaluations in one search; default: that of the files");
  command_line.add_option("--workers", options.workers,
                          "number of simulations at the same time; default: number of processors");
  command_line.add_option("--seed", options.seed, "seed of all searches");
  command_line.add_option("--out", options.out, "folder for stores, tables and figures; default: NAME_experiment");
  command_line.add_option("--scenarios", options.scenarios, "folder of the experiment's files");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return experiment(options); });
}
