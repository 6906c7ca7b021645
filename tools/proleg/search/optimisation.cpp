#include "tools/proleg/search/optimisation.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/method/search.hpp"
#include "sim/scenario/overrides.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal_line.hpp"
#include "tools/proleg/search/search_display.hpp"

namespace proleg::tools {
namespace {

double own_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The ending of a search that has used up its evaluations.
std::string budget_ending(std::uint64_t evaluations) {
  return "all " + std::to_string(evaluations) + " evaluations made";
}

}  // namespace

void add_engine_option(CommandLine& command_line, ExperimentOptions& options) {
  const auto declarations = sim::override_declarations();
  const auto engine = std::ranges::find(declarations, &sim::OverrideWords::engine, &sim::OverrideDeclaration::word);
  command_line.add_option("--engine", options.engine, std::string(engine->help));
}

void apply_options(const ExperimentOptions& options, optimize::Experiment& experiment) {
  if (options.engine) {
    sim::OverrideWords words;
    words.engine = options.engine;
    experiment.scenario.overrides = sim::read_overrides(words);
    sim::apply_overrides(experiment.scenario.overrides, experiment.scenario.environment);
  }
  if (options.trials) {
    const std::optional<std::uint32_t> count = parse_whole<std::uint32_t>(*options.trials);
    if (!count || *count == 0 || *count > optimize::max_trials) {
      throw InputError("--trials", 0, in_quotes(*options.trials),
                       "a whole number from 1 to " + std::to_string(optimize::max_trials));
    }
    optimize::Trials& trials = experiment.trials;
    trials.count = *count;
    if (*count > 1 && !optimize::depends_on_seed(experiment.scenario, experiment.space, trials.spread)) {
      trials.spread = optimize::usual_spread();
    }
  }
  if (options.evaluations) {
    const std::optional<std::uint64_t> count = parse_whole<std::uint64_t>(*options.evaluations);
    if (!count || *count == 0 || *count > 1'000'000'000) {
      throw InputError("--evaluations", 0, in_quotes(*options.evaluations), "a whole number from 1 to 1000000000");
    }
    experiment.evaluations = *count;
  }
  if (options.seed) {
    const std::optional<std::uint64_t> seed = parse_whole<std::uint64_t>(*options.seed);
    if (!seed) {
      throw InputError("--seed", 0, in_quotes(*options.seed), "a whole number from 0 to 18446744073709551615");
    }
    experiment.seed = *seed;
  }
  optimize::check_method(experiment);
  optimize::require_engine(experiment);
}

std::filesystem::path store_path(const std::filesystem::path& folder) { return folder / "store.sqlite"; }

std::unique_ptr<optimize::Store> open_store(const std::filesystem::path& folder, const optimize::Experiment& experiment,
                                            optimize::Store::Opening opening) {
  if (opening == optimize::Store::Opening::fresh) {
    create_result_folder(folder);
  }
  try {
    return std::make_unique<optimize::Store>(store_path(folder), experiment, result_key, opening);
  } catch (const optimize::StoreError& refused) {
    throw BadInput(refused.what());
  }
}

SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run, optimize::Workers& workers,
                         optimize::Store& store, const std::string& label) {
  SearchOutcome outcome;
  SearchDisplay display(label, std::string(experiment.objectives.front().unit()),
                        optimize::planned_evaluations(experiment));
  const auto print_messages = [&] {
    for (const std::string& message : workers.messages()) {
      display.print("warning: " + message);
    }
  };
  const auto observe = [&](const optimize::Evaluation& evaluation, const optimize::SearchProgress& progress) {
    outcome.evaluations.push_back(evaluation);
    display.show(progress);
    print_messages();
  };
  optimize::Evaluator evaluator(experiment, run, workers, &store, observe, interrupted);
  store.start_run(run);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = own_cpu_s();
  try {
    outcome.ending = optimize::search(experiment, run, evaluator);
  } catch (const std::runtime_error&) {
    print_messages();  // the messages explain the error
    throw;
  } catch (const optimize::SearchEnded&) {
    if (evaluator.budget_spent()) {
      outcome.ending = budget_ending(experiment.evaluations);
    }
  }
  print_messages();
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.own_cpu_s = own_cpu_s() - cpu_start;
  outcome.progress = evaluator.progress();
  if (!outcome.ending.empty()) {
    store.finish_run(run, outcome.ending);
  }
  return outcome;
}

bool has_ended(optimize::Store& store, const optimize::Experiment& experiment, std::uint32_t run) {
  const std::optional<std::string> ending = store.ending(run);
  const std::uint64_t made = store.evaluation_count(run);
  const bool may_go_on = experiment.evaluations == 0 || made < experiment.evaluations;
  return ending && !(may_go_on && *ending == budget_ending(made));
}

std::vector<optimize::Confirmation> confirm_best(const optimize::Experiment& experiment, optimize::Workers& workers,
                                                 optimize::Store& store, SearchOutcome& outcome) {
  if (outcome.ending.empty() || !optimize::needs_confirmation(experiment)) {
    return {};
  }
  try {
    const std::vector<optimize::Evaluation> finalists = optimize::choose_finalists(experiment, outcome.evaluations);
    CountProgress progress(
        "fresh runs of the best candidates" +
            (optimize::is_judged(experiment) ? " in " + std::string(sim::name_of(optimize::judging_engine)) : ""),
        finalists.size() * optimize::fresh_runs(experiment).runs);
    const auto start = std::chrono::steady_clock::now();
    std::vector<optimize::Confirmation> confirmations =
        optimize::confirm(experiment, finalists, workers, &store, [&](std::size_t done, std::size_t /*all*/) {
          progress.show(done);
          return interrupted();
        });
    outcome.confirmation_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return confirmations;
  } catch (const optimize::SearchEnded&) {
    outcome.ending.clear();
    return {};
  }
}

double overhead(const SearchOutcome& outcome) {
  const double all = outcome.own_cpu_s + outcome.progress.workers_s;
  return all > 0.0 ? outcome.own_cpu_s / all : 0.0;
}

Json values_object(const optimize::SearchSpace& space, const optimize::Candidate& candidate) {
  Json values = Json::empty_object();
  for (std::size_t i = 0; i < space.dimensions.size(); ++i) {
    values.add(space.dimensions[i].name, space.value(candidate, i));
  }
  return values;
}

}  // namespace proleg::tools
