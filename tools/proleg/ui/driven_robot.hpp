#pragma once

// A robot whose servos have power: its joints follow the gait, or hold positions that a person gives.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/sdo_queue.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/robot/gait_run.hpp"
#include "tools/proleg/ui/ghost.hpp"

namespace proleg::tools {

/// Where joints with direct positions are sent: each goes from where it is to its goal, at limited speed. Angles: 90
/// degrees = 2^30.
class JointTargets {
 public:
  /// limits: of each joint. tick_us: microseconds from one step to the next.
  JointTargets(std::span<const AngleLimits> limits, std::uint32_t tick_us);

  /// The joint is here, and stays.
  void place(unsigned joint, std::int32_t position);
  /// The joint goes there, or to its limit, with this speed in degrees a second, above 0.
  void go_to(unsigned joint, std::int32_t goal, double speed);
  /// All joints stay where they are.
  void halt();
  /// One tick on.
  void advance();

  [[nodiscard]] std::span<const std::int32_t> positions() const { return positions_; }
  /// Joints whose positions have changed since they were taken, at most this many. Every joint gets its turn.
  [[nodiscard]] std::vector<unsigned> take_moved(std::size_t at_most);

 private:
  struct Joint {
    std::int32_t lower;
    std::int32_t upper;
    std::int32_t goal = 0;
    std::int64_t step = 0;  ///< of a tick
    bool has_moved = false;
  };

  std::vector<Joint> joints_;
  std::vector<std::int32_t> positions_;
  std::uint32_t tick_us_;
  std::size_t turn_ = 0;  ///< the joint that take_moved() looks at first
};

/// A robot whose servos have power.
class DrivenRobot {
 public:
  enum class State : std::uint8_t {
    starting,  ///< modules are set up, servos get power
    held,      ///< direct positions
    joining,   ///< as held: joints go to where the gait is
    running,   ///< joints follow the gait
    stopping,  ///< joints ramp to the safe pose, then servos lose their power
    stopped,
  };
  /// What it reports, while poll() is called.
  struct Listener {
    /// A tick is over. simulated_angles: rad, empty without a simulation beside the robot. measured: of each joint
    /// whether its angle is measured.
    std::function<void(const sim::TickSample& sample, std::span<const double> simulated_angles,
                       const std::vector<bool>& measured)>
        tick;
    /// A change has become part of the gait.
    std::function<void(const Change& change)> changed;
    /// Reports one line for people. is_error: the robot does not do what it should.
    std::function<void(const std::string& line, bool is_error)> report;
  };

  /// scenario, bus: must outlive this. holds: the joints stay where they are, until follow_gait(); else they follow the
  /// gait from tick 0 on, and recorder (or null) gets it.
  DrivenRobot(const sim::Scenario& scenario, host::BusConnection& bus, bool holds,
              std::unique_ptr<sim::Recorder> recorder, Listener listener);
  DrivenRobot(const DrivenRobot&) = delete;
  DrivenRobot& operator=(const DrivenRobot&) = delete;

  /// Called after time has passed on the bus.
  void poll();
  [[nodiscard]] State state() const { return state_; }
  /// Why it stops by itself.
  [[nodiscard]] const std::optional<std::string>& failure() const { return failure_; }

  /// While held: these joints go to these angles (90 degrees = 2^30), or to their limits. speed: degrees a second.
  struct Goal {
    unsigned joint;
    std::int32_t angle;
  };
  void go_to(const std::vector<Goal>& goals, double speed);
  /// While held. The joints go to where the gait is, with limited speed.
  void follow_gait();
  /// While running or joining. The joints stay where they are; held when all modules have confirmed it. Ends the
  /// recording.
  void hold();
  /// Ramps down and takes the power. In any state.
  void stop();
  /// Stops, and asks every module at once to confirm its quick stop: `confirmed` is called for each that does.
  void quick_stop(const std::function<void(unsigned joint)>& confirmed);

  /// Values for the modules, which take effect together, while has_room_for_changes(). At most max_staged_values of a
  /// joint. Throws InputError.
  void change(const std::vector<Setting>& settings) { gait_.add_change(settings); }
  /// Whether the modules have all changes that they were given.
  [[nodiscard]] bool has_room_for_changes();
  /// Changes that had no effect.
  [[nodiscard]] std::uint64_t dropped_changes() const { return gait_.changes().dropped(); }

  [[nodiscard]] const GaitRun& gait() const { return gait_; }
  [[nodiscard]] bool is_recording() const { return recorder_ != nullptr; }
  /// Whether all modules have confirmed that their servos have no power. When stopped.
  [[nodiscard]] bool are_all_off() const { return gait_.are_all_off(); }

 private:
  [[nodiscard]] std::uint8_t node(unsigned joint) const { return scenario_.modules[joint].node; }
  [[nodiscard]] bool has_power() const { return state_ != State::stopping && state_ != State::stopped; }
  void on_started();
  void place_where_it_holds(unsigned joint);
  void on_tick(const Change* change);
  void move_targets();
  void set_mode(std::int8_t mode);
  void read_target(unsigned joint);
  void on_mode_answer(const host::SdoResult& result);
  void record(const sim::TickSample& sample, const Change* change);
  void end_recording();
  void fail(const std::string& why);

  const sim::Scenario& scenario_;
  host::BusConnection& bus_;
  bool holds_;
  std::unique_ptr<sim::Recorder> recorder_;
  Listener listener_;
  GaitRun gait_;
  host::SdoQueue requests_;  ///< modes and quick stops
  host::BusAttachment requests_attachment_;
  JointTargets targets_;
  Ghost ghost_;
  State state_ = State::starting;
  std::optional<std::int8_t> mode_on_the_way_;
  unsigned modes_asked_for_ = 0;  ///< requests without an answer yet
  bool is_in_gait_mode_ = true;   ///< the modules' drives are
  unsigned ticks_of_joining_ = 0;
  bool mode_failed_ = false;
  std::optional<std::string> failure_;
  std::vector<sim::ServoPulse> pulses_;
  std::vector<std::int32_t> commands_;
};

}  // namespace proleg::tools
