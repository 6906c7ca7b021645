#pragma once

#include <cstdint>
#include <optional>

#include "shared/gait/declaration.hpp"

namespace proleg {

/// Rules that choose one of several sets by features (decision list: R. Rivest, Machine Learning 2, 1987): the greatest
/// set whose rule holds, else set 1. A rule is one condition or two, and both have to hold: a feature is above a
/// threshold, or below it.
///
/// A rule takes up four parameters of its algorithm, in this order: feature, threshold, second feature, second
/// threshold. A feature is a number from 1; negative: it has to be below; 0: there is no such condition, and a rule
/// without a first condition never holds. Thresholds have the unit of the features, Q28.
class DecisionList {
 public:
  static constexpr unsigned parameters_of_rule = 4;

  /// rules: the parameters of the rules for the sets 2 to set_count; it must outlive this object.
  DecisionList(const std::int32_t* rules, std::int32_t set_count) : rules_(rules), set_count_(set_count) {}

  /// The set for these features. relaxed_by: how far the thresholds of the rule for `present` are easier to pass.
  [[nodiscard]] std::int32_t choose(const std::int32_t* features, std::int32_t present, std::int32_t relaxed_by) const;

  /// The features that rules name: bit n - 1 for feature n.
  [[nodiscard]] unsigned features() const;

  /// What contradicts in the rules: a second condition without a first, two conditions that no value passes, or a rule
  /// that holds only where the rule for a greater set does. first_parameter: number of the first rule's first one.
  [[nodiscard]] std::optional<Contradiction> contradiction(unsigned first_parameter) const;

 private:
  struct Condition;
  struct Rule;
  [[nodiscard]] Rule rule(std::int32_t set) const;

  const std::int32_t* rules_;
  std::int32_t set_count_;
};

}  // namespace proleg
