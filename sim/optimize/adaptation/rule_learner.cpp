#include "sim/optimize/adaptation/rule_learner.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace proleg::optimize {
namespace {

/// Share of right examples that a condition has to add.
constexpr double cost_of_condition = 0.005;
/// The same for each 1.0 of hysteresis.
constexpr double cost_of_hysteresis = 0.05;
constexpr std::array tried_hystereses{0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4};
constexpr double ratio_one = 1U << 28U;
constexpr std::size_t most_gaps = 31;
/// Sums in another order differ by less; examples differ by more.
constexpr double rounding = 1e-9;

/// Two values of a feature between which no example has one: a threshold can lie there.
struct Gap {
  double low;
  double high;
};

/// The middle, with as few decimals as it can have, at least three.
std::int32_t threshold_in(const Gap& gap) {
  const double middle = (gap.low + gap.high) / 2;
  for (double steps = 1'000; steps < ratio_one; steps *= 10) {
    const double rounded = std::round(middle / ratio_one * steps) / steps * ratio_one;
    if (rounded > gap.low && rounded < gap.high) {
      return static_cast<std::int32_t>(std::lround(rounded));
    }
  }
  return static_cast<std::int32_t>(std::lround(middle));
}

/// A feature of all examples, as one side of a threshold sees it, in steps between which there are gaps.
struct SteppedFeature {
  unsigned feature = 0;
  bool is_above = false;            ///< the side that passes
  std::vector<Gap> gaps;            ///< ascending
  std::vector<std::uint8_t> steps;  ///< of each example: how many gaps are below its value

  /// A cut passes the steps on its side: from it on, or before it. 0 < cut <= gaps.size().
  [[nodiscard]] bool passes(std::size_t example, std::size_t cut) const { return (steps[example] >= cut) == is_above; }
};

std::vector<Gap> gaps_between(std::vector<double> values) {
  std::ranges::sort(values);
  std::vector<Gap> gaps;
  for (std::size_t i = 1; i <= most_gaps; ++i) {
    // The one that is nearest above this share of the examples.
    const double low = values[i * (values.size() - 1) / (most_gaps + 1)];
    const auto high = std::ranges::upper_bound(values, low);
    if (high == values.end()) {
      break;
    }
    if (gaps.empty() || low > gaps.back().low) {
      gaps.push_back({low, *high});
    }
  }
  return gaps;
}

struct Condition {
  const SteppedFeature* feature = nullptr;
  std::size_t cut = 0;
};

struct Rule {
  std::vector<Condition> conditions;  ///< 1 or 2; none: the rule never holds
  double gain = 0.0;
};

constexpr std::uint32_t all_sets = bit_of_set(gait_sets + 1) - 1;

using RuleOrder = std::array<std::int32_t, gait_sets - 1>;

/// What an example gains if the rule holds for it.
struct Gain {
  std::size_t example;
  double value;
};

class Learner {
 public:
  Learner(std::span<const RuleExample> examples, std::uint32_t usable, std::int32_t hysteresis)
      : examples_(examples), usable_(usable), hysteresis_(hysteresis) {
    for (const RuleExample& example : examples) {
      weights_[example.right_sets] += 1.0;
    }
    for (auto& [gait, weight] : weights_) {
      weight = 1.0 / weight / static_cast<double>(weights_.size());
    }
  }

  /// order: in which the rules take turns.
  LearnedRules learn(const RuleOrder& order) {
    rules_ = {};
    std::uint32_t unlearned = all_sets;
    constexpr int most_rounds = 10;
    double before = -1.0;
    for (int round = 0; round < most_rounds && score() > before + rounding; ++round) {
      before = score();
      for (const std::int32_t set : order) {
        unlearned &= ~bit_of_set(set);
        learn_rule(set, round == 0 ? unlearned : 0);
      }
    }
    drop_contradictions();
    return {rules_, hysteresis_, score()};
  }

 private:
  static bool is_right(const RuleExample& example, std::int32_t set) {
    return (example.right_sets & bit_of_set(set)) != 0;
  }
  [[nodiscard]] std::int32_t chosen(const RuleExample& example) const {
    return DecisionList(rules_.data(), gait_sets).choose(example.features.data(), example.played, hysteresis_);
  }
  [[nodiscard]] double score() const {
    double sum = -cost_of_hysteresis * hysteresis_ / ratio_one;
    for (const RuleExample& example : examples_) {
      sum += is_right(example, chosen(example)) ? weights_.at(example.right_sets) : 0.0;
    }
    for (std::size_t i = 0; i < rules_.size(); i += 2) {
      sum -= rules_[i] != 0 ? cost_of_condition : 0.0;
    }
    return sum;
  }

  /// The usable features as the rule for a set sees them: its thresholds are easier to pass while the set is played.
  [[nodiscard]] std::vector<SteppedFeature> features_for(std::int32_t set) const {
    std::vector<SteppedFeature> features;
    for (unsigned feature = 0; feature < GaitFeatures::count; ++feature) {
      for (const bool is_above : {false, true}) {
        if (((usable_ >> feature) & 1U) == 0) {
          continue;
        }
        std::vector<double> values;
        values.reserve(examples_.size());
        for (const RuleExample& example : examples_) {
          const double easier = example.played == set ? hysteresis_ : 0.0;
          values.push_back(example.features[feature] + (is_above ? easier : -easier));
        }
        SteppedFeature& last = features.emplace_back(SteppedFeature{feature, is_above, gaps_between(values), {}});
        for (const double value : values) {
          last.steps.push_back(static_cast<std::uint8_t>(std::ranges::upper_bound(last.gaps, value, {}, &Gap::high) -
                                                         last.gaps.begin()));
        }
      }
    }
    return features;
  }

  void learn_rule(std::int32_t set, std::uint32_t unlearned) {
    std::int32_t* own = rules_.data() + static_cast<std::size_t>(set - 2) * DecisionList::parameters_of_rule;
    std::fill(own, own + DecisionList::parameters_of_rule, 0);
    const std::vector<Gain> gains = gains_of(set, unlearned);
    const std::vector<SteppedFeature> features = features_for(set);
    Rule best;
    for (std::size_t i = 0; i < features.size(); ++i) {
      try_single(features[i], gains, best);
      for (std::size_t j = i + 1; j < features.size(); ++j) {
        try_pair(features[i], features[j], gains, best);
      }
    }
    for (std::size_t i = 0; i < best.conditions.size(); ++i, own += 2) {
      const SteppedFeature& feature = *best.conditions[i].feature;
      own[0] = static_cast<std::int32_t>(feature.feature + 1) * (feature.is_above ? 1 : -1);
      own[1] = threshold_in(widest_gap(best, i, gains));
    }
  }

  /// Of the examples for which no greater set's rule holds, without the rule of `set`. unlearned: sets whose rules are
  /// not learned yet; they are expected to be right where this set is not.
  [[nodiscard]] std::vector<Gain> gains_of(std::int32_t set, std::uint32_t unlearned) const {
    std::vector<Gain> gains;
    const std::uint32_t greater_sets = all_sets & ~(bit_of_set(set + 1) - 1);
    for (std::size_t i = 0; i < examples_.size(); ++i) {
      const RuleExample& example = examples_[i];
      const std::int32_t otherwise = chosen(example);
      const bool is_right_here = is_right(example, set);
      const bool is_right_with_rule = is_right_here || (example.right_sets & unlearned & greater_sets) != 0;
      const bool is_right_without =
          is_right(example, otherwise) || (!is_right_here && (example.right_sets & unlearned) != 0);
      if (otherwise < set && is_right_with_rule != is_right_without) {
        const double weight = weights_.at(example.right_sets);
        gains.push_back({i, is_right_with_rule ? weight : -weight});
      }
    }
    return gains;
  }

  static void keep_better(Rule& best, double gain, std::initializer_list<Condition> conditions) {
    const double kept = gain - cost_of_condition * static_cast<double>(conditions.size());
    if (kept > best.gain + rounding) {
      best = {conditions, kept};
    }
  }

  /// Sums of the gains of the steps before each ratio_one, and of all.
  static std::vector<double> sums_before(const SteppedFeature& feature, const std::vector<Gain>& gains) {
    std::vector<double> sums(feature.gaps.size() + 2, 0.0);
    for (const Gain& gain : gains) {
      sums[feature.steps[gain.example] + 1U] += gain.value;
    }
    for (std::size_t i = 1; i < sums.size(); ++i) {
      sums[i] += sums[i - 1];
    }
    return sums;
  }

  static void try_single(const SteppedFeature& feature, const std::vector<Gain>& gains, Rule& best) {
    const std::vector<double> sums = sums_before(feature, gains);
    for (std::size_t cut = 1; cut <= feature.gaps.size(); ++cut) {
      keep_better(best, feature.is_above ? sums.back() - sums[cut] : sums[cut], {{&feature, cut}});
    }
  }

  static void try_pair(const SteppedFeature& a, const SteppedFeature& b, const std::vector<Gain>& gains, Rule& best) {
    if (a.feature == b.feature && a.is_above == b.is_above) {
      return;
    }
    const std::size_t rows = a.gaps.size() + 1;
    const std::size_t columns = b.gaps.size() + 1;
    // Sums of the gains of the steps before each row and column.
    std::vector<double> sums((rows + 1) * (columns + 1), 0.0);
    const auto at = [&](std::size_t row, std::size_t column) -> double& { return sums[row * (columns + 1) + column]; };
    for (const Gain& gain : gains) {
      at(a.steps[gain.example] + 1U, b.steps[gain.example] + 1U) += gain.value;
    }
    for (std::size_t row = 1; row <= rows; ++row) {
      for (std::size_t column = 1; column <= columns; ++column) {
        at(row, column) += at(row - 1, column) + at(row, column - 1) - at(row - 1, column - 1);
      }
    }
    for (std::size_t row = 1; row < rows; ++row) {
      for (std::size_t column = 1; column < columns; ++column) {
        const double before_row = b.is_above ? at(row, columns) - at(row, column) : at(row, column);
        const double all_rows = b.is_above ? at(rows, columns) - at(rows, column) : at(rows, column);
        keep_better(best, a.is_above ? all_rows - before_row : before_row, {{&a, row}, {&b, column}});
      }
    }
  }

  /// Where a threshold can lie with which the rule gains as much, while its other condition stands.
  static Gap widest_gap(const Rule& rule, std::size_t which, const std::vector<Gain>& gains) {
    const Condition& own = rule.conditions[which];
    std::vector<Gain> passed;
    for (const Gain& gain : gains) {
      const bool others_hold = std::ranges::all_of(rule.conditions, [&](const Condition& condition) {
        return &condition == &own || condition.feature->passes(gain.example, condition.cut);
      });
      if (others_hold) {
        passed.push_back(gain);
      }
    }
    const std::vector<double> sums = sums_before(*own.feature, passed);
    const auto is_same = [&](std::size_t other) { return std::abs(sums[other] - sums[own.cut]) < rounding; };
    std::size_t lowest = own.cut;
    std::size_t highest = own.cut;
    while (lowest > 1 && is_same(lowest - 1)) {
      --lowest;
    }
    while (highest < own.feature->gaps.size() && is_same(highest + 1)) {
      ++highest;
    }
    return {own.feature->gaps[lowest - 1].low, own.feature->gaps[highest - 1].high};
  }

  /// The selector refuses rules that have no effect. They have none on the examples either.
  void drop_contradictions() {
    while (const auto found = DecisionList(rules_.data(), gait_sets).contradiction(0)) {
      const std::size_t rule = found->parameter / DecisionList::parameters_of_rule * DecisionList::parameters_of_rule;
      std::fill_n(rules_.begin() + static_cast<std::ptrdiff_t>(rule), DecisionList::parameters_of_rule, 0);
    }
  }

  std::span<const RuleExample> examples_;
  std::uint32_t usable_;
  std::int32_t hysteresis_;
  std::map<std::uint32_t, double> weights_;  ///< of an example, by its right sets
  RuleParameters rules_{};
};

}  // namespace

LearnedRules learn_rules(std::span<const RuleExample> examples, std::uint32_t usable,
                         const std::optional<std::int32_t>& hysteresis) {
  LearnedRules best;
  best.score = -1.0;
  const auto try_hysteresis = [&](std::int32_t tried) {
    Learner learner(examples, usable, tried);
    RuleOrder order{2, 3, 4};
    do {
      const LearnedRules learned = learner.learn(order);
      if (learned.score > best.score + rounding) {
        best = learned;
      }
    } while (std::next_permutation(order.begin(), order.end()));
  };
  if (hysteresis) {
    try_hysteresis(*hysteresis);
  } else {
    for (const double tried : tried_hystereses) {
      try_hysteresis(static_cast<std::int32_t>(std::lround(tried * ratio_one)));
    }
  }
  return best;
}

}  // namespace proleg::optimize
