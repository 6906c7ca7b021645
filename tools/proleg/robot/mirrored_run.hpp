#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/robot/gait_check.hpp"
#include "tools/proleg/robot/mirror.hpp"

namespace proleg::tools {

/// The simulated robot of --mirror FILE: its recording, and the picture beside it.
class MirroredRun {
 public:
  /// scenario: must outlive this. Throws BadInput if the recording cannot be created.
  MirroredRun(const ScenarioOptions& options, const std::string& recording, const sim::Scenario& scenario);

  /// The files, for check_outputs().
  [[nodiscard]] static std::vector<PlannedOutput> planned(const ScenarioOptions& options, const std::string& recording);

  [[nodiscard]] Mirror& mirror() { return mirror_; }
  [[nodiscard]] sim::Recorder& recorder() { return *recorder_; }

  /// Writes the files. seconds: length of the run. check: of the real robot.
  void finish(double seconds, const GaitCheck& check);
  /// For --json.
  [[nodiscard]] Json json() const;
  /// For people, on standard output.
  void print() const;

 private:
  std::string recording_;
  std::string title_;
  const sim::Scenario& scenario_;
  Mirror mirror_;
  std::unique_ptr<sim::Recorder> recorder_;
};

}  // namespace proleg::tools
