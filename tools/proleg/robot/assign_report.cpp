#include "tools/proleg/robot/assign_report.hpp"

#include <cmath>
#include <iostream>

#include "shared/computer/text/text.hpp"
#include "shared/gait/declaration.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::tools {
namespace {

std::string node_text(const host::PlacedModule& module) { return "Node " + std::to_string(module.node); }

/// Rounded to tenths.
double degrees_of(std::int32_t angle) {
  constexpr double tenths = 10.0;
  return std::round(90.0 * angle / quarter_turn * tenths) / tenths;
}

}  // namespace

void AssignReport::say(const std::string& text) const {
  if (!report_.has_events()) {
    std::cerr << text << std::flush;
  }
}

void AssignReport::show_numbered(unsigned count) const {
  if (count > 0) {
    report_.print_event("numbered", {{"count", count}});
  }
}

void AssignReport::explain_questions() const {
  say("One joint after the other moves to and fro; all others have no power. Answer with its name (" +
      listed(sim::joint_names(robot_)) +
      "), none if no joint of this robot moves, more for a larger motion, or quit.\n");
}

void AssignReport::show_places(std::span<const host::PlacedModule> modules) const {
  Json list = Json::empty_array();
  for (const host::PlacedModule& module : modules) {
    list.append({{"serial", module.address.back()}, {"node", module.node}, {"joint", joint_json(module.joint)}});
  }
  report_.print_event("places", {{"modules", list}});
}

void AssignReport::show_motion(const host::PlacedModule& module, std::int32_t amplitude) const {
  const double degrees = degrees_of(amplitude);
  say(node_text(module) + " moves by " + number_text(degrees) + " degrees. ");
  report_.print_event("moves", {{"node", module.node}, {"serial", module.address.back()}, {"degrees", degrees}});
}

void AssignReport::show_standstill(const host::PlacedModule& module, const std::string& problem) const {
  say(node_text(module) + " cannot move (" + problem + "). If you know its joint, say it; else none. ");
  report_.print_event("cannot_move", {{"node", module.node}, {"serial", module.address.back()}, {"problem", problem}});
}

void AssignReport::show_changes(std::span<const NodeChange> changes) const {
  for (const NodeChange& change : changes) {
    say("node " + std::to_string(change.from) + " gets the node id " + std::to_string(change.to) +
        (change.joint ? " (" + joint_name(*change.joint) + ")" : " (no joint of this robot)") + "\n");
  }
}

void AssignReport::ask_for_joint(const host::PlacedModule& module) const {
  say("Which joint is it? ");
  report_.print_event("question", {{"question", "joint"}, {"node", module.node}, {"serial", module.address.back()}});
}

void AssignReport::ask_to_agree(std::span<const NodeChange> changes) const {
  say("Give the modules these node ids? [y/n] ");
  Json list = Json::empty_array();
  for (const NodeChange& change : changes) {
    list.append(
        {{"serial", change.serial}, {"from", change.from}, {"to", change.to}, {"joint", joint_json(change.joint)}});
  }
  report_.print_event("question", {{"question", "agree"}, {"changes", list}});
}

void AssignReport::refuse(const std::string& reason) const {
  say(reason + ". ");
  report_.print_event("refused", {{"text", reason}});
}

}  // namespace proleg::tools
