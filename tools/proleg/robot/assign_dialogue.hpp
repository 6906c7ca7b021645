#pragma once

// The questions of proleg assign. They are on standard error, answers come by standard input, from a person or from a
// program in the place of one.
// The names that users give joints stand here too.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/robot/joint_motion.hpp"
#include "sim/robot/robot_model.hpp"
#include "tools/proleg/common/input_lines.hpp"
#include "tools/proleg/robot/assign_bus.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// The joint that a user means: its name, in any case if that is one joint, or the number at the end of one name.
[[nodiscard]] std::optional<unsigned> joint_of(const sim::RobotModel& robot, std::string_view word);

/// A module and its joint, as the user says.
struct Place {
  std::uint8_t node;
  unsigned joint;
};

/// "3=J1,1=J2". Throws InputError, which names --places; also if a module or a joint is named twice.
[[nodiscard]] std::vector<Place> parse_places(const sim::RobotModel& robot, std::string_view words);

class AssignDialogue {
 public:
  static constexpr std::int32_t largest_amplitude = raw(Unit::degree, 30);

  /// robot: must outlive this, as bus and presence.
  AssignDialogue(BusAccess& bus, HostPresence& presence, const sim::RobotModel& robot)
      : bus_(bus), presence_(presence), robot_(robot) {}

  static void say(const std::string& text);

  /// Moves the joint of a module until the user says which one it is. Returns the joint; nothing: it is none of this
  /// robot. why_not: says why a joint cannot be the answer ("J3 is node 4 already"), or nothing. Throws
  /// std::runtime_error if the user ends the program, input ends, or the servo may still have power.
  std::optional<unsigned> ask_for_joint(std::uint8_t node, host::JointMotionOptions options,
                                        const std::function<std::optional<std::string>(unsigned joint)>& why_not);

  /// Whether the user agrees. Throws as ask_for_joint().
  bool ask_to_agree(const std::string& question);

 private:
  /// The user wants a larger motion.
  struct More {};
  using Answer = std::variant<More, std::optional<unsigned>>;

  Answer ask_while(MovingJoint* moving, const std::function<std::optional<std::string>(unsigned joint)>& why_not);
  std::string next_line(MovingJoint* moving);
  [[nodiscard]] std::string choices() const;

  BusAccess& bus_;
  HostPresence& presence_;
  const sim::RobotModel& robot_;
  InputLines lines_;
};

}  // namespace proleg::tools
