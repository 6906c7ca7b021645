#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/measure/measure.hpp"

namespace proleg::optimize {

/// A measure and its factor in a weighted sum.
struct Term {
  sim::Measure measure = sim::Measure::distance;
  double weight = 1.0;
};

enum class Goal : std::uint8_t { maximise, minimise };

/// What a candidate is rated by: a weighted sum of measures. An optimiser with several objectives looks for the
/// candidates of which none is better in all of them.
struct Objective {
  std::string name;         ///< unique: of columns and axes; of a single measure that measure's name
  std::vector<Term> terms;  ///< at least one
  Goal goal = Goal::maximise;
  /// Score of a candidate that has none: its run failed, or a measure is not defined. By default 0 if the goal is to
  /// maximise and 10^6 if it is to minimise.
  double failed = 0.0;

  /// The score; `failed` if it is not a finite number.
  [[nodiscard]] double score(const sim::MeasureValues& measures) const;
  /// Whether score a is better than b.
  [[nodiscard]] bool better(double a, double b) const { return goal == Goal::maximise ? a > b : a < b; }
  /// Unit of the score: that of its measure, or nothing for a sum.
  [[nodiscard]] std::string_view unit() const;
  /// The number that pagmo, which minimises, is given: the score or its negative; and back.
  [[nodiscard]] double cost(double score) const { return goal == Goal::maximise ? -score : score; }
};

}  // namespace proleg::optimize
