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

/// Rates a candidate: a weighted sum of measures. An optimiser with several objectives searches for the candidates that
/// no other dominates.
struct Objective {
  std::string name;         ///< unique; for columns and axes; by default the name of a single measure
  std::vector<Term> terms;  ///< at least one
  Goal goal = Goal::maximise;
  /// Score of a candidate whose run failed or lacks a measure.
  double failed = 0.0;

  /// The score of a run; `failed` if it is not a finite number.
  [[nodiscard]] double score(const sim::MeasureValues& measures) const;
  /// Whether a score can be below 0, because of a failed run, a weight below 0, or a measure with both signs.
  [[nodiscard]] bool may_be_negative() const;
  /// Whether score a is better than b.
  [[nodiscard]] bool better(double a, double b) const { return goal == Goal::maximise ? a > b : a < b; }
  /// Unit of the score: the unit of its measure; empty for a sum.
  [[nodiscard]] std::string_view unit() const;
  /// The number that pagmo minimises: the score or its negative. The same function turns a cost into the score.
  [[nodiscard]] double cost(double score) const { return goal == Goal::maximise ? -score : score; }
};

}  // namespace proleg::optimize
