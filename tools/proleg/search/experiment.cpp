// proleg experiment: repeats an experiment of the thesis and writes its tables and figures beside the published ones.

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/environment/environment_model.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/thesis_experiment.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/search/experiment_methods.hpp"
#include "tools/proleg/search/gait_checks.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
/// The curves of each method.
using Curves = std::map<std::string, optimize::BestCurves>;

/// The means of the best so far after 100, 200, 400, ... evaluations.
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

Json methods_json(const std::vector<ChosenMethod>& chosen, const std::vector<MethodResult>& results,
                  const Curves& curves, double reference_m) {
  const auto deluge = curves.find("great-deluge");
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const optimize::BestCurves& own = curves.at(results[i].runs.method);
    Json entry = to_json(results[i], chosen[i].experiment.space, reference_m);
    entry.add("mean_best_after", course(own));
    if (deluge != curves.end()) {
      entry.add("reaches_mean_of_great_deluge_after", optimize::evaluations_to_reach(own, deluge->second.mean.back()));
    }
    list.append(entry);
  }
  return list;
}

Json differences_json(const std::vector<optimize::MethodRuns>& runs) {
  Json list = Json::empty_array();
  for (const optimize::MethodDifference& difference : optimize::method_differences(runs)) {
    list.append({{"one", difference.one},
                 {"other", difference.other},
                 {"share_above", difference.share_above},
                 {"p_value", difference.p_value}});
  }
  return list;
}

/// results: one for each chosen method. checks may be empty.
Json experiment_json(const std::vector<ChosenMethod>& chosen, const std::vector<MethodResult>& results,
                     const std::vector<optimize::Reference>& references, const std::vector<CheckedGait>& checks) {
  Curves curves;
  std::vector<optimize::MethodRuns> runs;
  for (const MethodResult& result : results) {
    curves[result.runs.method] = optimize::best_curves(result.runs);
    runs.push_back(result.runs);
  }
  Json distances = Json::empty_object();
  for (const optimize::Reference& reference : references) {
    distances.add(std::string(reference.scenario->short_name), reference.judged_m);
  }
  Json object{{"engine", sim::name_of(chosen.front().experiment.scenario.environment.engine)},
              {"references", distances},
              {"methods", methods_json(chosen, results, curves, references.front().judged_m)},
              {"differences", differences_json(runs)}};
  if (!checks.empty()) {
    object.add("gaits", gait_checks_json(checks));
  }
  const auto deluge = curves.find("great-deluge");
  const auto genetic = curves.find("genetic");
  if (deluge != curves.end() && genetic != curves.end()) {
    object.add("great_deluge_above_genetic_after", optimize::overtaking(deluge->second, genetic->second));
  }
  return object;
}

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

int say_interrupted(const fs::path& folder) {
  std::cerr << "proleg experiment: interrupted; the same command continues in " << folder.string() << '\n';
  return exit_failed;
}

std::uint32_t parse_repetitions(const std::string& argument) {
  const std::optional<std::uint32_t> repetitions = parse_whole<std::uint32_t>(argument);
  if (!repetitions || *repetitions == 0 || *repetitions > max_repetitions) {
    throw InputError("--repetitions", 0, in_quotes(argument), "1 to " + std::to_string(max_repetitions));
  }
  return *repetitions;
}

std::string conditions_text(const optimize::Experiment& experiment, double wall_s, std::uint32_t workers) {
  std::string text = "\nengine: " + std::string(sim::name_of(experiment.scenario.environment.engine));
  if (optimize::is_judged(experiment)) {
    text += "; the best ten of each run were rated again in " + std::string(sim::name_of(optimize::judging_engine));
  }
  std::array<char, 64> time{};
  std::snprintf(time.data(), time.size(), "\ntime: %.1f min with %u workers\n", wall_s / 60.0, workers);
  return text + time.data();
}

/// Checks the files at the top of the folder. If a method has a store in the folder, they belong to an earlier
/// experiment.
void check_folder(const fs::path& folder, const optimize::ThesisExperiment& thesis,
                  const std::vector<ChosenMethod>& chosen) {
  std::vector<std::string_view> files{thesis.comparison_figure, "summary.txt"};
  if (!thesis.level_ground.empty()) {
    files.insert(files.end(), gait_check_figures.begin(), gait_check_figures.end());
  }
  bool is_continued = false;
  for (const auto& [method, experiment] : chosen) {
    files.insert(files.end(), {method.table, method.runs_figure, method.spread_figure});
    is_continued = is_continued || fs::exists(store_path(folder / method.name));
  }
  if (!is_continued) {
    check_result_folder(folder, files);
  }
}

int experiment(Options options) {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {
    throw BadInput(
        "found mpirun, expected none: an experiment runs on one computer; use 'proleg optimise' on a cluster");
  }
  const optimize::ThesisExperiment& thesis = find_experiment(options.name);
  const std::uint32_t repetitions = parse_repetitions(options.repetitions.value_or(std::string(thesis.repetitions)));
  if (!options.engine && !thesis.engine.empty()) {
    options.engine = thesis.engine;
  }
  const std::uint32_t worker_count = parse_workers(options.workers);
  const fs::path scenarios = find_experiment_files(thesis, options.scenarios);
  const fs::path folder = options.out.value_or(options.name + "_experiment");
  if (folder.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  const std::vector<ChosenMethod> chosen =
      choose_methods(thesis, {options, options.methods, repetitions, scenarios, folder});
  check_folder(folder, thesis, chosen);
  const optimize::Experiment& first = chosen.front().experiment;

  catch_interrupts();
  const ResultFolder claim(folder, {});  // what may be in it is checked above
  const auto started = std::chrono::steady_clock::now();
  const std::vector<optimize::Reference> references = reference_distances(thesis, first, scenarios);
  std::vector<MethodResult> results;
  std::vector<optimize::MethodRuns> all_runs;
  for (const auto& [method, experiment] : chosen) {
    MethodResult result = run_repetitions(method.name, experiment, repetitions, worker_count, folder / method.name);
    if (result.runs.runs.size() < repetitions) {
      return say_interrupted(folder);
    }
    write_file(folder / method.table, optimize::experiment_table(thesis, result.runs));
    write_file(folder / method.runs_figure, optimize::draw_every_run(thesis, result.runs, references));
    write_file(folder / method.spread_figure, optimize::draw_run_spread(thesis, result.runs, references));
    optimize::write_scenario(experiment, *result.best, folder / method.name, "best");
    all_runs.push_back(result.runs);
    results.push_back(std::move(result));
  }
  write_file(folder / thesis.comparison_figure, optimize::draw_method_comparison(thesis, all_runs, references));
  std::vector<CheckedGait> checks;
  if (!thesis.level_ground.empty()) {
    try {
      checks = check_gaits(thesis, chosen, results, scenarios, folder);
    } catch (const CheckInterrupted&) {
      return say_interrupted(folder);
    }
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const std::string summary = optimize::experiment_summary(thesis, all_runs, references) +
                              (checks.empty() ? "" : "\n" + gait_checks_text(checks)) +
                              conditions_text(first, wall_s, worker_count);
  write_file(folder / "summary.txt", summary);

  if (!options.json) {
    std::cout << summary << "\ntables, figures and stores are in " << folder.string() << '\n';
    return exit_success;
  }
  Json object = experiment_json(chosen, results, references, checks);
  object.add("experiment", options.name);
  object.add("wall_s", wall_s);
  object.add("out", folder.string());
  object.add("build_id", build_id);
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
