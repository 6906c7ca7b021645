#pragma once

// A recorded simulation that is computed again, to go on from one of its ticks.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/record/recorder.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/losses.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// What was done to a run.
struct RunInputs {
  std::vector<Setting> start;         ///< values of parameters at tick 0
  std::vector<Change> changes;        ///< by ascending tick
  std::vector<sim::RobotMove> moves;  ///< by ascending tick
};

class RepeatedRun {
 public:
  /// The run up to, including, this tick: what was done to it later is left out. Throws InputError if it cannot be
  /// computed again, and as Recording does.
  RepeatedRun(const std::filesystem::path& path, std::uint32_t last_tick);

  /// The scenario of the recorded files, with the options that the run was started with.
  [[nodiscard]] const sim::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const RunInputs& inputs() const { return inputs_; }
  /// Frames that were lost, to the end of the recording.
  [[nodiscard]] const sim::Losses& losses() const { return losses_; }
  [[nodiscard]] std::uint32_t last_tick() const { return last_tick_; }
  [[nodiscard]] std::string name() const { return recording_->path().filename().string(); }
  /// The command that simulates the same scenario from the same files, without inputs().
  [[nodiscard]] std::string command() const;

  /// Compares a tick that was computed with the recorded one, bit for bit. Ticks must ascend from 0, without gaps.
  /// Throws as Recording does.
  void check(const sim::TickSample& sample);
  [[nodiscard]] bool has_differences() const { return first_difference_.has_value(); }
  /// One line: whether the ticks that were checked are the recorded ones, and what was left out.
  [[nodiscard]] std::string verdict() const;

 private:
  /// The parts of a recorded tick that would differ first.
  struct Expected {
    std::vector<std::int32_t> setpoints;
    std::vector<sim::Pose> links;
    std::vector<sim::Pose> objects;
  };

  void require_simulation() const;
  void read_inputs();
  void read_losses();
  void add_change(const sim::RecordedSetting& recorded, bool internal);
  [[nodiscard]] Setting resolve(const sim::RecordedSetting& recorded, bool internal) const;
  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const;

  std::unique_ptr<sim::Recording> recording_;
  std::uint32_t last_tick_;
  sim::OverrideWords overrides_;
  sim::Scenario scenario_;
  RunInputs inputs_;
  std::size_t left_out_ = 0;  ///< changes and moves after the last tick
  sim::Losses losses_;
  std::vector<Expected> expected_;  ///< of the next ticks
  std::uint32_t expected_from_ = 0;
  std::optional<std::uint32_t> first_difference_;
  std::optional<sim::MotionDifference> moved_;  ///< in that tick
};

}  // namespace proleg::tools
