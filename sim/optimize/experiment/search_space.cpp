#include "sim/optimize/experiment/search_space.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "shared/fixed/decimal.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// Distance of two raw values; the distance of phases is the shorter way around.
std::int64_t distance_between(std::int32_t left, std::int32_t right, Unit unit) {
  if (wraps(unit)) {
    const std::uint32_t ahead = static_cast<std::uint32_t>(left) - static_cast<std::uint32_t>(right);
    return std::min<std::int64_t>(ahead, (std::int64_t{1} << 32U) - ahead);
  }
  return std::abs(std::int64_t{left} - right);
}

}  // namespace

double SearchSpace::size() const {
  double product = 1.0;
  for (const Dimension& dimension : dimensions) {
    product *= static_cast<double>(dimension.values.size());
  }
  return product;
}

void SearchSpace::apply(const Candidate& candidate, sim::Scenario& scenario) const {
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    for (Setting setting : dimensions[d].targets) {
      setting.value = dimensions[d].values[candidate[d]];
      set_start_value(scenario, setting);
    }
  }
}

Candidate SearchSpace::nearest(const sim::Scenario& scenario) const {
  Candidate candidate;
  candidate.reserve(dimensions.size());
  for (const Dimension& dimension : dimensions) {
    const Setting& first = dimension.targets.front();
    const std::int32_t own = start_value(scenario, first.slot, first.joint, first.number);
    const auto nearest = std::ranges::min_element(
        dimension.values, {}, [&](std::int32_t value) { return distance_between(value, own, dimension.unit); });
    candidate.push_back(static_cast<std::uint32_t>(nearest - dimension.values.begin()));
  }
  return candidate;
}

std::string SearchSpace::value_text(const Candidate& candidate, std::size_t dimension) const {
  const Dimension& chosen = dimensions[dimension];
  return std::string(format_decimal(chosen.values[candidate[dimension]], chosen.unit).view());
}

double SearchSpace::value(const Candidate& candidate, std::size_t dimension) const {
  // The text gives 50; the raw value times the step of the unit would give 50.0000000372529.
  const std::string text = value_text(candidate, dimension);
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace proleg::optimize
