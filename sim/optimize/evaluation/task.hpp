#pragma once

// What workers simulate for a search, and how the results rate a candidate.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/optimize/evaluation/scenario_runs.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// The engine that has the last word on candidates. A faster one may search; what it finds best is rated again in this
/// one, the reference, before anything is called best.
inline constexpr sim::PhysicsEngine judging_engine = sim::PhysicsEngine::ode;

/// Whether the search has another engine. A robot has none, and nothing judges it.
[[nodiscard]] bool is_judged(const Experiment& experiment);

/// One simulation to be made: a trial of a candidate.
struct Task {
  std::uint32_t run = 0;     ///< repetition of the experiment, from 0
  std::uint64_t number = 0;  ///< of the evaluation in its run, from 0: the individual
  /// Number of the trial, from 0. From the experiment's number of trials on: fresh runs of a finalist, in the judging
  /// engine.
  std::uint32_t trial = 0;
  Candidate candidate;
  /// Racing: the trial is given up if its score, extrapolated, is below this.
  std::optional<double> hopeless_below;

  bool operator==(const Task&) const = default;
};

[[nodiscard]] bool is_fresh_run(const Experiment& experiment, const Task& task);

/// Seed of a trial's noise and variations. With common random numbers it is the same for all candidates of a
/// repetition. In fresh runs of finalists it always is.
[[nodiscard]] std::uint64_t seed_of(const Experiment& experiment, const Task& task);

/// Whether two evaluations of a candidate in one repetition may differ.
[[nodiscard]] bool differs_between_evaluations(const Experiment& experiment);

/// Simulates tasks, together if the engine can. Each result, except wall_s, depends only on experiment and task. Throws
/// only if the system fails (out of memory).
[[nodiscard]] std::vector<TrialResult> run_trials(const Experiment& experiment, std::span<const Task> tasks);
/// Simulates one task.
[[nodiscard]] TrialResult run_trial(const Experiment& experiment, const Task& task);

/// Throws InputError if the engine cannot simulate the experiment's trials.
void require_engine(const Experiment& experiment);

/// A rated candidate: the outcome of all its trials.
struct Evaluation {
  std::uint32_t run = 0;
  std::uint64_t number = 0;
  Candidate candidate;
  std::vector<double> scores;   ///< of each objective; mean or worst of its trials
  sim::MeasureValues measures;  ///< mean over the trials that did not fail
  double wall_s = 0.0;          ///< of all trials
  double simulated_s = 0.0;
  bool given_up = false;       ///< at least one trial was
  bool reused = false;         ///< not simulated: an earlier evaluation had the outcome
  bool restored = false;       ///< not simulated now: from the store of an interrupted run
  std::string failure;         ///< of the first trial that failed
  bool after_restart = false;  ///< the first one after the search started again from another population
};

/// The scenario in which a search has simulated a candidate: the experiment's, with its engine, the candidate's values
/// and without the variations of trials. If a run depends on the seed, it has the seed of the evaluation's first trial.
/// Therefore, with one trial that varies nothing, its run is that trial.
[[nodiscard]] sim::Scenario searched_world(const Experiment& experiment, const Evaluation& evaluation);

/// The scenario that a search writes for a candidate: its searched_world() with the judging engine. With one trial that
/// varies nothing its run is therefore that trial, or its fresh run if the search is judged.
[[nodiscard]] sim::Scenario own_world(const Experiment& experiment, const Evaluation& evaluation);

/// Simulates the own_world() of an evaluation.
[[nodiscard]] TrialResult run_own_world(const Experiment& experiment, const Evaluation& evaluation);

/// The evaluation that the trials of a candidate give. trials: all of them, in their order; at least one.
[[nodiscard]] Evaluation rate(const Experiment& experiment, std::uint32_t run, std::uint64_t number,
                              const Candidate& candidate, std::span<const TrialResult> trials);

/// Whether the score of an objective comes from measures, and not from a failure or a measure that is not defined.
[[nodiscard]] bool has_own_score(const Experiment& experiment, const Evaluation& evaluation, std::size_t objective);

/// Why an evaluation has no score of its own for the first objective: its failure, or the measures that its run does
/// not define.
[[nodiscard]] std::string why_without_score(const Experiment& experiment, const Evaluation& evaluation);

/// Whether an evaluation is better than another by the first objective, and has a score that a run can repeat: its own,
/// and not extrapolated by racing. Without another one: whether it has such a score.
[[nodiscard]] bool is_better(const Experiment& experiment, const Evaluation& evaluation, const Evaluation* other);

/// The evaluation of the scenario's own values; null if there is none. evaluations: of one run, by number.
[[nodiscard]] const Evaluation* baseline_of(const Experiment& experiment, std::span<const Evaluation> evaluations);

}  // namespace proleg::optimize
