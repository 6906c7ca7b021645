#pragma once

// A robot of modules that a program drives.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/robot/bus_scan.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/robot/bus_access.hpp"
#include "tools/proleg/robot/gait_run.hpp"

namespace proleg::python {

/// Ticks of a robot, one after the other.
struct RobotTicks {
  std::uint32_t first = 0;
  std::vector<std::int32_t> setpoints;  ///< of all joints, tick by tick: 90 degrees = 2^30
  std::vector<double> angles;           ///< degrees at the end of the tick; NaN where nothing was measured
  std::vector<double> currents;         ///< mA, the same
  std::string setpoint_hash;            ///< of all ticks from 0 to the last of these
  std::uint64_t differences = 0;  ///< state frames of modules, up to now, that differ from the gait of this computer
  std::uint64_t missing = 0;      ///< state frames, up to now, that this computer did not receive
};

/// What `proleg drive` does, in a thread of its own: a robot that moves needs a host at every moment. It stops with
/// this object: the joints ramp down, and the servos lose their power.
class DrivenRobot {
 public:
  /// Opens the bus; nothing is sent. record: file of a recording; check_outputs() has accepted it. idle_s: how long the
  /// robot moves on after the last call, or after the ticks that it asked for; nothing: without limit. Throws
  /// InputError, TransportError.
  DrivenRobot(const tools::BusOptions& bus, sim::Scenario scenario, const std::optional<std::string>& record,
              std::optional<double> idle_s);
  ~DrivenRobot();  ///< as stop()
  DrivenRobot(const DrivenRobot&) = delete;
  DrivenRobot& operator=(const DrivenRobot&) = delete;

  /// The modules on the bus. Only before start(). Throws std::runtime_error. It takes a second, or longer on a bad bus.
  [[nodiscard]] std::vector<host::ScannedNode> scan();
  /// Sets a start value, as --set does. Only before start(). Throws InputError.
  void set(const std::string& word);
  /// Begins to set the modules up, to give the servos power and to move. Throws BadInput if the recording cannot be
  /// created.
  void start();
  [[nodiscard]] bool has_started() const { return thread_.joinable(); }
  /// Changes parameters while the robot moves, as soon as all modules have the values. word: as of --set. The return
  /// value of is_changed() says when this was accepted.
  void change(const std::string& word);
  /// Whether the change was accepted, within the time. Throws InputError for a word that cannot be used.
  [[nodiscard]] bool is_changed(std::chrono::milliseconds timeout);
  /// Begins a call for the next `count` ticks, until which the robot moves. Throws what has ended the motion.
  void begin_call(std::uint32_t count);
  /// From now on the program is idle.
  void end_call();
  /// Whether the robot has made the next `count` ticks, or does not move any more, within the time.
  [[nodiscard]] bool wait_for(std::uint32_t count, std::chrono::milliseconds timeout);
  /// These ticks. Throws what ended the motion before them.
  [[nodiscard]] RobotTicks take(std::uint32_t count);

  /// Ramps down, takes the power from the servos and closes the bus. It may be called again. It takes a second; twenty
  /// if no module answers. Returns what went wrong, in one line; empty: all servos have no power.
  std::string stop();

  [[nodiscard]] const sim::Scenario& scenario() const { return scenario_; }
  /// What modules have reported since the last call, one line each.
  [[nodiscard]] std::vector<std::string> take_reports();

 private:
  /// What is known of a tick.
  struct Tick {
    std::vector<std::int32_t> setpoints;
    std::vector<double> angles;
    std::vector<double> currents;
    std::string hash;
  };

  void run();
  void drive(tools::GaitRun& gait, host::BusConnection& bus);
  void set_up(tools::GaitRun& gait, host::BusConnection& bus);
  void ramp_down(tools::GaitRun& gait, host::BusConnection& bus);
  void take_ticks(tools::GaitRun& gait, bool at_end);
  void take_changes(tools::GaitRun& gait);
  void report(tools::GaitRun& gait);
  void note(const host::Measurement& measured);
  void require_call();
  /// Ticks that the robot has made.
  [[nodiscard]] std::uint32_t made() const { return first_ + static_cast<std::uint32_t>(ticks_.size()); }

  sim::Scenario scenario_;
  std::optional<std::string> record_;
  std::optional<double> idle_s_;
  std::mutex scan_mutex_;  ///< while it is locked, the bus is not closed
  std::unique_ptr<tools::BusAccess> bus_;
  std::unique_ptr<sim::Recorder> recorder_;
  std::atomic<bool> stops_ = false;

  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::deque<Tick> ticks_;   ///< that were not taken
  std::uint32_t first_ = 0;  ///< number of the first of them
  std::uint32_t asked_ = 0;  ///< ticks that calls have asked for, and all that were made until the last call
  std::uint64_t differences_ = 0;
  std::uint64_t missing_ = 0;
  bool moves_ = true;  ///< or will
  std::exception_ptr failure_;
  std::string not_off_;
  std::vector<std::string> reports_;
  std::optional<std::string> word_;  ///< a change that was not looked at
  std::exception_ptr refusal_;       ///< of the last one

  std::thread thread_;
};

}  // namespace proleg::python
