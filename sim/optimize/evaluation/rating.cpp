#include "sim/optimize/evaluation/rating.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

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
