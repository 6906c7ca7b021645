#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/fixed/random.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace pagmo {
class population;
}

namespace proleg::optimize {

/// The modified great deluge algorithm of the thesis (section 3.4.2) as a user-defined algorithm of pagmo, for any
/// problem with one objective and a box of finite bounds. pagmo minimises, the algorithm climbs: the level of a place
/// is the negative of its fitness.
///
///     current = start; used = 0
///     repeat:
///       radius    = step * (1 + floor(used / confidence))            or step * 2^floor(used / confidence)
///       candidate = current + radius * U in each variable, cut to the bounds
///       if level(candidate) >= water:  current = candidate; water += rain; used = 0
///       else:  used += 1
///              if used = retries:  end if credits = 0;  credits -= 1; used = 0
///
/// One is the step of a variable, which makes whole numbers of the candidates of a GaitProblem. A candidate is compared
/// with the water alone: it may be worse than the current place.
///
/// What the thesis leaves open, as it is read here:
/// - The start is evaluated, but it is no candidate: if it is below the water it uses up no retry. A search that
/// accepts
///   nothing makes 1 + retries * (credits + 1) evaluations. The search goes on around the start in either case.
/// - first_must_pass = false means that the start is accepted whatever its level is. As with every place that is
///   accepted, the water rises by `rain`.
/// - With reevaluations, a candidate that reaches the water is evaluated so many times more, and the mean is its level.
/// - Several chains take turns, one candidate each, until none has a credit left. Each has its own water, radius and
///   credits. Racing (FitnessSource::set_needed_score) goes by the lowest water of the chains that are still at it.
///
/// One call of evolve() is the whole search. The individuals of the population are the starts of the chains; those of
/// the population that is returned are the best places that the chains found.
class GreatDeluge {
 public:
  explicit GreatDeluge(const GreatDelugeSettings& settings = {}, std::uint64_t seed = 1);

  /// If the population's problem is a GaitProblem, its source is told what comes next on the assumption that candidates
  /// are accepted if most of the latest were, or are not; what was wrong is said anew. Throws std::invalid_argument for
  /// a problem that it does not know how to handle. Whatever the problem's fitness throws passes through.
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;

  void set_seed(unsigned seed) { seed_ = seed; }
  /// Whether scores may depend on the water level that the source was told (racing). Then what was foreseen for after
  /// an acceptance, which raises it, is of no use, and nothing is.
  void set_level_matters(bool matters) { level_matters_ = matters; }
  /// Above 0: evolve() keeps a log.
  void set_verbosity(unsigned level) { verbosity_ = level; }
  [[nodiscard]] std::string get_name() const { return "modified great deluge"; }
  [[nodiscard]] std::string get_extra_info() const;

  /// A start or candidate, and what the algorithm thought when it had its level.
  struct LogLine {
    std::uint32_t chain;
    std::vector<double> place;
    double level;  ///< with reevaluations: their mean, if there were any
    double water;  ///< that it was compared with
    std::uint32_t used;
    std::uint32_t credits;
    double radius;  ///< 0: a start
    bool accepted;
  };
  [[nodiscard]] const std::vector<LogLine>& get_log() const { return log_; }
  /// Why the last evolve() ended.
  [[nodiscard]] const std::string& ending() const { return ending_; }

 private:
  struct Chain;
  struct Box;
  class Voyage;

  GreatDelugeSettings settings_;
  bool level_matters_ = false;
  std::uint64_t seed_;
  unsigned verbosity_ = 0;
  // evolve() is const because pagmo wants it so.
  mutable std::vector<LogLine> log_;
  mutable std::string ending_;
};

/// The random numbers of a chain's candidate of that number, from 0. They depend on nothing else, so that a candidate
/// can be foreseen. What is drawn, in this order: for Move::one the variable; then U for each variable that moves.
[[nodiscard]] Pcg32 candidate_noise(std::uint64_t seed, std::uint32_t chain, std::uint64_t number);

/// search() for an experiment whose method is GreatDelugeSettings, with one objective and more than one candidate.
[[nodiscard]] std::string search_great_deluge(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
