#pragma once

// Intelligent trial and error: a robot that is not as its map of gaits expects finds a gait that works in a few trials
// (A. Cully, J. Clune, D. Tarapore, J.-B. Mouret, "Robots that can adapt like animals", Nature 521, 2015). The map is
// the prior mean of a Gaussian process over the gaits; each trial corrects what is expected of similar gaits. There may
// be several maps: what the gaits do on the intact robot, and with each damage that it may have. The trials tell which
// of them is true (R. Pautrat, K. Chatzilygeroudis, J.-B. Mouret, "Bayesian optimization with automatic prior selection
// for data-efficient direct policy search", ICRA 2018). That paper takes the most likely map; here all count, with
// their probabilities (J. A. Hoeting et al., "Bayesian model averaging: a tutorial", Statistical Science 14, 1999).
// Everything here is computed from the numbers that are given: no robot, no files, no random numbers.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/optimize/adaptation/gaussian_process.hpp"

namespace proleg::optimize {

/// What may be true of the robot.
struct Hypothesis {
  std::vector<double> values;  ///< what is then expected of each gait; the higher, the better
  double deviation = 1.0;      ///< of the robot's values from these, as a share of the scale; above 0
  double probability = 1.0;    ///< before the first trial, beside those of the others; above 0
};

struct AdaptationSettings {
  double alpha = 0.9;         ///< the best value that ends the trials, as a share of the best that is expected; 0 to 1
  double kappa = 1.0;         ///< weight of the deviation in what a gait promises; not negative
  double length = 0.3;        ///< of the kernel; above 0
  double noise = 0.03;        ///< standard deviation of a trial, as a share of the scale; not negative
  std::uint32_t trials = 12;  ///< largest number of trials; at least 1
};

enum class AdaptationEnding : std::uint8_t {
  none,            ///< trials go on
  good_enough,     ///< the best value is at least alpha times the most that any gait promises that was not tried
  trials_used_up,  ///< the largest number of trials was made
  all_tried,       ///< each gait was
};

class Adaptation {
 public:
  struct Trial {
    std::size_t gait = 0;
    Estimate expected;   ///< before the trial
    double value = 0.0;  ///< measured
  };

  /// points: one for each gait, at least one; gaits with nearby points have similar values. All have the same number of
  /// coordinates. hypotheses: at least one. All numbers are finite. The scale is the absolute value of the best
  /// gait by the first hypothesis, so that settings and deviations have no unit; 1 if that is 0.
  Adaptation(std::vector<std::vector<double>> points, std::vector<Hypothesis> hypotheses,
             const AdaptationSettings& settings);

  /// The gait to try next: of those that were not tried the one that promises most, of equals the first. A gait
  /// promises its mean + kappa * deviation. Nothing when the trials have ended.
  [[nodiscard]] std::optional<std::size_t> next() const;
  /// Takes the value of a trial, of any gait. value: finite. One that is lower than all values of the first hypothesis
  /// by more than the scale, such as the score of a run that failed, is learned as if it were lower by just that; the
  /// values of hypotheses, too.
  void tell(std::size_t gait, double value);

  [[nodiscard]] AdaptationEnding ending() const;
  /// What is expected of each gait after the trials so far: mean and deviation over all hypotheses.
  [[nodiscard]] const std::vector<Estimate>& expected() const { return expected_; }
  /// Of each hypothesis after the trials so far; the sum is 1.
  [[nodiscard]] const std::vector<double>& probabilities() const { return probabilities_; }
  [[nodiscard]] const std::vector<Trial>& trials() const { return trials_; }
  /// The trial with the best value, of equals the first; null before the first trial.
  [[nodiscard]] const Trial* best() const;

 private:
  void update();
  [[nodiscard]] double promise(std::size_t gait) const;
  [[nodiscard]] std::optional<std::size_t> most_promising() const;

  std::vector<std::vector<double>> points_;
  std::vector<Hypothesis> hypotheses_;
  AdaptationSettings settings_;
  double lowest_;                           ///< value that is learned
  std::vector<GaussianProcess> processes_;  ///< one for each hypothesis
  std::vector<double> probabilities_;
  std::vector<Estimate> expected_;
  std::vector<Trial> trials_;
};

/// "good enough", "trials used up", "all gaits tried"; empty while trials go on.
[[nodiscard]] std::string_view text_of(AdaptationEnding ending);

}  // namespace proleg::optimize
