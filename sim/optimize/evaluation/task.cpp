#include "sim/optimize/evaluation/task.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/loop/simulation.hpp"

namespace proleg::optimize {
namespace {

/// As if the option --engine had chosen it.
void set_engine(sim::Scenario& scenario, sim::PhysicsEngine engine) {
  scenario.overrides.engine = engine;
  scenario.environment.engine = engine;
}

sim::Scenario scenario_of(const Experiment& experiment, const Task& task) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(task.candidate, scenario);
  const Spread& spread = experiment.trials.spread;
  if (depends_on_seed(experiment.scenario, experiment.space, spread)) {
    perturb(scenario, spread, seed_of(experiment, task));
  }
  if (is_fresh_run(experiment, task)) {
    set_engine(scenario, judging_engine);
  }
  return scenario;
}

/// The tick after which racing checks the run; none if it does not.
std::optional<std::uint32_t> racing_tick(const Experiment& experiment, std::optional<double> hopeless_below,
                                         std::uint32_t ticks) {
  if (!experiment.racing.on() || !hopeless_below || ticks < 2) {
    return std::nullopt;
  }
  return std::clamp(static_cast<std::uint32_t>(std::lround(experiment.racing.after * ticks)), 1U, ticks - 1);
}

/// Measures at the end of a run that continues as it did: the distance grows with time, the speed stays.
sim::MeasureValues extrapolated(sim::MeasureValues measures, double share) {
  measures[sim::Measure::distance] /= share;
  return measures;
}

/// Makes -0 to 0 and every NaN the same: stores and messages keep these values unchanged.
void normalise(sim::MeasureValues& measures) {
  for (double& value : measures.all()) {
    value = std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value + 0.0;
  }
}

/// Racing: gives the run up if its extrapolated score is too low. The result then has the extrapolated measures.
void race(const Experiment& experiment, double hopeless_below, const sim::Simulation& simulation, double share,
          TrialResult& result) {
  const sim::MeasureValues measures = extrapolated(simulation.measures(experiment.heading_deg), share);
  if (experiment.objectives.front().score(measures) < hopeless_below) {
    result.given_up = true;
    result.measures = measures;
  }
}

/// hopeless_below: of each scenario, for racing; nothing: the run goes to its end.
std::vector<TrialResult> simulate(const Experiment& experiment, std::span<const sim::Scenario> scenarios,
                                  std::span<const std::optional<double>> hopeless_below) {
  const std::uint32_t ticks = sim::tick_count(experiment.scenario);
  RunWatch watch;
  watch.after_tick = [&](std::size_t i, const sim::Simulation& simulation, TrialResult& result) {
    if (const auto check_tick = racing_tick(experiment, hopeless_below[i], ticks); simulation.tick() == check_tick) {
      race(experiment, *hopeless_below[i], simulation, static_cast<double>(*check_tick) / ticks, result);
    }
  };
  watch.at_end = [&](std::size_t /*i*/, const sim::Simulation& simulation, TrialResult& result) {
    result.measures = simulation.measures(experiment.heading_deg);
  };
  std::vector<TrialResult> results = run_scenarios(scenarios, watch);
  for (TrialResult& result : results) {
    normalise(result.measures);
  }
  return results;
}

}  // namespace

bool is_judged(const Experiment& experiment) { return experiment.scenario.environment.engine != judging_engine; }

bool is_fresh_run(const Experiment& experiment, const Task& task) { return task.trial >= experiment.trials.count; }

std::uint64_t seed_of(const Experiment& experiment, const Task& task) {
  const bool is_common = experiment.trials.random_numbers == RandomNumbers::common || is_fresh_run(experiment, task);
  return trial_seed(experiment.seed, task.run, is_common ? 0 : task.number, task.trial);
}

bool differs_between_evaluations(const Experiment& experiment) {
  return experiment.trials.random_numbers == RandomNumbers::fresh &&
         depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread);
}

std::vector<TrialResult> run_trials(const Experiment& experiment, std::span<const Task> tasks) {
  std::vector<sim::Scenario> scenarios;
  std::vector<std::optional<double>> hopeless_below;
  for (const Task& task : tasks) {
    scenarios.push_back(scenario_of(experiment, task));
    hopeless_below.push_back(task.hopeless_below);
  }
  return simulate(experiment, scenarios, hopeless_below);
}

TrialResult run_trial(const Experiment& experiment, const Task& task) {
  return std::move(run_trials(experiment, {&task, 1}).front());
}

void require_engine(const Experiment& experiment) {
  Task task;
  task.candidate = experiment.space.nearest(experiment.scenario);
  const sim::Scenario scenario = scenario_of(experiment, task);
  static_cast<void>(sim::Simulation(scenario));
}

sim::Scenario own_world(const Experiment& experiment, const Evaluation& evaluation) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(evaluation.candidate, scenario);
  if (depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread)) {
    scenario.kernel.seed = seed_of(experiment, {evaluation.run, evaluation.number, 0, evaluation.candidate, {}});
  }
  if (is_judged(experiment)) {
    set_engine(scenario, judging_engine);
  }
  return scenario;
}

TrialResult run_own_world(const Experiment& experiment, const Evaluation& evaluation) {
  const sim::Scenario scenario = own_world(experiment, evaluation);
  const std::optional<double> no_limit;
  return std::move(simulate(experiment, {&scenario, 1}, {&no_limit, 1}).front());
}

}  // namespace proleg::optimize
