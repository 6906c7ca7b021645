#pragma once

// Values that the value sets of an experiment leave out.

#include <cstddef>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// A value of a candidate that is the lowest or highest of its set, although the parameter may have others beyond it.
struct ValueAtBound {
  std::size_t dimension;
  bool is_highest;
};

/// The values at bounds of a candidate, in the order of the dimensions, without dimensions of one value and phases
/// whose values go around the whole turn.
[[nodiscard]] std::vector<ValueAtBound> values_at_bounds(const Experiment& experiment, const Candidate& candidate);

/// A value of the scenario that is not in the set of its dimension.
struct MovedValue {
  std::string name;     ///< "amplitude:J5"
  std::string own;      ///< the scenario's value: "41"
  std::string nearest;  ///< the value in the set: "40"
  std::string unit;
};

/// The scenario's own values that SearchSpace::nearest() replaces: at most one for each dimension.
[[nodiscard]] std::vector<MovedValue> values_outside_space(const Experiment& experiment);

}  // namespace proleg::optimize
