#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/fixed/random.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace pagmo {
class population;
}

namespace proleg::optimize {

/// The bounds of the variables.
struct DelugeBox {
  std::vector<double> lower;
  std::vector<double> upper;
};

/// One great deluge among several that take turns: its place, its water, and its remaining retries and credits.
struct DelugeChain {
  std::uint32_t index;
  std::vector<double> current;
  double water;
  std::uint32_t credits;
  std::uint32_t used = 0;        ///< retries since the last accepted candidate or used credit
  std::uint64_t drawn = 0;       ///< candidates so far
  double acceptance_rate = 0.0;  ///< share of the latest candidates that were accepted, 0 to 1
  bool ended = false;

  /// Draws the next candidate.
  [[nodiscard]] std::vector<double> draw(const GreatDelugeSettings& settings, std::uint64_t seed, const DelugeBox& box);

  void count_outcome(bool accepted) { acceptance_rate += 0.25 * ((accepted ? 1.0 : 0.0) - acceptance_rate); }
  void accept(const GreatDelugeSettings& settings, const std::vector<double>& place);
  void fail(const GreatDelugeSettings& settings);
};

/// Radius of the search after this number of used retries.
[[nodiscard]] std::uint32_t radius_after(const GreatDelugeSettings& settings, std::uint32_t used);

/// The random numbers of a chain's candidate; number: from 0. They depend on nothing else, so a candidate can be
/// predicted. They are drawn in this order: the variable (Move::one only); then U for each variable that moves.
[[nodiscard]] Pcg32 candidate_noise(std::uint64_t seed, std::uint32_t chain, std::uint64_t number);

/// The modified great deluge algorithm of the thesis (section 3.4.2) as a user-defined algorithm of pagmo, for any
/// problem with one objective and a box of finite bounds. pagmo minimises, this algorithm maximises: the level of a
/// place is the negative of its fitness.
///
///     current = start; used = 0
///     repeat:
///       radius    = step * (1 + floor(used / confidence))            or step * 2^floor(used / confidence)
///       candidate = current + radius * U in each variable, cut to the bounds
///       if level(candidate) >= water:  current = candidate; water += rain; used = 0
///       else:  used += 1
///              if used = retries:  end if credits = 0;  credits -= 1; used = 0
///
/// The step of a variable is 1, so the candidates of a GaitProblem are whole numbers. A candidate is compared with the
/// water only: it may be worse than the current place.
///
/// The thesis leaves some points open. This algorithm reads them as follows:
/// - The start is evaluated, but it is no candidate: if it is below the water, it uses no retry. The search continues
///   around the start in either case. A search that accepts nothing makes 1 + retries * (credits + 1) evaluations.
/// - With first_must_pass = false the start is accepted at any level. The water rises by `rain`, as with every accepted
///   place.
/// - With reevaluations, a candidate that reaches the water is evaluated that many times more. The mean is its level.
/// - Several chains take turns, one candidate each, until none has a credit left. Each has its own water, radius and
///   credits. Racing (FitnessSource::set_needed_score) uses the lowest water of the chains that have not ended.
///
/// One call of evolve() is the whole search. The individuals of the population are the starts of the chains. The
/// population that is returned holds the best place of each chain.
class GreatDeluge {
 public:
  explicit GreatDeluge(const GreatDelugeSettings& settings = {}, std::uint64_t seed = 1);

  /// If the population's problem is a GaitProblem, its source receives predictions of the next candidates. They assume
  /// that candidates are accepted if most of the latest were, and are corrected when they are wrong. Throws
  /// std::invalid_argument for several objectives, constraints or infinite bounds. Exceptions of the problem's fitness
  /// pass through.
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;

  void set_seed(unsigned seed) { seed_ = seed; }
  /// Sets whether scores may depend on the water level that the source received (racing). An acceptance raises the
  /// level, so predictions for the time after it are then useless and are left out.
  void set_scores_depend_on_level(bool depend) { scores_depend_on_level_ = depend; }
  /// Sets the verbosity; above 0, evolve() keeps a log.
  void set_verbosity(unsigned level) { verbosity_ = level; }
  [[nodiscard]] std::string get_name() const { return "modified great deluge"; }
  [[nodiscard]] std::string get_extra_info() const;

  /// A start or candidate, and the state of its chain when its level was known.
  struct LogLine {
    std::uint32_t chain;
    std::vector<double> place;
    double level;  ///< mean of the evaluations, if there were reevaluations
    double water;  ///< water that the level was compared with
    std::uint32_t used;
    std::uint32_t credits;
    double radius;  ///< radius of the draw; 0: this is a start
    bool accepted;
  };
  [[nodiscard]] const std::vector<LogLine>& get_log() const { return log_; }
  /// Reason why the last evolve() ended.
  [[nodiscard]] const std::string& ending() const { return ending_; }

 private:
  class DelugeSearch;

  GreatDelugeSettings settings_;
  bool scores_depend_on_level_ = false;
  std::uint64_t seed_;
  unsigned verbosity_ = 0;
  // These are mutable because pagmo requires a const evolve().
  mutable std::vector<LogLine> log_;
  mutable std::string ending_;
};

/// Implements search() for an experiment whose method is GreatDelugeSettings, with one objective and more than one
/// candidate. It returns "no credit left" or "target reached".
[[nodiscard]] std::string search_great_deluge(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
