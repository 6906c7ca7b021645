#pragma once

// What proleg assign reports and asks while it works: sentences for a person on standard error, or with --json-lines
// events for a program on standard output.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/node_plan.hpp"
#include "sim/robot/robot_model.hpp"
#include "tools/proleg/common/program_report.hpp"

namespace proleg::tools {

/// A module that is to store another node id.
struct NodeChange {
  std::uint32_t serial = 0;
  unsigned from = 0;
  unsigned to = 0;
  std::optional<unsigned> joint;  ///< nothing: none of this robot
};

class AssignReport {
 public:
  /// Both must outlive this.
  AssignReport(const ProgramReport& report, const sim::RobotModel& robot) : report_(report), robot_(robot) {}

  /// count: modules that had no node id and have one now.
  void show_numbered(unsigned count) const;
  /// Before the first question: what is asked, and how it is answered.
  void explain_questions() const;
  /// The joints of the modules, as far as they are known.
  void show_places(std::span<const host::PlacedModule> modules) const;
  /// amplitude: 90 degrees = 2^30.
  void show_motion(const host::PlacedModule& module, std::int32_t amplitude) const;
  void show_standstill(const host::PlacedModule& module, const std::string& problem) const;
  void show_changes(std::span<const NodeChange> changes) const;

  void ask_for_joint(const host::PlacedModule& module) const;
  void ask_to_agree(std::span<const NodeChange> changes) const;
  /// reason: why the last answer is not taken, without a full stop.
  void refuse(const std::string& reason) const;

  [[nodiscard]] const std::string& joint_name(unsigned joint) const { return robot_.joints[joint].name; }

 private:
  void say(const std::string& text) const;
  [[nodiscard]] Json joint_json(const std::optional<unsigned>& joint) const {
    return joint ? Json(joint_name(*joint)) : Json();
  }

  const ProgramReport& report_;
  const sim::RobotModel& robot_;
};

}  // namespace proleg::tools
