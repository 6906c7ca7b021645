#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// Rates candidates for an optimiser, one after the other, and lets it say what it will probably ask for, so that
/// others can work ahead. What is expected, and whether it comes true, changes no result.
class FitnessSource {
 public:
  virtual ~FitnessSource() = default;
  /// The next candidates that fitness() will probably be asked for, in that order; replaces what was said before.
  virtual void expect(std::span<const Candidate> next) = 0;
  /// How many it is worth expecting.
  [[nodiscard]] virtual std::size_t lookahead() const = 0;
  /// The scores of a candidate, one for each objective. Throws SearchEnded when there is to be no further evaluation.
  virtual std::vector<double> fitness(const Candidate& candidate) = 0;
  /// From the next expect() or fitness() on: the score that a candidate needs to matter (racing); nothing: none.
  virtual void set_needed_score(std::optional<double> score) = 0;
};

/// Thrown through an optimiser to end it: the budget is used up, or somebody stopped the search.
class SearchEnded {};

}  // namespace proleg::optimize
