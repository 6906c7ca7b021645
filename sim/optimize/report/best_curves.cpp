#include "sim/optimize/report/best_curves.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::optimize {

std::vector<double> best_so_far(std::span<const Evaluation> run) {
  std::vector<double> best;
  best.reserve(run.size());
  for (const Evaluation& evaluation : run) {
    const double score = evaluation.scores.front();
    best.push_back(best.empty() ? score : std::max(best.back(), score));
  }
  return best;
}

BestCurves best_curves(const MethodRuns& method) {
  std::vector<std::vector<double>> runs;
  std::size_t longest = 0;
  for (const std::vector<Evaluation>& run : method.runs) {
    if (!run.empty()) {
      runs.push_back(best_so_far(run));
      longest = std::max(longest, run.size());
    }
  }
  BestCurves curves;
  for (std::size_t i = 0; i < longest; ++i) {
    double sum = 0.0;
    double low = INFINITY;
    double high = -INFINITY;
    for (const std::vector<double>& run : runs) {
      const double best = run[std::min(i, run.size() - 1)];
      sum += best;
      low = std::min(low, best);
      high = std::max(high, best);
    }
    curves.min.push_back(low);
    curves.mean.push_back(sum / static_cast<double>(runs.size()));
    curves.max.push_back(high);
  }
  return curves;
}

std::optional<std::size_t> overtaking(const BestCurves& follower, const BestCurves& leader) {
  const std::size_t length = std::max(follower.mean.size(), leader.mean.size());
  if (follower.mean.empty() || leader.mean.empty()) {
    return std::nullopt;
  }
  const auto at = [](const std::vector<double>& curve, std::size_t i) { return curve[std::min(i, curve.size() - 1)]; };
  std::size_t above_from = length;
  while (above_from > 0 && at(follower.mean, above_from - 1) > at(leader.mean, above_from - 1)) {
    --above_from;
  }
  return above_from == length ? std::nullopt : std::optional(above_from);
}

std::optional<std::size_t> evaluations_to_reach(const BestCurves& curves, double score) {
  const auto reached = std::ranges::find_if(curves.mean, [score](double mean) { return mean >= score; });
  return reached == curves.mean.end() ? std::nullopt
                                      : std::optional(static_cast<std::size_t>(reached - curves.mean.begin()) + 1);
}

}  // namespace proleg::optimize
