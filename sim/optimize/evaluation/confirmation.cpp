#include "sim/optimize/evaluation/confirmation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <set>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/task_pipeline.hpp"

namespace proleg::optimize {
namespace {

/// Time between two questions whether to stop.
constexpr std::chrono::milliseconds confirmation_check_interval{100};

Task fresh_run(const Experiment& experiment, const Evaluation& finalist, std::uint32_t run) {
  return {finalist.run, finalist.number, experiment.trials.count + run, finalist.candidate, {}};
}

Confirmation summary_of(const Experiment& experiment, const Evaluation& finalist, std::span<const TrialResult> runs) {
  const Objective& objective = experiment.objectives.front();
  Confirmation confirmation;
  confirmation.evaluation = finalist;
  confirmation.fresh = rate(experiment, finalist.run, finalist.number, finalist.candidate, runs);
  for (const TrialResult& run : runs) {
    confirmation.scores.push_back(objective.score(run.measures));
  }
  const auto count = static_cast<double>(confirmation.scores.size());
  confirmation.worst = confirmation.scores.front();
  for (const double score : confirmation.scores) {
    confirmation.mean += score / count;
    confirmation.worst = objective.better(confirmation.worst, score) ? score : confirmation.worst;
  }
  double squares = 0.0;
  for (const double score : confirmation.scores) {
    squares += (score - confirmation.mean) * (score - confirmation.mean);
  }
  confirmation.standard_deviation = std::sqrt(squares / std::max(count - 1.0, 1.0));
  return confirmation;
}

}  // namespace

ConfirmationSettings fresh_runs(const Experiment& experiment) {
  constexpr std::uint32_t judged_candidates = 10;
  ConfirmationSettings settings = experiment.confirmation;
  if (is_judged(experiment)) {
    const bool is_noisy = depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread);
    settings.candidates = std::max(settings.candidates, judged_candidates);
    settings.runs = is_noisy ? std::max(settings.runs, 1U) : 1;
  }
  return settings;
}

bool needs_confirmation(const Experiment& experiment) {
  return is_judged(experiment) || (!experiment.on_robot && experiment.confirmation.runs > 0 &&
                                   depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread));
}

std::vector<Evaluation> best_candidates(const Experiment& experiment, std::span<const Evaluation> evaluations,
                                        std::size_t count) {
  std::vector<const Evaluation*> order;
  for (const Evaluation& evaluation : evaluations) {
    if (is_better(experiment, evaluation, nullptr)) {
      order.push_back(&evaluation);
    }
  }
  std::ranges::stable_sort(order, [&](const Evaluation* left, const Evaluation* right) {
    return experiment.objectives.front().better(left->scores.front(), right->scores.front());
  });
  std::vector<Evaluation> best;
  std::set<Candidate> chosen;
  for (const Evaluation* evaluation : order) {
    if (best.size() < count && chosen.insert(evaluation->candidate).second) {
      best.push_back(*evaluation);
    }
  }
  return best;
}

std::vector<Evaluation> choose_finalists(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  std::vector<Evaluation> finalists = best_candidates(experiment, evaluations, fresh_runs(experiment).candidates);
  const Evaluation* const baseline = baseline_of(experiment, evaluations);
  if (baseline != nullptr && is_better(experiment, *baseline, nullptr) &&
      std::ranges::count(finalists, baseline->candidate, &Evaluation::candidate) == 0) {
    finalists.push_back(*baseline);
  }
  return finalists;
}

std::vector<Confirmation> confirm(const Experiment& experiment, std::span<const Evaluation> finalists, Workers& workers,
                                  Store* store, const std::function<bool(std::size_t done, std::size_t all)>& stop) {
  const std::uint32_t runs = fresh_runs(experiment).runs;
  std::vector<Task> tasks;
  for (const Evaluation& finalist : finalists) {
    for (std::uint32_t run = 0; run < runs; ++run) {
      tasks.push_back(fresh_run(experiment, finalist, run));
    }
  }
  TaskPipeline pipeline(experiment, workers, store, TaskPipeline::ResultScope::one_number);
  pipeline.set_wanted(tasks);
  const auto count_done = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(tasks, [&](const Task& task) { return pipeline.has_result(task); }));
  };
  for (std::size_t done = count_done(); done < tasks.size(); done = count_done()) {
    if (stop && stop(done, tasks.size())) {
      throw SearchEnded{};
    }
    pipeline.run(confirmation_check_interval);
  }
  std::vector<Confirmation> confirmations;
  for (const Evaluation& finalist : finalists) {
    std::vector<TrialResult> results;
    for (std::uint32_t run = 0; run < runs; ++run) {
      results.push_back(pipeline.claim_result(fresh_run(experiment, finalist, run)).result);
    }
    confirmations.push_back(summary_of(experiment, finalist, results));
  }
  std::ranges::stable_sort(confirmations, [&](const Confirmation& left, const Confirmation& right) {
    const Objective& objective = experiment.objectives.front();
    return experiment.trials.aggregate == Aggregate::mean ? objective.better(left.mean, right.mean)
                                                          : objective.better(left.worst, right.worst);
  });
  return confirmations;
}

}  // namespace proleg::optimize
