#pragma once

// The robot that makes the trials of an adaptation: any one, and one that is simulated.

#include <functional>
#include <string>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

struct TrialOutcome {
  double score = 0.0;   ///< of the objective, finite; that of a run that fails if this one did
  std::string failure;  ///< why the trial has no score of its own; empty: it has one
};

/// The outcome of a run with these measures.
[[nodiscard]] TrialOutcome outcome_of(const Objective& objective, const sim::MeasureValues& measures);

/// A robot that can try gaits: simulated, or real.
class TrialRobot {
 public:
  virtual ~TrialRobot() = default;
  /// Starts at rest, plays the gait for the length of a trial, and measures. A trial that fails is an outcome. Throws
  /// SearchEnded when the user stops it, and what ends all trials (a robot that does not answer).
  [[nodiscard]] virtual TrialOutcome try_gait(const Candidate& candidate) = 0;
};

class SimulatedRobot final : public TrialRobot {
 public:
  /// experiment: says what the candidates mean and how a run is rated. reality: the robot and its world, with its
  /// damages and the length of a trial. losses: state frames that its joints do not receive. stop: called often.
  SimulatedRobot(const Experiment& experiment, sim::Scenario reality, sim::Losses losses, std::function<bool()> stop);
  [[nodiscard]] TrialOutcome try_gait(const Candidate& candidate) override;

 private:
  const Experiment& experiment_;
  sim::Scenario reality_;
  sim::Losses losses_;
  std::function<bool()> stop_;
};

}  // namespace proleg::optimize
