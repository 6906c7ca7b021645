#pragma once

// Intelligent trial and error: a robot that is not as its map of gaits expects finds a gait that works in a few trials
// (A. Cully, J. Clune, D. Tarapore, J.-B. Mouret, "Robots that can adapt like animals", Nature 521, 2015). The map is
// the prior mean of a Gaussian process over the places of its cells; each trial corrects what is expected of the cells
// around it. Everything here is computed from the numbers that are given: no robot, no files, no random numbers.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/optimize/adaptation/gaussian_process.hpp"

namespace proleg::optimize {

/// A filled cell of the map.
struct AdaptationCell {
  std::vector<double> point;  ///< nearby points have similar values; the same number of coordinates for all cells
  double prior = 0.0;         ///< value that the map expects; the higher, the better
};

struct AdaptationSettings {
  double alpha = 0.9;         ///< the best value that ends the trials, as a share of the best that is expected; 0 to 1
  double kappa = 0.05;        ///< weight of the deviation in the choice of the next cell; not negative
  double length = 0.3;        ///< of the kernel; above 0
  double noise = 0.03;        ///< standard deviation of a trial, as a share of the deviation from the map; not negative
  std::uint32_t trials = 12;  ///< largest number of trials; at least 1
};

enum class AdaptationEnding : std::uint8_t {
  none,            ///< trials go on
  good_enough,     ///< the best value is at least alpha times the best that is expected of any cell
  trials_used_up,  ///< the largest number of trials was made
};

class Adaptation {
 public:
  struct Trial {
    std::size_t cell = 0;
    Estimate expected;   ///< before the trial
    double value = 0.0;  ///< measured
  };

  /// cells: at least one; all numbers finite. The deviation from the map is as large as the greatest absolute value of
  /// the map, so that neither kappa nor noise has a unit; 1 if all values are 0.
  Adaptation(std::vector<AdaptationCell> cells, const AdaptationSettings& settings);

  /// The cell to try next: the one with the greatest mean + kappa * deviation, of equals the first. Nothing when the
  /// trials have ended.
  [[nodiscard]] std::optional<std::size_t> next() const;
  /// Takes the value of a trial, of any cell. value: finite. One that is lower than all values of the map by more than
  /// the deviation, such as the score of a run that failed, is learned as if it were lower by just that.
  void tell(std::size_t cell, double value);

  [[nodiscard]] AdaptationEnding ending() const;
  /// What is expected of each cell after the trials so far, in the order of the cells.
  [[nodiscard]] const std::vector<Estimate>& expected() const { return expected_; }
  [[nodiscard]] const std::vector<Trial>& trials() const { return trials_; }
  /// The trial with the best value, of equals the first; null before the first trial.
  [[nodiscard]] const Trial* best() const;

 private:
  void update();

  std::vector<AdaptationCell> cells_;
  AdaptationSettings settings_;
  GaussianProcess process_;
  double lowest_;  ///< value that is learned
  std::vector<Estimate> expected_;
  std::vector<Trial> trials_;
};

/// "good enough", "trials used up"; empty while trials go on.
[[nodiscard]] std::string_view text_of(AdaptationEnding ending);

}  // namespace proleg::optimize
