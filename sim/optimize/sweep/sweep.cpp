#include "sim/optimize/sweep/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/scenario_runs.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::optimize {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// The combination with the first seed instead of its own.
Candidate without_seed(const Sweep& sweep, Candidate combination) {
  for (std::size_t i = 0; i < combination.size(); ++i) {
    if (sweep.quantities[i].kind == SweptQuantity::Kind::seed) {
      combination[i] = 0;
    }
  }
  return combination;
}

}  // namespace

std::vector<TrialResult> run_combinations(const Sweep& sweep, std::span<const Task> tasks) {
  std::vector<sim::Scenario> scenarios;
  for (const Task& task : tasks) {
    scenarios.push_back(sweep.scenario_of(task.candidate));
  }
  RunWatch watch;
  watch.at_end = [](std::size_t /*i*/, const sim::Simulation& simulation, TrialResult& result) {
    result.measures = simulation.measures();
    result.limited_joints = static_cast<std::uint32_t>(
        std::ranges::count_if(simulation.plant().meter().tracking(), &sim::ServoTracking::cannot_follow));
  };
  return run_scenarios(scenarios, watch);
}

std::vector<SweepRun> run_sweep(const Sweep& sweep, Workers& workers, std::vector<SweepRun> runs,
                                const std::function<bool()>& stop,
                                const std::function<void(std::span<const SweepRun>)>& observe) {
  constexpr std::chrono::milliseconds patience{500};
  const std::uint64_t size = sweep.size();
  std::vector<bool> is_done(size);
  for (const SweepRun& run : runs) {
    is_done[run.number] = true;
  }
  std::uint64_t left = size - runs.size();  // not yet started
  std::uint64_t next = 0;
  while (runs.size() < size && !stop()) {
    const std::size_t share = share_of_worker(sweep.scenario, left, workers);
    while (left > 0 && workers.idle() > 0) {
      std::vector<TicketedTask> batch;
      for (; batch.size() < share && left > 0; ++next) {
        if (!is_done[next]) {
          batch.push_back({next, {0, next, 0, sweep.combination(next), {}}});
          --left;
        }
      }
      workers.start(batch);
    }
    if (std::optional<Workers::Done> done = workers.wait(patience)) {
      runs.push_back({done->ticket, std::move(done->result)});
    }
    observe(runs);
  }
  std::ranges::sort(runs, {}, &SweepRun::number);
  return runs;
}

double SweepGroup::mean() const {
  return values.empty() ? undefined
                        : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double SweepGroup::deviation() const {
  if (values.size() < 2) {
    return undefined;
  }
  const double center = mean();
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - center) * (value - center);
  }
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

std::vector<SweepGroup> group_runs(const Sweep& sweep, std::span<const SweepRun> runs, sim::Measure measure) {
  std::vector<std::pair<Candidate, double>> values;
  for (const SweepRun& run : runs) {
    values.emplace_back(without_seed(sweep, sweep.combination(run.number)), run.result.measures[measure]);
  }
  std::ranges::stable_sort(values, {}, &std::pair<Candidate, double>::first);
  std::vector<SweepGroup> groups;
  for (auto& [combination, value] : values) {
    if (groups.empty() || groups.back().combination != combination) {
      groups.push_back({std::move(combination), {}});
    }
    if (std::isfinite(value)) {
      groups.back().values.push_back(value);
    }
  }
  return groups;
}

std::vector<std::size_t> varied_quantities(const Sweep& sweep) {
  std::vector<std::size_t> varied;
  for (std::size_t i = 0; i < sweep.quantities.size(); ++i) {
    if (sweep.quantities[i].kind != SweptQuantity::Kind::seed && sweep.quantities[i].values.size() > 1) {
      varied.push_back(i);
    }
  }
  return varied;
}

std::string fixed_options(const Sweep& sweep) {
  std::string text;
  for (const std::string& setting : sweep.settings) {
    text += "--set " + setting + " ";
  }
  text += "--seconds " + exact_text(sweep.scenario.duration_s);
  const sim::OverrideWords words = sim::words_of(sweep.scenario.overrides);
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& argument = words.*declaration.word) {
      text += " --" + std::string(declaration.name) + " " + *argument;
    }
  }
  return text;
}

std::string command_of(const Sweep& sweep) {
  std::string text = "proleg sweep " + sweep.scenario.path;
  for (const SweptQuantity& quantity : sweep.quantities) {
    text += " --over " + quantity.argument;
  }
  return text + " " + fixed_options(sweep);
}

}  // namespace proleg::optimize
