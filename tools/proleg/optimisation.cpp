#include "tools/proleg/optimisation.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "sim/optimize/method/search.hpp"
#include "sim/record/output.hpp"
#include "sim/scenario/input_error.hpp"
#include "sim/scenario/text.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/scenario_run.hpp"
#include "tools/proleg/search_display.hpp"

namespace proleg::tools {
namespace {

constexpr std::uint32_t most_workers = 1024;

double own_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

std::uint32_t parse_workers(const std::optional<std::string>& word) {
  if (!word) {
    return std::clamp(std::thread::hardware_concurrency(), 1U, most_workers);
  }
  const std::optional<std::uint32_t> count = sim::parse_whole<std::uint32_t>(*word);
  if (!count || *count == 0 || *count > most_workers) {
    throw sim::InputError("--workers", 0, sim::in_quotes(*word), "1 to " + std::to_string(most_workers));
  }
  return *count;
}

std::uint64_t parse_evaluations(const std::string& word) {
  const std::optional<std::uint64_t> count = sim::parse_whole<std::uint64_t>(word);
  if (!count || *count == 0 || *count > 1'000'000'000) {
    throw sim::InputError("--evaluations", 0, sim::in_quotes(word), "a whole number from 1 to 1000000000");
  }
  return *count;
}

std::uint64_t parse_seed(const std::string& word) {
  const std::optional<std::uint64_t> seed = sim::parse_whole<std::uint64_t>(word);
  if (!seed) {
    throw sim::InputError("--seed", 0, sim::in_quotes(word), "a whole number from 0 to 18446744073709551615");
  }
  return *seed;
}

std::filesystem::path store_path(const std::filesystem::path& folder) { return folder / "store.sqlite"; }

std::unique_ptr<optimize::Store> open_store(const std::filesystem::path& folder, const optimize::Experiment& experiment,
                                            optimize::Store::Opening opening) {
  std::error_code error;
  if (opening == optimize::Store::Opening::fresh) {
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw BadInput("cannot make the folder " + folder.string() + ": " + error.message());
    }
  }
  try {
    return std::make_unique<optimize::Store>(store_path(folder), experiment, build_id, opening);
  } catch (const optimize::StoreError& refused) {
    throw BadInput(refused.what());
  }
}

SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run, optimize::Workers& workers,
                         optimize::Store& store, const std::string& label) {
  SearchOutcome outcome;
  SearchDisplay display(label, score_unit(experiment), experiment.evaluations);
  const auto say_messages = [&] {
    for (const std::string& message : workers.messages()) {
      display.say(message);
    }
  };
  const auto observe = [&](const optimize::Evaluation& evaluation, const optimize::Progress& progress) {
    outcome.evaluations.push_back(evaluation);
    display.show(progress);
    say_messages();
  };
  optimize::Evaluator evaluator(experiment, run, workers, &store, observe, interrupted);
  store.start_run(run);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = own_cpu_s();
  try {
    outcome.ending = optimize::search(experiment, run, evaluator);
  } catch (const std::runtime_error&) {
    say_messages();  // what led to it
    throw;
  } catch (const optimize::SearchEnded&) {
    if (evaluator.budget_spent()) {
      outcome.ending = "all " + std::to_string(experiment.evaluations) + " evaluations made";
    }
  }
  say_messages();
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.own_cpu_s = own_cpu_s() - cpu_start;
  outcome.progress = evaluator.progress();
  if (!outcome.ending.empty()) {
    store.finish_run(run, outcome.ending);
  }
  return outcome;
}

double overhead(const SearchOutcome& outcome) {
  const double all = outcome.own_cpu_s + outcome.progress.workers_s;
  return all > 0.0 ? outcome.own_cpu_s / all : 0.0;
}

std::string score_unit(const optimize::Experiment& experiment) {
  const optimize::Objective& objective = experiment.objectives.front();
  return objective.terms.size() == 1 && objective.terms.front().weight == 1.0
             ? std::string(sim::declaration_of(objective.terms.front().measure).unit)
             : "";
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  sim::Output output(path);
  output.write(text);
  output.finish();
}

}  // namespace proleg::tools
