#include "tools/proleg/search/optimisation.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "sim/optimize/method/search.hpp"
#include "sim/scenario/overrides.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"

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
    optimize::set_trials(experiment, *count);
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

void require_map_store(const std::string& option, const std::filesystem::path& folder) {
  if (folder.empty()) {
    throw InputError(option, 0, "an empty name", "the name of a folder");
  }
  std::error_code error;
  if (!std::filesystem::exists(store_path(folder), error)) {
    throw InputError(option, 0, "no " + store_path(folder).string(), "the folder of a search that has made a map");
  }
}

std::unique_ptr<optimize::Store> open_store(const std::filesystem::path& folder, const optimize::Experiment& experiment,
                                            optimize::Store::Opening opening) {
  if (opening == optimize::Store::Opening::fresh) {
    create_result_folder(folder);
  }
  try {
    // What a robot has measured holds for every build of this program.
    return std::make_unique<optimize::Store>(store_path(folder), experiment,
                                             experiment.on_robot ? optimize::robot_name : result_key, opening);
  } catch (const optimize::StoreError& refused) {
    throw BadInput(refused.what());
  }
}

std::string ending_text(const SearchOutcome& outcome) {
  if (!outcome.failure.empty()) {
    return "failed";
  }
  return outcome.ending.empty() ? "interrupted" : outcome.ending;
}

SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run, optimize::Workers& workers,
                         optimize::Store& store, const std::string& label) {
  SearchDisplay display(label, std::string(experiment.objectives.front().unit()),
                        optimize::planned_evaluations(experiment));
  const auto print_messages = [&] {
    for (const std::string& message : workers.messages()) {
      display.print("warning: " + message);
    }
  };
  std::optional<optimize::GaitMap> map;
  if (!experiment.axes.empty()) {
    map.emplace(experiment);
  }
  const auto observe = [&](const optimize::Evaluation& evaluation, const optimize::SearchProgress& progress) {
    if (map) {
      map->add(evaluation.number, evaluation.scores);
    }
    display.show(progress, map ? &*map : nullptr);
    print_messages();
  };
  const auto stop = [&] {
    print_messages();  // also while no evaluation ends
    return interrupted();
  };
  try {
    SearchOutcome outcome = run_search(experiment, run, workers, store, SearchWatch{observe, stop});
    print_messages();
    return outcome;
  } catch (const std::runtime_error&) {
    print_messages();  // the messages explain the error
    throw;
  }
}

SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run, optimize::Workers& workers,
                         optimize::Store& store, const SearchWatch& watch) {
  SearchOutcome outcome;
  const auto observe = [&](const optimize::Evaluation& evaluation, const optimize::SearchProgress& progress) {
    outcome.evaluations.push_back(evaluation);
    watch.observe(evaluation, progress);
  };
  const auto stop = [&] { return watch.stop() || store.is_stop_requested(); };
  optimize::Evaluator evaluator(experiment, run, workers, &store, observe, stop);
  store.start_run(run);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = own_cpu_s();
  try {
    outcome.ending = optimize::search(experiment, run, evaluator);
  } catch (const optimize::SearchFailed& error) {
    outcome.failure = error.reason();
  } catch (const optimize::SearchEnded&) {
    if (evaluator.budget_spent()) {
      outcome.ending = budget_ending(experiment.evaluations);
    }
  }
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.own_cpu_s = own_cpu_s() - cpu_start;
  outcome.progress = evaluator.progress();
  if (!outcome.ending.empty() && !(outcome.progress.best && optimize::needs_confirmation(experiment))) {
    store.finish_run(run, outcome.ending);
  }
  return outcome;
}

std::string keep_stored_evaluations(optimize::Store& store, optimize::Experiment& experiment,
                                    std::optional<std::uint32_t> trials) {
  std::string remark;
  const std::uint64_t stored = store.evaluation_count(0);
  if (experiment.evaluations > 0 && experiment.evaluations < stored) {
    remark = "the store has " + std::to_string(stored) + " evaluations, more than " +
             std::to_string(experiment.evaluations) + "; all of them are kept";
    experiment.evaluations = stored;
  }
  store.save_search(experiment.evaluations, build_id, trials);
  return remark;
}

bool has_ended(optimize::Store& store, const optimize::Experiment& experiment, std::uint32_t run) {
  const std::optional<std::string> ending = store.ending(run);
  const std::uint64_t made = store.evaluation_count(run);
  const bool may_go_on = experiment.evaluations == 0 || made < experiment.evaluations;
  return ending && !(may_go_on && *ending == budget_ending(made));
}

std::vector<optimize::Confirmation> confirm_best(const optimize::Experiment& experiment, optimize::Workers& workers,
                                                 optimize::Store& store, SearchOutcome& outcome,
                                                 std::span<const optimize::Evaluation> others) {
  if (outcome.ending.empty() || !optimize::needs_confirmation(experiment)) {
    return {};
  }
  try {
    std::vector<optimize::Evaluation> finalists = optimize::choose_finalists(experiment, outcome.evaluations);
    for (const optimize::Evaluation& other : others) {
      if (std::ranges::count(finalists, other.candidate, &optimize::Evaluation::candidate) == 0) {
        finalists.push_back(other);
      }
    }
    CountProgress progress(
        "fresh runs of the best candidates" +
            (optimize::is_judged(experiment) ? " in " + std::string(sim::name_of(optimize::judging_engine)) : ""),
        finalists.size() * optimize::fresh_runs(experiment).runs);
    const auto start = std::chrono::steady_clock::now();
    std::vector<optimize::Confirmation> confirmations =
        optimize::confirm(experiment, finalists, workers, &store, [&](std::size_t done, std::size_t /*all*/) {
          progress.show(done);
          return interrupted() || store.is_stop_requested();
        });
    outcome.confirmation_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    store.finish_run(finalists.front().run, outcome.ending);
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

SearchDisplay::SearchDisplay(std::string label, std::string unit, std::uint64_t budget)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      budget_(budget),
      terminal_line_(std::chrono::milliseconds(0)),
      log_interval_(std::chrono::steady_clock::now(), std::chrono::seconds(10)) {}

void SearchDisplay::show(const optimize::SearchProgress& progress, const optimize::GaitMap* map) {
  if (!terminal_line_.is_visible()) {
    if (log_interval_.is_due(std::chrono::steady_clock::now())) {
      print(progress_text(label_, unit_, budget_, progress, terminal_line_.elapsed_s(), map));
    }
    return;
  }
  if (progress.best) {
    best_so_far_.push_back(progress.best->scores.front());
  }
  if (!terminal_line_.is_due()) {
    return;
  }
  const std::string line = progress_text(label_, unit_, budget_, progress, terminal_line_.elapsed_s(), map);
  const std::size_t width = TerminalLine::max_width();
  const std::size_t rest = width > line.size() + 2 ? width - line.size() - 2 : 0;
  terminal_line_.draw(line.substr(0, width) + (rest > 0 ? "  " : "") +
                      spark_line(best_so_far_, std::min<std::size_t>(rest, 16)));
}

void SearchDisplay::print(const std::string& line) {
  terminal_line_.erase();
  std::cerr << line << '\n';
}

std::string progress_text(const std::string& label, const std::string& unit, std::uint64_t budget,
                          const optimize::SearchProgress& progress, double elapsed_s, const optimize::GaitMap* map) {
  const auto done = static_cast<double>(progress.evaluations);
  std::string line = label + ": " + std::to_string(progress.evaluations);
  if (budget > 0) {
    line += " of " + std::to_string(budget);
  }
  std::array<char, 160> figures{};
  if (progress.best) {
    std::snprintf(figures.data(), figures.size(), ", best %.4g%s%s, mean %.4g", progress.best->scores.front(),
                  unit.empty() ? "" : " ", unit.c_str(), progress.score_sum / done);
    line += figures.data();
  } else {
    line += ", all failed";
  }
  if (map != nullptr) {
    std::snprintf(figures.data(), figures.size(), ", %.1f %% filled, QD score %.4g", 100.0 * map->coverage(),
                  map->qd_score());
    line += figures.data();
  }
  std::snprintf(figures.data(), figures.size(), ", %.0f x real time", progress.simulated_s / elapsed_s);
  line += figures.data();
  // Restored evaluations took no time, so they are no measure of the remaining time.
  const auto made_now = done - static_cast<double>(progress.restored);
  if (budget > progress.evaluations && made_now > 0.0) {
    line += ", " + duration_text(static_cast<double>(budget - progress.evaluations) * elapsed_s / made_now) + " left";
  }
  return line;
}

std::string spark_line(const std::vector<double>& values, std::size_t width) {
  constexpr std::array blocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  if (values.empty() || width == 0) {
    return "";
  }
  const auto [low, high] = std::ranges::minmax_element(values);
  const std::size_t columns = std::min(width, values.size());
  std::string line;
  for (std::size_t column = 0; column < columns; ++column) {
    // The column shows its last value.
    const double value = values[(column + 1) * values.size() / columns - 1];
    const double share = *high > *low ? (value - *low) / (*high - *low) : 0.0;
    line += blocks[static_cast<std::size_t>(std::lround(share * (blocks.size() - 1)))];
  }
  return line;
}

}  // namespace proleg::tools
