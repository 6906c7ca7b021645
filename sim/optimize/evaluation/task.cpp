#include "sim/optimize/evaluation/task.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::optimize {
namespace {

/// Chooses the engine of a scenario, as the option --engine does.
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

double score_of(const Objective& objective, Aggregate aggregate, std::span<const TrialResult> trials) {
  double result = objective.score(trials.front().measures);
  for (const TrialResult& trial : trials.subspan(1)) {
    const double score = objective.score(trial.measures);
    if (aggregate == Aggregate::mean) {
      result += score;
    } else if (objective.better(result, score)) {
      result = score;
    }
  }
  if (aggregate == Aggregate::mean) {
    result /= static_cast<double>(trials.size());
  }
  return result + 0.0;  // turns -0 into 0: stores do not keep the sign
}

sim::MeasureValues mean_measures(std::span<const TrialResult> trials) {
  sim::MeasureValues mean;
  double count = 0.0;
  for (const TrialResult& trial : trials) {
    if (trial.failure.empty()) {
      for (std::size_t i = 0; i < sim::measure_count; ++i) {
        mean.all()[i] = count == 0.0 ? trial.measures.all()[i] : mean.all()[i] + trial.measures.all()[i];
      }
      count += 1.0;
    }
  }
  for (double& value : mean.all()) {
    value /= std::max(count, 1.0);
  }
  return mean;
}

}  // namespace

bool is_judged(const Experiment& experiment) {
  return !experiment.on_robot && experiment.scenario.environment.engine != judging_engine;
}

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
  if (experiment.on_robot) {
    return;
  }
  Task task;
  task.candidate = experiment.space.nearest(experiment.scenario);
  const sim::Scenario scenario = scenario_of(experiment, task);
  static_cast<void>(sim::Simulation(scenario));
}

sim::Scenario searched_world(const Experiment& experiment, const Evaluation& evaluation) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(evaluation.candidate, scenario);
  if (depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread)) {
    scenario.kernel.seed = seed_of(experiment, {evaluation.run, evaluation.number, 0, evaluation.candidate, {}});
  }
  return scenario;
}

sim::Scenario own_world(const Experiment& experiment, const Evaluation& evaluation) {
  sim::Scenario scenario = searched_world(experiment, evaluation);
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

Evaluation rate(const Experiment& experiment, std::uint32_t run, std::uint64_t number, const Candidate& candidate,
                std::span<const TrialResult> trials) {
  Evaluation evaluation;
  evaluation.run = run;
  evaluation.number = number;
  evaluation.candidate = candidate;
  for (const Objective& objective : experiment.objectives) {
    evaluation.scores.push_back(score_of(objective, experiment.trials.aggregate, trials));
  }
  evaluation.measures = mean_measures(trials);
  for (const TrialResult& trial : trials) {
    evaluation.wall_s += trial.wall_s;
    evaluation.simulated_s += trial.simulated_s;
    evaluation.given_up = evaluation.given_up || trial.given_up;
    if (evaluation.failure.empty()) {
      evaluation.failure = trial.failure;
    }
  }
  return evaluation;
}

bool has_own_score(const Experiment& experiment, const Evaluation& evaluation, std::size_t objective) {
  return evaluation.failure.empty() && objective < evaluation.scores.size() &&
         std::isfinite(evaluation.scores[objective]) &&
         std::ranges::all_of(experiment.objectives[objective].terms,
                             [&](const Term& term) { return std::isfinite(evaluation.measures[term.measure]); });
}

std::string why_without_score(const Experiment& experiment, const Evaluation& evaluation) {
  if (!evaluation.failure.empty()) {
    return evaluation.failure;
  }
  std::vector<std::string> undefined;
  for (const Term& term : experiment.objectives.front().terms) {
    if (!std::isfinite(evaluation.measures[term.measure])) {
      undefined.emplace_back(sim::declaration_of(term.measure).name);
    }
  }
  return "the run does not define " + listed(undefined);
}

bool is_better(const Experiment& experiment, const Evaluation& evaluation, const Evaluation* other) {
  return has_own_score(experiment, evaluation, 0) && !evaluation.given_up &&
         (other == nullptr || experiment.objectives.front().better(evaluation.scores.front(), other->scores.front()));
}

const Evaluation* baseline_of(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  return experiment.has_baseline && !evaluations.empty() ? &evaluations.front() : nullptr;
}

}  // namespace proleg::optimize
