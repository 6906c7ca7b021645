#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

/// A place in the search space: for each dimension the index of its value.
using Candidate = std::vector<std::uint32_t>;

/// One number that an optimiser chooses: a parameter of an actuation module, on one joint or the same on several.
struct Dimension {
  std::string name;                   ///< unique; as in `--set`: "amplitude:J5", "amplitude", "1.amplitude:J5"
  std::vector<sim::Setting> targets;  ///< what it sets; their values are not used. At least one
  Unit unit = Unit::count;
  /// Raw values that a module can be set to, none twice; at least one. They ascend; those of a phase from the lowest
  /// number of the file on, so that 170, 180 and -170 degrees follow each other.
  std::vector<std::int32_t> values;
};

/// Everything that can be chosen: the product of the dimensions' value sets (thesis, equation 3.3).
struct SearchSpace {
  std::vector<Dimension> dimensions;

  /// Number of candidates; infinite if it is beyond the range of double.
  [[nodiscard]] double size() const;
  /// Gives the scenario the candidate's values as start values. The candidate has an index below values.size() for each
  /// dimension.
  void apply(const Candidate& candidate, sim::Scenario& scenario) const;
  /// The candidate that is nearest to the scenario's own start values (of a dimension with several targets: its first).
  [[nodiscard]] Candidate nearest(const sim::Scenario& scenario) const;
  /// Shortest text of a value, without unit.
  [[nodiscard]] std::string value_text(const Candidate& candidate, std::size_t dimension) const;
  /// The number that the text says.
  [[nodiscard]] double value(const Candidate& candidate, std::size_t dimension) const;
};

}  // namespace proleg::optimize
