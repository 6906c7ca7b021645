#pragma once

// Trials that a robot of modules makes: `proleg drive` is started for each, so that this program links none of what
// talks to modules, and the servos have no power when it has ended.

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/search/trial_score.hpp"

namespace proleg::tools {

class RobotTrials {
 public:
  /// scenario: of the robot; no trial differs in more than its parameters. objectives: their measures are needed.
  /// folder: of the run. stop: whether the user stops; called often. Throws InputError or BadInput for bad options, and
  /// for a scenario that modules cannot run.
  RobotTrials(const TrialOptions& options, const sim::Scenario& scenario,
              std::span<const optimize::Objective> objectives, const std::filesystem::path& folder,
              std::function<bool()> stop);

  /// Makes a trial, and returns when the servos have no power again. name: of its files. Throws SearchEnded if the user
  /// ends the trials, and SearchFailed if the trial has no score.
  [[nodiscard]] sim::MeasureValues make(const sim::Scenario& scenario, const std::string& name);

 private:
  [[nodiscard]] DrivenTrial drive(const sim::Scenario& scenario, const std::string& name);

  std::string bus_;
  bool is_simulated_;  ///< as fast as this computer can
  std::filesystem::path folder_;
  std::function<bool()> stop_;
  TrialScore score_;
  std::set<std::string> warnings_;  ///< of `proleg drive`; those of all trials are mostly the same
};

/// The robot of an adaptation.
class RobotOnBus final : public optimize::TrialRobot {
 public:
  /// experiment: says what the candidates mean and how a run is rated. reality: the robot, with the length of a trial.
  /// made: number of the trials that were made before. All must outlive this.
  RobotOnBus(const optimize::Experiment& experiment, const sim::Scenario& reality, RobotTrials& trials,
             std::size_t made);
  [[nodiscard]] optimize::TrialOutcome try_gait(const optimize::Candidate& candidate) override;

 private:
  const optimize::Experiment& experiment_;
  const sim::Scenario& reality_;
  RobotTrials& trials_;
  std::size_t made_;
};

/// The robot of a search: one worker, which makes one trial after the other.
class RobotWorker final : public optimize::Workers {
 public:
  /// experiment: on_robot; must outlive this.
  RobotWorker(const optimize::Experiment& experiment, RobotTrials trials);
  [[nodiscard]] std::uint32_t count() const override { return 1; }
  [[nodiscard]] std::uint32_t idle() const override { return task_ ? 0 : 1; }
  [[nodiscard]] std::size_t most_at_once() const override { return 1; }
  void start(std::span<const optimize::TicketedTask> batch) override { task_ = batch.front(); }
  /// Makes the trial of the task, however long that takes: a robot is not left in one. Throws SearchEnded.
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override { return {}; }

 private:
  const optimize::Experiment& experiment_;
  RobotTrials trials_;
  std::optional<optimize::TicketedTask> task_;
};

}  // namespace proleg::tools
