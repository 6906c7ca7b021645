#pragma once

// The steps of proleg assign: what it does on the bus, the names that users give joints, and its questions.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "host/robot/node_plan.hpp"
#include "sim/robot/robot_model.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/robot/assign_report.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

// What is done on the bus throws std::runtime_error: what failed, and what to do.

/// Resets all modules, and waits until they have booted. Refuses a bus with two modules of one node id: they stop, and
/// answer nothing afterwards.
void reset_all(BusAccess& bus);

/// Who is on the bus.
struct ModulesToNumber {
  std::vector<host::PlacedModule> modules;  ///< by node id, at least one; their joints are not known
  std::vector<std::uint8_t> others;         ///< node ids of nodes that are no joint modules, or do not answer
};
[[nodiscard]] ModulesToNumber find_modules_to_number(BusAccess& bus);

/// A joint that moves to and fro while this exists.
class MovingJoint {
 public:
  /// Returns when the joint moves.
  MovingJoint(BusAccess& bus, std::uint8_t node, const host::JointMotionOptions& options);
  /// If stop() was not called: takes the power as well as it can.
  ~MovingJoint();
  MovingJoint(const MovingJoint&) = delete;
  MovingJoint& operator=(const MovingJoint&) = delete;

  /// Returns when the servo has no power.
  void stop();
  [[nodiscard]] const host::JointMotion& motion() const { return motion_; }
  /// To be called from time to time while it moves.
  void take_events();
  /// Why it does not move any more.
  [[nodiscard]] std::string problem() const;

 private:
  bool try_to_stop();
  void stop_after_failure() noexcept;

  BusAccess& bus_;
  host::JointMotion motion_;
  host::BusAttachment attachment_;
  bool is_off_ = false;
  bool is_confirmed_ = true;  ///< no module has left out the confirmation that its servo has no power
};

/// The joint that a user means: its name, in any case if that is one joint, or the number at the end of one name.
[[nodiscard]] std::optional<unsigned> joint_of(const sim::RobotModel& robot, std::string_view word);

/// A module and its joint, as the user says.
struct Place {
  std::optional<std::uint8_t> node;  ///< nothing: the serial number names the module
  std::uint32_t serial = 0;
  unsigned joint = 0;

  [[nodiscard]] std::string module_name() const;
};

/// "3=J1,0x1A2B3C4D=J2". Throws InputError, which names --places; also if a module or a joint is named twice.
[[nodiscard]] std::vector<Place> parse_places(const sim::RobotModel& robot, std::string_view words);

/// The questions of proleg assign. Answers come by standard input, from a person or from a program in the place of one.
class AssignDialogue {
 public:
  static constexpr std::int32_t largest_amplitude = raw(Unit::degree, 30);

  /// All must outlive this.
  AssignDialogue(BusAccess& bus, HostPresence& presence, const sim::RobotModel& robot, const AssignReport& report)
      : bus_(bus), presence_(presence), robot_(robot), report_(report) {}

  /// Moves the joint of a module until the user says which one it is. Returns the joint; nothing: it is none of this
  /// robot. why_not: says why a joint cannot be the answer ("J3 is node 4 already"), or nothing. Throws
  /// std::runtime_error if the user ends the program, input ends, or the servo may still have power.
  std::optional<unsigned> ask_for_joint(const host::PlacedModule& module, host::JointMotionOptions options,
                                        const std::function<std::optional<std::string>(unsigned joint)>& why_not);

  /// Whether the user agrees. Throws as ask_for_joint().
  bool ask_to_agree(std::span<const NodeChange> changes);

 private:
  /// The user wants a larger motion.
  struct More {};
  using Answer = std::variant<More, std::optional<unsigned>>;

  /// moving: null if the joint cannot move.
  Answer ask_while(MovingJoint* moving, const host::PlacedModule& module,
                   const std::function<std::optional<std::string>(unsigned joint)>& why_not);
  std::string next_line(MovingJoint* moving);
  [[nodiscard]] std::string choices() const;

  BusAccess& bus_;
  HostPresence& presence_;
  const sim::RobotModel& robot_;
  const AssignReport& report_;
  InputLines lines_;
};

}  // namespace proleg::tools
