// proleg optimise: searches for the parameters of a gait. proleg atlas does the same for a map of gaits.

#include "tools/proleg/search/optimise.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <span>
#include <thread>
#include <utility>
#include <variant>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/method/search.hpp"
#include "sim/optimize/report/judged_cells.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/reader.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/run_measures.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/search/map_result.hpp"
#include "tools/proleg/search/search_estimate.hpp"
#include "tools/proleg/search/search_result.hpp"

namespace proleg::tools {
namespace {

using optimize::Experiment;

constexpr const char* result_file = "result.json";
constexpr const char* judged_file = "judged.tsv";

/// What --json prints. result: null if no evaluation has a score.
Json result_object(const Experiment& experiment, const SearchOutcome& outcome, const SearchResult* result,
                   std::span<const optimize::Confirmation> sample, const std::filesystem::path& folder,
                   std::uint32_t workers) {
  const optimize::SearchProgress& progress = outcome.progress;
  Json object{
      {"experiment", experiment.path},
      {"method", optimize::method_name(experiment.method)},
      {"engine", std::string(optimize::trial_maker(experiment))},
      {"judge", optimize::is_judged(experiment) ? Json(std::string(sim::name_of(optimize::judging_engine))) : Json()},
      {"trials", experiment.trials.count},
      {"seed", experiment.seed}};
  if (result != nullptr) {
    add_result(experiment, outcome, *result, object);
  } else {
    object.add("best_score", Json());
    object.add("best_number", Json());
  }
  if (!sample.empty()) {
    object.add("judged_cells", agreement_object(experiment, sample, result->best));
  }
  object.add("evaluations", progress.evaluations);
  object.add("simulated", progress.simulated);
  object.add("reused", progress.reused);
  object.add("restored", progress.restored);
  object.add("failed", progress.failed);
  object.add("simulated_ahead_in_vain", progress.wasted);
  object.add("ended", ending_text(outcome));
  object.add("reason", outcome.failure.empty() ? Json() : Json(outcome.failure));
  object.add("workers", workers);
  object.add("wall_s", outcome.wall_s);
  object.add("simulated_s", progress.simulated_s);
  object.add("simulated_s_per_s", progress.simulated_s / outcome.wall_s);
  object.add("workers_busy", progress.workers_s / (outcome.wall_s * workers));
  object.add("overhead", overhead(outcome));
  object.add("out", folder.string());
  object.add("fingerprint", experiment.fingerprint());
  object.add("build_id", build_id);
  return object;
}

void print_text(const Experiment& experiment, const SearchOutcome& outcome, const SearchResult& result,
                std::span<const optimize::Confirmation> sample, const std::vector<std::filesystem::path>& files,
                std::uint32_t workers) {
  print_result(experiment, outcome, result);
  if (!sample.empty()) {
    print_agreement(experiment, sample, result.best);
  }
  const optimize::SearchProgress& progress = outcome.progress;
  std::printf("%-24s %s\n", "engine", std::string(optimize::trial_maker(experiment)).c_str());
  std::printf("%-24s %.1f s, %.0f x real time; %u workers, %.1f %% busy; optimiser and store %.2f %%\n", "time",
              outcome.wall_s, progress.simulated_s / outcome.wall_s, workers,
              100.0 * progress.workers_s / (outcome.wall_s * workers), 100.0 * overhead(outcome));
  if (outcome.confirmation_wall_s > 0.0) {
    std::printf("%-24s %.1f s, after the search\n", "time of fresh runs", outcome.confirmation_wall_s);
  }
  for (const std::filesystem::path& file : files) {
    std::printf("%-24s %s\n", "written", file.c_str());
  }
}

/// The command that continues this search, with all options that its store depends on.
std::string command_to_continue(const OptimiseOptions& options, const std::filesystem::path& folder) {
  std::string command = options.program + (options.file ? " " + shell_argument(*options.file) : "");
  const auto add = [&](const char* option, const std::optional<std::string>& value) {
    if (value) {
      command += std::string(" ") + option + " " + shell_argument(*value);
    }
  };
  add("--simulation", options.simulation);
  add("--engine", options.engine);
  add("--trials", options.trials);
  add("--evaluations", options.evaluations);
  add("--seed", options.seed);
  add("--judge", options.judge);
  add("--bus", options.robot.bus);
  add("--score", options.robot.score);
  add("--score-command", options.robot.score_command);
  add("--score-timeout", options.robot.score_timeout);
  add("--resume", folder.string());
  return command + algorithm_options();
}

Experiment read_stored(const OptimiseOptions& options) {
  if (!options.resume) {
    throw BadInput("found no FILE, expected an experiment (*.optimise.xml), or --resume FOLDER");
  }
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {  // only the first process may open the store
    throw BadInput("found mpirun without FILE, expected the experiment's file before --resume");
  }
  if (options.simulation) {
    throw BadInput("found --simulation without FILE, expected FILE: the store has a scenario of its own");
  }
  try {
    return optimize::read_experiment_of(store_path(*options.resume));
  } catch (const optimize::StoreError& error) {
    throw BadInput(error.what());
  }
}

/// Throws InputError for options that mean nothing with a robot, and for those of a robot without one.
void refuse_beside_robot(const OptimiseOptions& options) {
  require_bus(options.robot);
  for (const auto& [option, is_given] :
       {std::pair("--workers", options.workers.has_value()), std::pair("--engine", options.engine.has_value()),
        std::pair("--estimate", options.estimate)}) {
    if (options.robot.bus && is_given) {
      throw InputError(option, 0, "an option for simulated trials beside --bus", "one of the two");
    }
  }
}

/// Runs the best scenario once more and warns as `proleg simulate` does: the measures of a search are means over the
/// joints, and do not say whether the limits cut the gait.
void print_warnings_on(const std::string& program, const std::filesystem::path& best) {
  sim::DiskFiles files;
  const sim::Scenario scenario = sim::read_scenario(best, files);
  sim::Simulation simulation(scenario);
  try {
    while (simulation.time_s() < scenario.duration_s - 1e-9 && !interrupted()) {
      simulation.advance();
    }
  } catch (const sim::PhysicsError&) {
    return;
  }
  print_warning_on_servos(program, measures_of(simulation.plant().meter()), scenario.robot);
  print_warning_on_clipping(program, scenario, simulation.chain().clipped_ticks(), simulation.tick());
}

/// Number of cells of the map that the judging engine simulates again. Throws InputError.
std::size_t judged_cells(const OptimiseOptions& options, const Experiment& experiment) {
  if (!options.fills_atlas) {
    return 0;
  }
  const std::optional<std::uint32_t> asked =
      options.judge ? parse_whole<std::uint32_t>(*options.judge) : usual_judged_cells;
  if (!asked || *asked > optimize::max_map_cells) {
    throw InputError("--judge", 0, in_quotes(*options.judge),
                     "a whole number from 0 to " + std::to_string(optimize::max_map_cells));
  }
  if (optimize::is_judged(experiment)) {
    return *asked;
  }
  if (options.judge && *asked > 0) {
    throw InputError("--judge", 0, "a search in " + std::string(sim::name_of(optimize::judging_engine)),
                     "one in another engine");
  }
  return 0;
}

/// Returns the exit status. judged: number of cells (judged_cells()). continuation: the command that continues the
/// search.
int search_and_write(const OptimiseOptions& options, const Experiment& experiment, const std::filesystem::path& folder,
                     optimize::Workers& workers, optimize::Store& store, std::size_t judged,
                     const std::string& continuation) {
  SearchOutcome outcome = run_search(experiment, 0, workers, store, optimize::method_name(experiment.method));
  const bool has_evaluation = outcome.progress.evaluations > 0;
  const bool has_score = outcome.progress.best.has_value();
  if (!has_score && options.json) {
    std::cout << result_object(experiment, outcome, nullptr, {}, folder, workers.count()).text() << '\n';
  }
  if (!has_score && has_evaluation) {
    write_results(experiment, outcome, nullptr, folder);
    std::cerr << options.program << ": none of " << outcome.progress.evaluations
              << " evaluations has a score, so there is no best scenario; the first failure: "
              << outcome.progress.first_failure << '\n';
  }
  if (has_score) {
    const std::vector<optimize::Evaluation> cells =
        judged > 0 ? optimize::choose_cells(experiment, outcome.evaluations, judged)
                   : std::vector<optimize::Evaluation>();
    std::vector<optimize::Confirmation> confirmations = confirm_best(experiment, workers, store, outcome, cells);
    const std::vector<optimize::Confirmation> sample = confirmations_of(cells, confirmations);
    const SearchResult result = result_of(experiment, outcome, std::move(confirmations));
    std::vector<std::filesystem::path> files = write_results(experiment, outcome, &result, folder);
    if (!sample.empty()) {
      files.push_back(folder / judged_file);
      write_file(files.back(), optimize::judged_table(experiment, sample));
    }
    const std::string object =
        result_object(experiment, outcome, &result, sample, folder, workers.count()).text() + '\n';
    files.push_back(folder / result_file);
    write_file(files.back(), object);
    if (options.json) {
      std::cout << object;
    } else {
      print_text(experiment, outcome, result, sample, files, workers.count());
    }
    for (const std::string& remark : optimize::axis_remarks(experiment, outcome.evaluations)) {
      print_warning(options.program, remark);
    }
    if (!experiment.on_robot) {
      print_warnings_on(options.program, folder / "best.simulation.xml");
    }
  }
  if (outcome.ending.empty()) {
    const std::string place = has_evaluation ? "after " + std::to_string(outcome.progress.evaluations) + " evaluations"
                                             : std::string("before the first evaluation");
    std::cerr << options.program << ": "
              << (outcome.failure.empty() ? "interrupted " + place : "ended " + place + ", because " + outcome.failure)
              << "; continue with: " << continuation << '\n';
  }
  return has_score && !outcome.ending.empty() ? exit_success : exit_failed;
}

/// Waits until the search in the folder has stopped.
int stop(const OptimiseOptions& options) {
  const std::filesystem::path store = store_path(*options.stop);
  try {
    optimize::request_stop(store);
  } catch (const optimize::StoreError& error) {
    throw BadInput(error.what());
  }
  catch_interrupts();
  constexpr std::chrono::milliseconds period{50};
  constexpr std::chrono::minutes longest{2};
  const auto end = std::chrono::steady_clock::now() + longest;
  while (optimize::is_being_written(store) && !interrupted()) {
    if (std::chrono::steady_clock::now() >= end) {
      std::cerr << options.program << ": " << store.string() << ": the program that writes to it has not stopped in "
                << longest.count() << " minutes; it may be suspended, or be another program\n";
      return exit_failed;
    }
    std::this_thread::sleep_for(period);
  }
  return interrupted() ? exit_failed : exit_success;
}

int estimate(const OptimiseOptions& options, const WorkersMaker& make_workers) {
  const Experiment experiment = read_experiment(options);
  const std::size_t judged = judged_cells(options, experiment);
  catch_interrupts();
  const std::unique_ptr<optimize::Workers> workers = make_workers(experiment, options);
  const SearchEstimate estimate = estimate_search(experiment, *workers, judged);
  if (interrupted()) {
    return exit_failed;
  }
  if (options.json) {
    const Json object{{"engine", std::string(optimize::trial_maker(experiment))},
                      {"workers", workers->count()},
                      {"evaluation_s", estimate.evaluation_s},
                      {"confirmation_s", estimate.confirmation_s},
                      {"planned", estimate.planned},
                      {"seconds", estimate.seconds()}};
    std::cout << object.text() << '\n';
  } else if (estimate.seconds()) {
    std::printf("%-24s %s\n", "time", duration_text(*estimate.seconds()).c_str());
  } else {
    std::printf("%-24s %.3g s each; the method decides how many\n", "evaluations", estimate.evaluation_s);
  }
  return exit_success;
}

}  // namespace

int optimise(const OptimiseOptions& options, const WorkersMaker& make_workers) {
  if (options.stop) {
    return stop(options);
  }
  if (options.estimate) {
    return estimate(options, make_workers);
  }
  Experiment experiment = read_experiment(options);
  const std::size_t judged = judged_cells(options, experiment);
  const std::filesystem::path folder = search_folder(options, experiment);
  print_warnings(options.program, experiment.scenario);
  refuse_overwriting(experiment, folder);
  if (!options.resume &&
      !std::filesystem::exists(store_path(folder))) {  // otherwise the store has the command to continue
    check_result_folder(folder, search_result_files);
  }
  if (options.verbose) {
    for (const std::string& remark : experiment.scenario.remarks) {
      std::cerr << remark << '\n';
    }
    std::cerr << experiment.space.dimensions.size() << " dimensions, " << experiment.space.size() << " candidates\n";
  }
  catch_interrupts();
  // The workers are made before the store is opened: they are processes that should not inherit it.
  const std::unique_ptr<optimize::Workers> workers = make_workers(experiment, options);
  const std::unique_ptr<optimize::Store> store = open_store(
      folder, experiment, options.resume ? optimize::Store::Opening::resume : optimize::Store::Opening::fresh);
  const std::string continuation = command_to_continue(options, folder);
  try {
    const std::string remark = keep_stored_evaluations(
        *store, experiment, options.trials ? std::optional(experiment.trials.count) : std::nullopt);
    if (!remark.empty()) {
      print_warning(options.program, remark);
    }
    std::error_code ignored;
    for (const char* file : {result_file, judged_file}) {
      std::filesystem::remove(folder / file, ignored);  // it is of the time before
    }
    return search_and_write(options, experiment, folder, *workers, *store, judged, continuation);
  } catch (const optimize::StoreError& error) {
    throw std::runtime_error(std::string(error.what()) + "; continue with: " + continuation);
  }
}

std::filesystem::path search_folder(const OptimiseOptions& options, const Experiment& experiment) {
  return chosen_folder(options.out, options.resume, experiment.title(), "search");
}

void require_map(const optimize::Experiment& experiment) {
  if (!std::holds_alternative<optimize::MapElitesSettings>(experiment.method)) {
    throw InputError(experiment.path, experiment.method_line, "the method " + optimize::method_name(experiment.method),
                     "<mapElites>, which fills a map");
  }
}

optimize::Experiment read_experiment(const OptimiseOptions& options) {
  refuse_beside_robot(options);
  if (options.file) {
    refuse_folder(*options.file, ".optimise.xml");
  }
  if (options.simulation) {
    refuse_folder(*options.simulation, ".simulation.xml");
  }
  sim::DiskFiles files;
  optimize::Experiment experiment =
      options.file ? optimize::read_experiment(*options.file, files, options.simulation) : read_stored(options);
  if (!options.file && experiment.on_robot != options.robot.bus.has_value()) {
    throw BadInput(store_path(*options.resume).string() + (experiment.on_robot
                                                               ? ": found the trials of a robot, expected --bus BUS"
                                                               : ": found simulated trials, expected no --bus"));
  }
  if (options.robot.bus) {
    optimize::put_on_robot(experiment, simulated_robot(options.robot));
  }
  ExperimentOptions changes = options;
  if (options.fills_atlas) {
    require_map(experiment);
    if (options.file && !changes.engine) {
      changes.engine = sim::name_of(sim::PhysicsEngine::reduced);
    }
  }
  apply_options(changes, experiment);
  return experiment;
}

int optimise_command(int argc, char** argv, const WorkersMaker& make_workers) {
  CommandLine command_line(
      "proleg optimise",
      "Searches for the parameters of a gait: simulates candidates, or lets a robot try them (--bus), stores all "
      "results, and writes the best scenario.");
  OptimiseOptions options;
  add_optimise_options(command_line, options);
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return optimise(options, make_workers); });
}

void add_optimise_options(CommandLine& command_line, OptimiseOptions& options) {
  command_line.add_option("FILE", options.file, "experiment: a *.optimise.xml file; may be omitted with --resume");
  command_line.add_option("--simulation", options.simulation, "scenario to optimise; default: the one that FILE names");
  add_engine_option(command_line, options);
  command_line.add_option(
      "--trials", options.trials,
      "number of worlds in which each candidate is simulated; they differ as <trials> of FILE says, "
      "or else in friction, mass, servo gain and latency. Of a robot: number of its trials of each candidate");
  if (!options.fills_atlas) {
    add_trial_options(command_line, options.robot);
  }
  command_line.add_option("--evaluations", options.evaluations, "maximum number of evaluations; default: that of FILE");
  command_line.add_option("--workers", options.workers,
                          "number of simulations at the same time; default: number of processors");
  command_line.add_option("--seed", options.seed, "seed of all random numbers of the search; default: that of FILE");
  command_line.add_option("--out", options.out,
                          "folder for store, tables and figures; default: the name of FILE up to its first dot");
  command_line.add_option("--resume", options.resume, "continue the search whose store is in this folder");
  command_line
      .add_option("--stop", options.stop,
                  "stop the search whose store is in this folder, as Ctrl-C does, wherever it runs; then end")
      .value_name("FOLDER");
  command_line.add_flag("--estimate", options.estimate,
                        "simulate for some seconds, print how long the search will take, and write nothing");
  command_line.add_flag("--verbose", options.verbose, "print remarks on the files and the size of the search space");
  command_line.add_flag("--json", options.json, "print one JSON object");
}

}  // namespace proleg::tools
