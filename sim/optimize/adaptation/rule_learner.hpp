#pragma once

// Learns rules that choose one of several gaits from examples (decision list: R. Rivest, Machine Learning 2, 1987).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/gait/decision_list.hpp"
#include "shared/gait/gait_features.hpp"

namespace proleg::optimize {

/// Sets of parameters of SensingModule_gait_selector.
inline constexpr std::int32_t gait_sets = 4;

/// In a number that stands for several sets.
[[nodiscard]] constexpr std::uint32_t bit_of_set(std::int32_t set) { return 1U << static_cast<unsigned>(set - 1); }

/// Values of the features in a tick: ratios, Q28, in the order of GaitFeatures::Feature.
using FeatureValues = std::array<std::int32_t, GaitFeatures::count>;

/// Parameters of the rules for the sets 2 to 4, as DecisionList takes them.
using RuleParameters = std::array<std::int32_t, (gait_sets - 1) * DecisionList::parameters_of_rule>;

struct RuleExample {
  FeatureValues features{};
  std::uint32_t right_sets = 1;  ///< of which one should be chosen: bit n - 1 for set n; sets of equal gaits together
  std::int32_t played = 1;       ///< while the features were sensed, 1 to gait_sets
};

struct LearnedRules {
  RuleParameters rules{};
  std::int32_t hysteresis = 0;  ///< ratio, Q28
  double score = 0.0;           ///< share of right examples, less what conditions and hysteresis cost
};

/// The rules that choose a right set for the greatest share of the examples, where all gaits count the same however
/// many examples they have. A condition has to make at least 0.5 % more right. The search is exhaustive for one rule
/// while the others stand; the rules take turns in each of their orders until nothing improves. So the result is good,
/// not the best that there is. Of thresholds that do the same the one in the middle is taken, rounded to 0.001 or,
/// where that would be another, to more decimals.
///
/// examples: of at least two gaits. usable: the features that rules may name, bit n for feature n. hysteresis: that of
/// the selector, by which the rule for the set that is played holds longer; nothing: also learned, where 0.1 has to
/// make 0.5 % more right. The same examples give the same rules on every machine.
[[nodiscard]] LearnedRules learn_rules(std::span<const RuleExample> examples, std::uint32_t usable,
                                       const std::optional<std::int32_t>& hysteresis);

}  // namespace proleg::optimize
