#include "sim/optimize/report/method_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>

namespace proleg::optimize {
namespace {

/// Twice the ranks of the values, those of a first. They are whole numbers even if equal values share a rank.
std::vector<std::uint32_t> doubled_ranks(std::span<const double> a, std::span<const double> b) {
  std::vector<double> values(a.begin(), a.end());
  values.insert(values.end(), b.begin(), b.end());
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  std::vector<std::uint32_t> ranks;
  for (const double value : values) {
    const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), value);
    ranks.push_back(static_cast<std::uint32_t>((first - sorted.begin()) + 1 + (last - sorted.begin())));
  }
  return ranks;
}

/// For each sum, the number of ways in which `chosen` of the ranks have it.
std::vector<double> ways_to_sum(std::span<const std::uint32_t> ranks, std::size_t chosen) {
  const std::size_t most = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<std::vector<double>> ways(chosen + 1, std::vector<double>(most + 1, 0.0));
  ways[0][0] = 1.0;
  for (const std::uint32_t rank : ranks) {
    for (std::size_t count = chosen; count > 0; --count) {  // downwards: a rank is chosen once
      for (std::size_t sum = rank; sum <= most; ++sum) {
        ways[count][sum] += ways[count - 1][sum - rank];
      }
    }
  }
  return ways[chosen];
}

double exact_test(std::span<const std::uint32_t> ranks, std::size_t size) {
  const double all_ranks = std::accumulate(ranks.begin(), ranks.end(), 0.0);
  const double found = std::accumulate(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(size), 0.0);
  const double expected = all_ranks * static_cast<double>(size) / static_cast<double>(ranks.size());
  // The comparison is exact: all three are whole numbers, or quotients whose error is far below one half.
  const double distance = std::abs(found - expected) - 0.25;
  const std::vector<double> ways = ways_to_sum(ranks, size);
  double all = 0.0;
  double as_far = 0.0;
  for (std::size_t sum = 0; sum < ways.size(); ++sum) {
    all += ways[sum];
    as_far += std::abs(static_cast<double>(sum) - expected) >= distance ? ways[sum] : 0.0;
  }
  return as_far / all;
}

double approximate_test(std::span<const std::uint32_t> ranks, std::size_t size) {
  const auto count = static_cast<double>(ranks.size());
  const auto first = static_cast<double>(size);
  const double mean_rank = std::accumulate(ranks.begin(), ranks.end(), 0.0) / count;
  double squares = 0.0;
  for (const std::uint32_t rank : ranks) {
    squares += (rank - mean_rank) * (rank - mean_rank);
  }
  const double found = std::accumulate(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(size), 0.0);
  // Variance of a sum of `size` ranks drawn without replacement.
  const double deviation = std::sqrt(squares / count * first * (count - first) / (count - 1.0));
  if (deviation == 0.0) {
    return 1.0;
  }
  const double step = 1.0;  // half of the step of a doubled rank sum: the correction for continuity
  const double distance = std::max(std::abs(found - mean_rank * first) - step, 0.0);
  return std::erfc(distance / deviation / std::numbers::sqrt2);
}

}  // namespace

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

double share_above(std::span<const double> a, std::span<const double> b) {
  double above = 0.0;
  for (const double one : a) {
    for (const double other : b) {
      above += one > other ? 1.0 : (one == other ? 0.5 : 0.0);
    }
  }
  return above / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

double rank_sum_test(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t most_exact = 100;
  if (a.empty() || b.empty()) {
    return 1.0;
  }
  const std::vector<std::uint32_t> ranks = doubled_ranks(a, b);
  return ranks.size() <= most_exact ? exact_test(ranks, a.size()) : approximate_test(ranks, a.size());
}

std::vector<double> correct_for_several(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<double> corrected(p_values.size());
  double greatest = 0.0;
  for (std::size_t place = 0; place < order.size(); ++place) {
    const double remaining = static_cast<double>(order.size() - place);
    greatest = std::max(greatest, std::min(remaining * p_values[order[place]], 1.0));
    corrected[order[place]] = greatest;
  }
  return corrected;
}

}  // namespace proleg::optimize
