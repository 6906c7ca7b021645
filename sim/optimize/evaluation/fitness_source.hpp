#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// Rates candidates for an optimiser, one after the other. The optimiser can announce the next candidates, so that
/// workers can simulate ahead. Announcements, right or wrong, change no result.
class FitnessSource {
 public:
  virtual ~FitnessSource() = default;
  /// Announces the next candidates that will probably be asked for, in that order; replaces earlier announcements.
  virtual void expect(std::span<const Candidate> next) = 0;
  /// Number of candidates that are worth announcing.
  [[nodiscard]] virtual std::size_t lookahead() const = 0;
  /// The scores of a candidate, one for each objective. Throws SearchEnded when the search must end.
  virtual std::vector<double> fitness(const Candidate& candidate) = 0;
  /// Sets the score that a candidate needs to be of use (racing), from the next expect() or fitness() on; nothing:
  /// none.
  virtual void set_needed_score(std::optional<double> score) = 0;
  /// Says that the search starts again from another population, with the next candidate. Reports mark it.
  virtual void mark_restart() {}
};

/// Thrown through an optimiser to end it: the budget is used up, or the search was stopped.
class SearchEnded {};

/// The same for a search that cannot go on.
class SearchFailed : public SearchEnded {
 public:
  explicit SearchFailed(std::string reason) : reason_(std::move(reason)) {}
  /// One line: "trial_1 has no score: ...".
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::string reason_;
};

}  // namespace proleg::optimize
