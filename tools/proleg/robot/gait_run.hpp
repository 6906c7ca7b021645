#pragma once

// A gait on the modules of a robot: the master that drives them, what watches the joints, and the comparison with the
// gait of this computer. Whoever has one lets time pass on the bus.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/gait_watch.hpp"
#include "host/robot/response_times.hpp"
#include "host/robot/robot_drive.hpp"
#include "shared/computer/change/change.hpp"
#include "sim/hardware_loop/master_input.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/robot/gait_check.hpp"

namespace proleg::tools {

/// The changes of a run, in the form that the master takes: those of the scenario, and those that the user adds while
/// the robot moves. The master makes changes in the order in which it gets them. It therefore gets a change with a tick
/// a while before this tick, so that one without a tick does not wait for it until then.
class LiveChanges {
 public:
  /// The master gets a change this long before its tick: more than a connection that loses frames needs.
  static constexpr std::uint32_t lead_us = 3'000'000;

  /// scenario: must outlive this. planned: its changes, by ascending tick. span() has the first of them.
  LiveChanges(const sim::Scenario& scenario, std::vector<Change> planned);
  LiveChanges(const LiveChanges&) = delete;
  LiveChanges& operator=(const LiveChanges&) = delete;

  /// A word as for --set; without a tick the change takes effect as soon as all modules have it. now: present tick;
  /// end: the first one that is not part of the run. Throws InputError. True: the master must get the new span() now.
  bool add(const std::string& word, std::uint32_t now, std::uint32_t end);
  /// Values that take effect together, as soon as all modules have them. The master must get the new span() now.
  void add(const std::vector<Setting>& settings);
  /// Puts the next planned change behind span(), if it is time. True: the master must get the new span() now.
  bool release(std::uint32_t now);
  /// The master has refused the last one of span().
  void remove_last();
  /// What the master has, or must get.
  [[nodiscard]] std::span<Change> span() { return changes_; }

  /// The changes for this tick and earlier ones that have not been taken and that the master did not drop.
  [[nodiscard]] std::vector<Change> take_decided(std::uint32_t tick);
  /// Changes that the master has dropped, or never got in time.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Changes without a tick that were added and have not been taken, nor dropped: the run has ended before.
  [[nodiscard]] std::uint64_t unfinished() const;

 private:
  const sim::Scenario& scenario_;
  std::uint32_t lead_ticks_;
  std::vector<Change> planned_;  ///< by ascending tick; the master does not have them yet
  std::vector<Change> changes_;
  std::vector<std::size_t> without_tick_;  ///< positions in changes_ of those that were added
  std::size_t taken_ = 0;
  std::uint64_t too_late_ = 0;  ///< planned changes that the master never got
};

/// Gives the scenario the shortest period of real servos if its own is shorter and real servos can be at the bus.
/// Everything that drives a robot calls this before it makes a GaitRun, a recorder or a mirror. Returns a line for the
/// user if the period is another one now.
[[nodiscard]] std::optional<std::string> fit_servo_period(sim::Scenario& scenario, const std::string& bus_address);

struct GaitRunOptions {
  std::uint32_t end_tick;  ///< the first one that is not part of the run
  bool holds = false;      ///< the joints stay where they are, as MasterOptions says
};

class GaitRun {
 public:
  /// scenario, bus: must outlive this.
  GaitRun(const sim::Scenario& scenario, host::BusConnection& bus, const GaitRunOptions& options);
  GaitRun(const GaitRun&) = delete;
  GaitRun& operator=(const GaitRun&) = delete;

  /// Sets the modules up and gives the servos power. Then state() is `running`, or has_ended().
  void start() { drive_.master().start(bus_.now()); }
  /// Watches from now on whether the joints follow.
  void watch() { watch_.start(bus_.now()); }
  [[nodiscard]] canopen::MasterState state() const { return drive_.master().state(); }
  /// The start has failed, the connection is lost, or a joint does not follow any more.
  [[nodiscard]] bool has_ended() const;
  /// The reason of the end in one line.
  [[nodiscard]] std::string why_ended() const;
  /// Whether it has ended because the robot of the scenario cannot be driven, whatever is on the bus.
  [[nodiscard]] bool has_bad_setup() const;

  /// What the modules have reported since the last call, in lines. is_verbose: also the end of an error.
  void report_events(bool is_verbose, const std::function<void(const std::string& line)>& report);

  /// Nodes whose modules have restarted and take part again, since the last call.
  [[nodiscard]] std::vector<std::uint8_t> take_rejoined() { return std::exchange(rejoined_, {}); }

  struct Observer {
    /// The last tick of check(), and the change that took effect at it, or null. Not called while the robot stops.
    std::function<void(const Change* change)> tick;
    std::function<void(const host::Measurement& measurement)> measured = [](const host::Measurement&) {};
    /// A change that the master has made.
    std::function<void(const Change& change)> changed = [](const Change&) {};
  };
  /// The ticks whose frames have come. at_end: no more frames come. What an observer throws goes through, and then
  /// nothing is followed any more.
  void take_ticks(bool at_end, const Observer& observer);

  /// A change as for --set while the robot moves. Throws InputError.
  void add_change(const std::string& word);
  /// Values that take effect together, as soon as all modules have them. Throws InputError.
  void add_change(const std::vector<Setting>& settings);
  /// The changes of the scenario whose time has come.
  void release_changes();
  [[nodiscard]] const LiveChanges& changes() const { return changes_; }
  /// Whether the master has nothing to change but what waits for its tick.
  [[nodiscard]] bool has_made_changes() { return drive_.master().changes_made() == changes_.span().size(); }

  /// Begins to ramp down and to take the power from the servos.
  void stop();
  /// Whether that is done, or its time is over: 20 s, 2 s without a connection.
  [[nodiscard]] bool has_stopped();
  /// Since stop(): whether all modules have confirmed that their servos have no power.
  [[nodiscard]] bool are_all_off() const { return are_all_off_ && state() == canopen::MasterState::stopped; }
  /// Compares all bits of the set-points. To be called after stop().
  void compare_setpoints();

  [[nodiscard]] host::RobotDrive& drive() { return drive_; }
  [[nodiscard]] const host::RobotDrive& drive() const { return drive_; }
  [[nodiscard]] host::GaitWatch& gait_watch() { return watch_; }
  [[nodiscard]] const host::GaitWatch& gait_watch() const { return watch_; }
  [[nodiscard]] GaitCheck& check() { return check_; }
  [[nodiscard]] const GaitCheck& check() const { return check_; }
  [[nodiscard]] const Durations& answers_us() const { return answer_times_.microseconds(); }
  [[nodiscard]] const host::ChangeTimes& change_times() const { return change_times_; }

 private:
  static constexpr std::uint16_t ramp_in_speed = 90;  // degrees a second, as in a quick stop

  [[nodiscard]] canopen::MasterOptions master_options(bool holds) const;
  [[nodiscard]] std::string name_of(std::uint8_t node) const { return sim::name_of_node(scenario_, node); }
  [[nodiscard]] std::string text_of(const host::GaitWatch::Loss& loss) const;
  void give_new_change(const std::string& what);
  void give_changes(const std::string& what);

  const sim::Scenario& scenario_;
  host::BusConnection& bus_;
  sim::MasterInput input_;
  LiveChanges changes_;
  host::RobotDrive drive_;
  host::AnswerTimes answer_times_;
  host::ChangeTimes change_times_;
  host::GaitWatch watch_;
  host::BusAttachment answer_times_attachment_;  ///< before the master: it answers an answer with the next request
  host::BusAttachment change_times_attachment_;
  host::BusAttachment drive_attachment_;
  host::BusAttachment watch_attachment_;
  GaitCheck check_;
  std::vector<std::uint8_t> rejoined_;
  bool is_following_ = true;  ///< no observer has failed
  bool are_all_off_ = true;   ///< since stop()
  Microseconds stops_by_ = 0;
  std::uint32_t end_tick_;
};

}  // namespace proleg::tools
