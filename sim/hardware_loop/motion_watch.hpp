#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/canopen/messages.hpp"
#include "shared/canopen/power_state.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/joint_module.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What the servo of a joint does.
enum class JointState : std::uint8_t {
  limp,       ///< no pulses
  operation,  ///< follows its set-point
  stopping,   ///< on its way to the safe pose
  hold,       ///< holds the safe pose: the quick stop is over
};
[[nodiscard]] const char* describe(JointState state);

/// What a module did: its servo changed its state, or the module sent a message.
struct ModuleEvent {
  double time_s;  ///< after SYNC 0
  unsigned joint;
  std::string text;
};

/// How a run with faults ended for a joint.
enum class JointEnd : std::uint8_t {
  operation,
  hold,
  limp,    ///< no pulses, but its module sends heartbeats
  silent,  ///< no pulses, and no frame of its module for a second and a half
  unsafe,  ///< anything else; a violation says what
};
[[nodiscard]] const char* describe(JointEnd end);

/// Checks the rules of docs/safety.md from outside of the modules, by their pulses and the frames on the bus:
/// - a pulse is within the joint's limits (but one in which the chip loses its power or its clock);
/// - no pulse differs from the one that was requested before by more than the greatest speed allows in a servo period,
///   and pulses that come too often do not add up to a higher speed;
/// - there are no pulses but in Operation enabled and Quick stop active;
/// - no pulse changes later than 1.5 s after the module's last tick, and after the host's last heartbeat;
/// - at the end, each servo follows the gait, holds the safe pose, or is limp.
class MotionWatch {
 public:
  /// scenario: must outlive this.
  explicit MotionWatch(const Scenario& scenario);

  /// SYNC 0: times of events count from here.
  void start(BusTime now) { start_ = now; }
  void note_pulse(unsigned joint, const JointModule::WatchedPulse& pulse);
  /// A frame has ended on the bus.
  void note_frame(const Transmission& transmission);
  /// A module at the end of a tick of the loop.
  struct ModuleNow {
    bool has_computed;  ///< a tick, since the end of the last one
    bool gives_pulses;
    canopen::PowerState power;
  };
  void note_tick(unsigned joint, BusTime now, const ModuleNow& module);
  /// Ends the watch with the run.
  void finish(BusTime now);

  [[nodiscard]] const std::vector<ModuleEvent>& events() const { return events_; }
  /// How the run ended for each joint, by joint; known after finish().
  [[nodiscard]] const std::vector<JointEnd>& ends() const { return ends_; }
  /// Rules that were broken, each with time and joint; at most 20.
  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
  /// What is nearest to a bound, of all joints.
  struct Worst {
    /// Greatest change between successive pulses, in multiples of what the greatest speed allows in a servo period.
    double change_steps = 0.0;
    double beyond_limit_deg = -1e9;       ///< of a pulse beyond the joint's limits; negative: within
    double motion_after_command_s = 0.0;  ///< from the last tick or heartbeat of the host to the last change of a pulse
  };
  [[nodiscard]] const Worst& worst() const { return worst_; }

 private:
  struct Joint {
    std::uint8_t node = 0;
    std::int32_t lower = 0;  ///< pulse widths
    std::int32_t upper = 0;
    std::int32_t safe = 0;
    std::optional<BusTime> last_pulse;
    std::int32_t width = 0;
    /// Bounds of the present train of pulses: the least and greatest of width minus and plus what the speed allows by
    /// then.
    double least_rising = 0.0;
    double greatest_falling = 0.0;
    BusTime train_begin = 0;
    std::optional<BusTime> last_motion;  ///< a pulse that differed from the one before, in this tick of the loop
    BusTime last_tick = 0;               ///< the last tick that the module computed
    BusTime last_heard = 0;
    JointState state = JointState::limp;
    std::optional<canopen::NmtState> nmt;
  };

  void check_change(unsigned joint, const JointModule::WatchedPulse& pulse);
  void check_command(unsigned joint, BusTime begin);
  void set_state(unsigned joint, BusTime now, JointState state);
  [[nodiscard]] bool follows_pulses(const Joint& joint, const JointModule::WatchedPulse& pulse) const;
  void add_event(unsigned joint, BusTime now, std::string text);
  void violate(unsigned joint, BusTime now, const std::string& text);
  [[nodiscard]] double seconds(BusTime now) const {
    return (static_cast<double>(now) - static_cast<double>(start_)) * 1e-9;
  }

  const Scenario& scenario_;
  std::vector<Joint> joints_;
  BusTime period_;
  double max_change_;     ///< counts
  double counts_per_ns_;  ///< of the greatest speed, with what the guard and a crystal add
  BusTime start_ = 0;
  BusTime host_heard_ = 0;
  std::vector<ModuleEvent> events_;
  std::vector<JointEnd> ends_;
  std::vector<std::string> violations_;
  Worst worst_;
};

}  // namespace proleg::sim
