#include "shared/gait/decision_list.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

enum RuleParameters : std::uint8_t { feature, threshold, second_feature, second_threshold };

}  // namespace

/// A condition of a rule. Without a feature it always holds.
struct DecisionList::Condition {
  std::int32_t feature;  ///< as the parameter
  std::int32_t threshold;

  [[nodiscard]] unsigned index() const { return static_cast<unsigned>((feature < 0 ? -feature : feature) - 1); }
  [[nodiscard]] bool holds(const std::int32_t* features, std::int32_t relaxed_by) const {
    if (feature == 0) {
      return true;
    }
    // Without a branch: a < b where ~a > ~b.
    const std::int32_t complement = feature < 0 ? -1 : 0;
    return (features[index()] ^ complement) > subtract_saturating(threshold ^ complement, relaxed_by);
  }
  /// Whether every value that passes this condition passes the other one.
  [[nodiscard]] bool implies(const Condition& other) const {
    return other.feature == 0 ||
           (feature == other.feature && (feature > 0 ? threshold >= other.threshold : threshold <= other.threshold));
  }
};

struct DecisionList::Rule {
  Condition first;
  Condition second;

  [[nodiscard]] bool implies(const Rule& other) const {
    const auto passes = [this](const Condition& condition) {
      return first.implies(condition) || second.implies(condition);
    };
    return first.feature != 0 && other.first.feature != 0 && passes(other.first) && passes(other.second);
  }
  [[nodiscard]] bool holds(const std::int32_t* features, std::int32_t relaxed_by) const {
    return first.feature != 0 && first.holds(features, relaxed_by) && second.holds(features, relaxed_by);
  }
};

DecisionList::Rule DecisionList::rule(std::int32_t set) const {
  const std::int32_t* const own = rules_ + static_cast<unsigned>(set - 2) * parameters_of_rule;
  return {{own[feature], own[threshold]}, {own[second_feature], own[second_threshold]}};
}

std::int32_t DecisionList::choose(const std::int32_t* features, std::int32_t present, std::int32_t relaxed_by) const {
  for (std::int32_t set = set_count_; set > 1; --set) {
    const Rule tried = rule(set);
    if (set == present) {
      if (tried.holds(features, relaxed_by)) {
        return set;
      }
    } else if (tried.holds(features, 0)) {
      return set;
    }
  }
  return 1;
}

unsigned DecisionList::features() const {
  unsigned named = 0;
  for (std::int32_t set = 2; set <= set_count_; ++set) {
    const Rule each = rule(set);
    for (const Condition& condition : {each.first, each.second}) {
      named |= condition.feature == 0 ? 0U : 1U << condition.index();
    }
  }
  return named;
}

std::optional<Contradiction> DecisionList::contradiction(unsigned first_parameter) const {
  const auto parameter_of = [first_parameter](std::int32_t set, RuleParameters place) {
    return static_cast<std::uint8_t>(first_parameter + static_cast<unsigned>(set - 2) * parameters_of_rule + place);
  };
  for (std::int32_t set = 2; set <= set_count_; ++set) {
    const Rule each = rule(set);
    if (each.first.feature == 0 && each.second.feature != 0) {
      return Contradiction{parameter_of(set, feature), parameter_of(set, second_feature),
                           "a first condition where there is a second one"};
    }
    if (each.first.feature != 0 && each.first.feature == -each.second.feature) {
      const auto [below, above] = std::minmax(
          each.first, each.second, [](const Condition& a, const Condition& b) { return a.feature < b.feature; });
      // A value has to be between them.
      if (std::int64_t{above.threshold} + 1 >= below.threshold) {
        return Contradiction{parameter_of(set, threshold), parameter_of(set, second_threshold),
                             "two conditions that a value can meet together"};
      }
    }
    for (std::int32_t greater = set + 1; greater <= set_count_; ++greater) {
      if (each.implies(rule(greater))) {
        return Contradiction{parameter_of(set, each.first.implies(rule(greater).first) ? threshold : second_threshold),
                             parameter_of(greater, threshold),
                             "a rule that can hold while the rule of the greater set does not, which comes first"};
      }
    }
  }
  return std::nullopt;
}

}  // namespace proleg
