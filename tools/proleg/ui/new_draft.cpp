#include "tools/proleg/ui/new_draft.hpp"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/joint_mask.hpp"
#include "sim/authoring/behaviour_change.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/authoring/robot_change.hpp"
#include "sim/authoring/world_change.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/ui/draft_arguments.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

const sim::RobotKind& kind_of(const json& arguments) {
  const std::string name = text(arguments, "kind");
  const sim::RobotKind* const kind = name.empty() ? &sim::robot_kinds().front() : sim::find_robot_kind(name);
  if (kind == nullptr) {
    throw InputError("kind", 0, in_quotes(name), "a kind of the document `parts`");
  }
  return *kind;
}

/// A letter for each joint, from the tail.
std::string axes_of(const json& arguments, const sim::RobotKind& kind) {
  const auto given = argument<std::string>(arguments, "axes", "letters p and y");
  std::string axes = given.value_or("");
  while (!given && axes.size() < kind.joints) {
    axes += kind.axes[axes.size() % kind.axes.size()];
  }
  if (axes.empty() || axes.size() > max_joints || axes.find_first_not_of("py") != std::string::npos) {
    throw InputError("axes", 0, in_quotes(axes),
                     "1 to " + std::to_string(max_joints) + " letters p (pitch) or y (yaw), from the tail");
  }
  return axes;
}

/// One module of this algorithm moves all joints. It has the values of the gait that the robot had, as far as it knows
/// them.
void set_algorithm(sim::Draft& draft, const std::string& algorithm) {
  while (sim::used_slots(draft.scenario()).size() > 1) {
    draft.change("", {}, [&](sim::DraftChange& edit) { sim::BehaviourChange(draft.scenario(), edit).remove(1); });
  }
  draft.change("", {}, [&](sim::DraftChange& edit) {
    sim::BehaviourChange(draft.scenario(), edit).set_algorithm(0, algorithm);
  });
  draft.change("", {}, [&](sim::DraftChange& edit) {
    const auto count = static_cast<unsigned>(draft.scenario().robot.joints.size());
    sim::BehaviourChange(draft.scenario(), edit).set_joints(0, JointMask::first(count));
  });
}

void change_world(sim::Draft& draft, const json& arguments) {
  const std::string item = text(arguments, "item");
  const auto friction = argument<double>(arguments, "friction", "a coefficient");
  const sim::WorldContents world = read_world_contents(draft);
  draft.change("", {}, [&](sim::DraftChange& edit) {
    sim::WorldChange change(world, edit);
    if (friction) {
      change.set_friction(0, *friction);
    }
    if (item.empty()) {
      return;
    }
    const sim::LibraryDeclaration* const declaration = sim::find_library_item(item);
    if (declaration == nullptr) {
      throw InputError("item", 0, in_quotes(item), "an item of the library");
    }
    constexpr double distance = 0.3;  // m, from the head
    const sim::Scenario& scenario = draft.scenario();
    const sim::Pose head = scenario.environment.robot_pose * scenario.robot.links.front().pose;
    Eigen::Vector3d place = head * Eigen::Vector3d(0, distance, 0);
    place.z() = 0.0;
    change.add(declaration->item,
               argument<std::map<std::string, double>>(arguments, "values", "numbers by their names")
                   .value_or(std::map<std::string, double>{}),
               place, 0.0);
  });
}

}  // namespace

sim::Scenario new_scenario(const json& arguments) {
  const sim::RobotKind& kind = kind_of(arguments);
  sim::SourceTexts files;
  const std::vector<sim::SourceFile> texts = sim::new_scenario_files(kind, axes_of(arguments, kind));
  for (const sim::SourceFile& file : texts) {
    files.add(file.path, file.text);
  }
  sim::Draft draft(sim::read_scenario(texts.front().path, files), files);
  if (const std::string name = text(arguments, "name"); !name.empty()) {
    draft.change("", {}, [&](sim::DraftChange& edit) { sim::RobotChange(draft.scenario(), edit).rename(name); });
  }
  if (const std::string algorithm = text(arguments, "algorithm"); !algorithm.empty()) {
    set_algorithm(draft, algorithm);
  }
  change_world(draft, arguments);
  return draft.scenario();
}

}  // namespace proleg::tools
