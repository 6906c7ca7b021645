#pragma once

// The simulated robot beside the real one: it gets the pulses of the same gait, and its joint angles are compared with
// those that the modules measure.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/record/recorder.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/robot/gait_check.hpp"

namespace proleg::tools {

class Mirror {
 public:
  /// scenario: must outlive the mirror.
  explicit Mirror(const sim::Scenario& scenario);

  /// The next tick of the gait. Before the first one the simulated joints ramp in to its first pulses, as the real ones
  /// do, so that both begin alike. Returns the sample as it is for the simulated robot: its poses, angles, torques,
  /// currents and forces. Valid until the next call. Throws PhysicsError as Plant does.
  sim::TickSample follow(const sim::TickSample& real);

  /// Hash of the motion of the simulated robot (sim/record/motion.hpp).
  [[nodiscard]] std::string motion_hash() const { return hash_.motion_hex(); }

  /// A module has measured this angle, in rad, at SYNC `tick`.
  void note_measured(std::uint32_t tick, unsigned joint, double angle);

  /// Measured minus simulated angle of a joint.
  struct Difference {
    sim::Polyline over_time;  ///< x: s since SYNC 0, y: degrees
    double root_mean_square = 0.0;
    double largest = 0.0;  ///< absolute, degrees
  };
  /// The difference of each joint; empty lines where nothing was measured.
  [[nodiscard]] std::vector<Difference> differences() const;

  /// The differences as an SVG picture.
  [[nodiscard]] std::string picture(const std::string& title, double seconds) const;

 private:
  struct Measurement {
    std::uint32_t tick;
    unsigned joint;
    double angle;
  };
  void remember_angles();
  void compare();

  const sim::Scenario& scenario_;
  sim::Plant plant_;
  sim::PulsePlayer player_;
  sim::WorldHash hash_;
  /// The newest ticks, by joint: rad, at their SYNCs. A measurement waits for its tick, and comes a few ticks after it.
  std::deque<std::vector<double>> angles_;
  std::uint32_t next_tick_ = 0;  ///< after the last of angles_
  std::deque<Measurement> waiting_;
  std::vector<sim::Polyline> lines_;  ///< by joint
};

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
  /// The results for --json.
  [[nodiscard]] Json json() const;
  /// Prints the results for people, on standard output.
  void print() const;

 private:
  std::string recording_;
  std::string title_;
  const sim::Scenario& scenario_;
  Mirror mirror_;
  std::unique_ptr<sim::Recorder> recorder_;
};

}  // namespace proleg::tools
