#include "sim/optimize/evaluation/task.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "sim/loop/simulation.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::optimize {
namespace {

sim::Scenario scenario_of(const Experiment& experiment, const Task& task) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(task.candidate, scenario);
  const Spread& spread = experiment.trials.spread;
  if (depends_on_seed(experiment.scenario, experiment.space, spread)) {
    perturb(scenario, spread, seed_of(experiment, task));
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

/// hopeless_below: for racing; nothing: the run goes to its end.
void simulate(const Experiment& experiment, const sim::Scenario& scenario, std::optional<double> hopeless_below,
              TrialResult& result) {
  const std::uint32_t ticks = sim::tick_count(scenario);
  const std::optional<std::uint32_t> check_tick = racing_tick(experiment, hopeless_below, ticks);
  sim::Simulation simulation(scenario);
  simulation.leave_out_hashes();
  try {
    while (simulation.tick() < ticks && !result.given_up) {
      simulation.advance();
      if (simulation.tick() == check_tick) {
        race(experiment, *hopeless_below, simulation, static_cast<double>(*check_tick) / ticks, result);
      }
    }
    if (!result.given_up) {
      result.measures = simulation.measures(experiment.heading_deg);
    }
  } catch (const sim::PhysicsError& error) {
    result.failure = error.what();
  }
  result.simulated_s = simulation.time_s();
}

TrialResult timed_run(const Experiment& experiment, const sim::Scenario& scenario,
                      std::optional<double> hopeless_below) {
  const auto start = std::chrono::steady_clock::now();
  TrialResult result;
  simulate(experiment, scenario, hopeless_below, result);
  normalise(result.measures);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

std::uint64_t seed_of(const Experiment& experiment, const Task& task) {
  const bool is_common = experiment.trials.random_numbers == RandomNumbers::common ||
                         task.trial >= experiment.trials.count;  // a fresh run of a finalist
  return trial_seed(experiment.seed, task.run, is_common ? 0 : task.number, task.trial);
}

bool differs_between_evaluations(const Experiment& experiment) {
  return experiment.trials.random_numbers == RandomNumbers::fresh &&
         depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread);
}

TrialResult run_trial(const Experiment& experiment, const Task& task) {
  return timed_run(experiment, scenario_of(experiment, task), task.hopeless_below);
}

sim::Scenario own_world(const Experiment& experiment, const Evaluation& evaluation) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(evaluation.candidate, scenario);
  if (depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread)) {
    scenario.kernel.seed = seed_of(experiment, {evaluation.run, evaluation.number, 0, evaluation.candidate, {}});
  }
  return scenario;
}

TrialResult run_own_world(const Experiment& experiment, const Evaluation& evaluation) {
  return timed_run(experiment, own_world(experiment, evaluation), std::nullopt);
}

}  // namespace proleg::optimize
