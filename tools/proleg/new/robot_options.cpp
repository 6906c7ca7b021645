#include "tools/proleg/new/robot_options.hpp"

#include <cstdint>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/new_scenario.hpp"

namespace proleg::tools {
namespace {

const sim::RobotKind& parse_kind(const std::string& word) {
  const sim::RobotKind* const kind = word.empty() ? &sim::robot_kinds().front() : sim::find_robot_kind(word);
  if (kind == nullptr) {
    std::vector<std::string> names;
    for (const sim::RobotKind& known : sim::robot_kinds()) {
      names.emplace_back(known.name);
    }
    throw InputError("--kind", 0, in_quotes(word), "one of " + listed(names));
  }
  return *kind;
}

std::uint32_t parse_joints(const std::string& word) {
  const std::optional<std::uint32_t> joints = parse_whole<std::uint32_t>(word);
  if (!joints || *joints == 0 || *joints > max_joints) {
    throw InputError("--joints", 0, in_quotes(word), "a whole number from 1 to " + std::to_string(max_joints));
  }
  return *joints;
}

/// The axis of each joint from the tail, from the repeated pattern.
std::string axes_of_joints(const std::string& pattern, std::uint32_t joints) {
  if (pattern.empty() || pattern.find_first_not_of("py") != std::string::npos) {
    throw InputError("--axes", 0, in_quotes(pattern), "letters p (pitch) and y (yaw), from the tail");
  }
  if (pattern.size() > joints) {
    throw InputError("--axes", 0,
                     std::to_string(pattern.size()) + " letters for a robot with --joints " + std::to_string(joints),
                     "at most one letter for each joint");
  }
  std::string axes;
  for (std::uint32_t joint = 0; joint < joints; ++joint) {
    axes += pattern[joint % pattern.size()];
  }
  return axes;
}

}  // namespace

void add_robot_options(CommandLine& command_line, RobotOptions& options) {
  std::string kinds = "kind of robot:";
  for (const sim::RobotKind& kind : sim::robot_kinds()) {
    kinds.append(&kind == &sim::robot_kinds().front() ? " " : "; ").append(kind.name).append(" (").append(kind.help);
    kinds += ")";
  }
  command_line.add_option("--kind", options.kind, kinds).value_name("KIND");
  command_line.add_option("--joints", options.joints, "number of joints, 1 to 64; by default that of the kind")
      .value_name("N");
  command_line
      .add_option("--axes", options.axes,
                  "p for a pitch joint, y for a yaw joint; the letters are repeated along the chain, from the tail; by "
                  "default those of the kind, or p")
      .value_name("LETTERS");
}

std::string axes_of(const RobotOptions& options) {
  const sim::RobotKind& kind = parse_kind(options.kind);
  const std::uint32_t joints = options.joints ? parse_joints(*options.joints) : kind.joints;
  return axes_of_joints(options.axes.value_or(std::string(kind.axes.substr(0, joints))), joints);
}

std::vector<sim::SourceFile> robot_files(const RobotOptions& options) {
  return sim::new_scenario_files(parse_kind(options.kind), axes_of(options));
}

}  // namespace proleg::tools
