#include "tools/proleg/ui/newest_algorithms.hpp"

#include <algorithm>
#include <string_view>

#include "shared/gait/registry.hpp"

namespace proleg::tools {
namespace {

/// The version to use now; the same if there is no other.
const ActuationModule* newest(const ActuationModule* algorithm) {
  const ActuationModule* const found = algorithm == nullptr ? nullptr : find_algorithm(algorithm->declaration().name);
  return found == nullptr ? algorithm : found;
}

bool has_same_values(const Declaration& a, const Declaration& b) {
  const auto is_same_parameter = [](const Parameter& x, const Parameter& y) {
    return x.name == y.name && x.unit == y.unit && x.default_value == y.default_value && x.minimum == y.minimum &&
           x.maximum == y.maximum;
  };
  const auto is_same_value = [](const InternalValue& x, const InternalValue& y) {
    return std::string_view(x.name) == std::string_view(y.name) && x.unit == y.unit;
  };
  return a.id == b.id && std::ranges::equal(a.parameters, b.parameters, is_same_parameter) &&
         std::ranges::equal(a.internal_values, b.internal_values, is_same_value);
}

}  // namespace

bool has_newer_algorithms(const sim::Scenario& scenario) {
  return std::ranges::any_of(scenario.kernel.slots,
                             [](const auto& slot) { return newest(slot.algorithm) != slot.algorithm; });
}

std::vector<std::string> take_newest_algorithms(sim::Scenario& scenario) {
  std::vector<std::string> others;
  for (auto& slot : scenario.kernel.slots) {
    const ActuationModule* const found = newest(slot.algorithm);
    if (found == slot.algorithm) {
      continue;
    }
    if (has_same_values(found->declaration(), slot.algorithm->declaration())) {
      slot.algorithm = found;
    } else {
      others.emplace_back(slot.algorithm->declaration().name);
    }
  }
  return others;
}

}  // namespace proleg::tools
