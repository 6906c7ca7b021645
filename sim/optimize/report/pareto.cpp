#include <algorithm>
#include <numeric>
#include <set>

#include "sim/optimize/evaluation/rating.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

/// Whether scores a are better than b in one objective and worse in none.
bool dominates(const Experiment& experiment, const std::vector<double>& a, const std::vector<double>& b) {
  bool better = false;
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const Objective& objective = experiment.objectives[i];
    if (objective.better(b[i], a[i])) {
      return false;
    }
    better = better || objective.better(a[i], b[i]);
  }
  return better;
}

/// Orders scores, best first: by the first objective, then by the second, and so on. A candidate comes before those
/// that it dominates.
bool comes_before(const Experiment& experiment, const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    if (a[i] != b[i]) {
      return experiment.objectives[i].better(a[i], b[i]);
    }
  }
  return false;
}

bool has_all_scores(const Experiment& experiment, const Evaluation& evaluation) {
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    if (!has_own_score(experiment, evaluation, i)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<std::size_t> pareto_front(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  std::vector<std::size_t> order(evaluations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !has_all_scores(experiment, evaluations[i]); });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return comes_before(experiment, evaluations[a].scores, evaluations[b].scores);
  });

  std::vector<std::size_t> front;
  std::set<Candidate> same_scores;  // candidates with the scores of the last one on the front
  for (const std::size_t i : order) {
    const std::vector<double>& scores = evaluations[i].scores;
    // With two objectives, the last one on the front is the best so far in the second: only it can dominate.
    const std::size_t rivals =
        experiment.objectives.size() <= 2 ? std::min<std::size_t>(front.size(), 1) : front.size();
    const bool beaten = std::any_of(front.end() - static_cast<std::ptrdiff_t>(rivals), front.end(), [&](std::size_t j) {
      return dominates(experiment, evaluations[j].scores, scores);
    });
    if (beaten) {
      continue;
    }
    if (front.empty() || evaluations[front.back()].scores != scores) {
      same_scores.clear();
    }
    if (same_scores.insert(evaluations[i].candidate).second) {
      front.push_back(i);
    }
  }

  const auto is_less = [&](std::size_t a, std::size_t b) {
    const double first = evaluations[a].scores.front();
    const double second = evaluations[b].scores.front();
    return first != second ? first < second : a < b;
  };
  std::ranges::sort(front, is_less);
  return front;
}

}  // namespace proleg::optimize
