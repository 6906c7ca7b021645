#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A point of the search space: for each dimension the index of its value.
using Candidate = std::vector<std::uint32_t>;

/// One number that an optimiser chooses: a parameter of an actuation module, on one joint or the same on several.
struct Dimension {
  std::string name;              ///< unique; as in `--set`: "amplitude:J5", "amplitude", "1.amplitude:J5"
  std::vector<Setting> targets;  ///< settings that it sets (at least one); their values are not used
  Unit unit = Unit::count;
  /// Raw values for the module, at least one, none twice, ascending. The values of a phase ascend from the smallest
  /// number of the file, so that 170, 180 and -170 degrees follow each other.
  std::vector<std::int32_t> values;
};

/// All candidates: the product of the dimensions' value sets (thesis, equation 3.3).
struct SearchSpace {
  std::vector<Dimension> dimensions;

  /// Number of candidates; infinite if it is beyond the range of double.
  [[nodiscard]] double size() const;
  /// Sets the scenario's start values to the candidate's. The candidate has an index below values.size() for each
  /// dimension.
  void apply(const Candidate& candidate, sim::Scenario& scenario) const;
  /// The candidate that is nearest to the scenario's own start values (of each dimension's first target).
  [[nodiscard]] Candidate nearest(const sim::Scenario& scenario) const;
  /// Shortest text of a candidate's value, without unit.
  [[nodiscard]] std::string value_text(const Candidate& candidate, std::size_t dimension) const;
  /// The number that value_text() shows.
  [[nodiscard]] double value(const Candidate& candidate, std::size_t dimension) const;
};

}  // namespace proleg::optimize
