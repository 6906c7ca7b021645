#pragma once

// Experiment 6.1 of the thesis, the amplitudes of a travelling wave: tables 6.2 and 6.4, figures 6.3 to 6.6 and 7.1,
// made from our runs, with the thesis's numbers beside them. The score is the distance in metres, and more is better.
// Tables have the judged distances, if there are any; the figures show the courses of the searches.

#include <span>
#include <string>
#include <vector>

#include "sim/optimize/report/best_curves.hpp"

namespace proleg::optimize {

/// Tables 6.2 and 6.4, tab-separated: the values and distances of the ten best repetitions, best first, and below them
/// the thesis's, if it has a table for the method. Columns: source, value, 1 to 10.
[[nodiscard]] std::string experiment_table(const MethodRuns& method);

/// Figures 6.3 and 6.5, SVG: the best so far of every repetition. uniform_m: distance of 40 degrees on all joints here.
[[nodiscard]] std::string draw_every_run(const MethodRuns& method, double uniform_m);
/// Figures 6.4 and 6.6, SVG: lowest, mean and highest best so far over the repetitions.
[[nodiscard]] std::string draw_run_spread(const MethodRuns& method, double uniform_m);
/// Figure 7.1, SVG: (a) every repetition of every method, (b) the means.
[[nodiscard]] std::string draw_method_comparison(std::span<const MethodRuns> methods, double uniform_m);

/// A summary for people, a few dozen lines of at most 120 characters: each method's repetitions, evaluations, best,
/// mean and gain over the uniform amplitudes; whether the methods differ; whether great deluge overtakes the genetic
/// algorithm; after how many evaluations other methods reach great deluge's mean.
[[nodiscard]] std::string experiment_summary(std::span<const MethodRuns> methods, double uniform_m);

/// Of two methods: whether the best distances of their repetitions differ.
struct MethodDifference {
  std::string one;
  std::string other;
  double share_above = 0.0;  ///< of the pairs of repetitions, those in which `one` goes farther
  double p_value = 1.0;      ///< of the rank-sum test, corrected for the number of pairs of methods
};

/// All pairs of methods that have runs, in their order.
[[nodiscard]] std::vector<MethodDifference> method_differences(std::span<const MethodRuns> methods);

}  // namespace proleg::optimize
