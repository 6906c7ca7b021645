#pragma once

// Experiment 6.1 of the thesis, the amplitudes of a travelling wave: tables 6.2 and 6.4, figures 6.3 to 6.6 and 7.1,
// drawn from our runs and beside the thesis's numbers. The score is the distance in metres, and more is better.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/search_space.hpp"

namespace proleg::optimize {

/// What the thesis published for a method: its best ten runs, best first.
struct ThesisResult {
  std::string_view method;  ///< as method_name() says
  std::string_view table;
  unsigned runs = 0;
  std::array<std::array<double, 10>, 5> amplitudes_deg{};  ///< joint 0 at the head to joint 4 at the tail
  std::array<double, 10> displacements_m{};
};
/// Tables 6.2 (great deluge) and 6.4 (genetic algorithm).
[[nodiscard]] std::span<const ThesisResult, 2> thesis_results();
[[nodiscard]] const ThesisResult* find_thesis_result(std::string_view method);

/// Distance of 40 degrees on all joints (section 6.1, mean of 50 runs).
inline constexpr double thesis_uniform_distance_m = 1.65;

/// All repetitions of the experiment with one method.
struct MethodRuns {
  std::string method;                         ///< as method_name() says
  SearchSpace space;                          ///< of its candidates
  std::vector<std::vector<Evaluation>> runs;  ///< of each repetition its evaluations, in order
};

/// Best score so far after each evaluation of a run.
[[nodiscard]] std::vector<double> best_so_far(std::span<const Evaluation> run);

/// Over repetitions, after each evaluation until the longest one ends: one that ended keeps its last best.
struct BestCurves {
  std::vector<double> lowest;
  std::vector<double> mean;
  std::vector<double> highest;
};
[[nodiscard]] BestCurves best_curves(const MethodRuns& method);

/// Tables 6.2 and 6.4, tab-separated: the values and distances of the ten best repetitions, best first, and below them
/// the thesis's, if it has any for the method. Columns: source, value, 1 to 10.
[[nodiscard]] std::string experiment_table(const MethodRuns& method);

/// Figures 6.3 and 6.5, SVG: the best so far of every repetition. uniform_m: distance of 40 degrees on all joints here.
[[nodiscard]] std::string draw_every_run(const MethodRuns& method, double uniform_m);
/// Figures 6.4 and 6.6, SVG: lowest, mean and highest best so far over the repetitions.
[[nodiscard]] std::string draw_run_spread(const MethodRuns& method, double uniform_m);
/// Figure 7.1, SVG: (a) every repetition of every method, (b) the means.
[[nodiscard]] std::string draw_method_comparison(std::span<const MethodRuns> methods, double uniform_m);

/// Number of the last evaluation, from 1, at which the mean of `follower` is not above that of `leader`: after it, it
/// stays above. 0: it is above from the start. Nothing: it does not end above.
[[nodiscard]] std::optional<std::size_t> overtaking(const BestCurves& follower, const BestCurves& leader);
/// Number of evaluations, from 1, after which the mean is at least `score`.
[[nodiscard]] std::optional<std::size_t> evaluations_to_reach(const BestCurves& curves, double score);

/// The outcome as text for people, a few dozen lines of at most 120 characters: each method's repetitions, evaluations,
/// best, mean and gain over the uniform amplitudes; which method overtakes which; how soon others reach great deluge's
/// mean.
[[nodiscard]] std::string experiment_summary(std::span<const MethodRuns> methods, double uniform_m);

}  // namespace proleg::optimize
