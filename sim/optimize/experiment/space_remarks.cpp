#include "sim/optimize/experiment/space_remarks.hpp"

#include <algorithm>
#include <cstdint>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// Whether the values go around the whole turn: the step from the last one to the first is no longer than any other
/// step.
bool goes_around(const Dimension& dimension) {
  const auto distance = [](std::int32_t from, std::int32_t to) {
    return static_cast<std::uint32_t>(to) - static_cast<std::uint32_t>(from);
  };
  std::uint32_t longest_step = 0;
  for (std::size_t i = 1; i < dimension.values.size(); ++i) {
    longest_step = std::max(longest_step, distance(dimension.values[i - 1], dimension.values[i]));
  }
  return distance(dimension.values.back(), dimension.values.front()) <= longest_step;
}

const Parameter& parameter_of(const sim::Scenario& scenario, const Setting& target) {
  return scenario.kernel.slots[target.slot].algorithm->declaration().parameters[target.number];
}

/// Whether the parameter may have values beyond the bound of its set.
bool can_go_beyond(const sim::Scenario& scenario, const Dimension& dimension, bool is_highest) {
  if (wraps(dimension.unit)) {
    return !goes_around(dimension);
  }
  const Parameter& parameter = parameter_of(scenario, dimension.targets.front());
  return is_highest ? dimension.values.back() < parameter.maximum : dimension.values.front() > parameter.minimum;
}

std::string text_of(std::int32_t value, Unit unit) { return std::string(format_decimal(value, unit).view()); }

}  // namespace

std::vector<ValueAtBound> values_at_bounds(const Experiment& experiment, const Candidate& candidate) {
  std::vector<ValueAtBound> found;
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    const Dimension& dimension = experiment.space.dimensions[i];
    const bool is_highest = candidate[i] + 1 == dimension.values.size();
    if (dimension.values.size() > 1 && (is_highest || candidate[i] == 0) &&
        can_go_beyond(experiment.scenario, dimension, is_highest)) {
      found.push_back({i, is_highest});
    }
  }
  return found;
}

std::vector<MovedValue> values_outside_space(const Experiment& experiment) {
  std::vector<MovedValue> moved;
  const Candidate nearest = experiment.space.nearest(experiment.scenario);
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    const Dimension& dimension = experiment.space.dimensions[i];
    const std::int32_t value = dimension.values[nearest[i]];
    for (const Setting& target : dimension.targets) {
      const std::int32_t own = start_value(experiment.scenario, target.slot, target.joint, target.number);
      if (own != value) {
        moved.push_back({dimension.name, text_of(own, dimension.unit), text_of(value, dimension.unit),
                         sim::shown_unit(dimension.unit)});
        break;
      }
    }
  }
  return moved;
}

}  // namespace proleg::optimize
