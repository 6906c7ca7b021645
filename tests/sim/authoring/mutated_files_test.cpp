// Files as people write them: with comments, blanks, line ends of another system and tags in capitals anywhere. Opened
// they have their bytes, and a change touches its element only. PROLEG_ROUNDS: how often each scenario has its turn;
// the slow suite has six rounds.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "sim/authoring/behaviour_change.hpp"
#include "sim/authoring/chain_change.hpp"
#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_change.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/world_change.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::sim {
namespace {

/// A text with changes that mean nothing to a parser: blanks, line ends, comments, quotes and the case of tags.
std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  for (int i = 0; i < 6; ++i) {
    const XmlText xml("mutated", text);
    const ElementNumber element = below(xml.size());
    const TextTag& tag = xml.at(element).tag;
    switch (below(5)) {
      case 0:
        text.insert(tag.begin, "<!-- <Body> & 'quotes' -->");
        break;
      case 1:
        text.insert(tag.begin, below(2) == 0 ? "\r\n\t" : "\n\n   ");
        break;
      case 2:
        text.insert(tag.begin + 1 + tag.name.size(), below(2) == 0 ? "\n  " : "  ");
        break;
      case 3:
        if (xml.children(element).empty() && tag.kind == TextTag::Kind::start) {
          text.insert(tag.end, " \n ");
        }
        break;
      default:
        if (xml.at(element).end != tag.end) {
          const std::size_t end = xml.at(element).end_tag + 2;
          for (std::size_t at = 0; at < tag.name.size(); ++at) {
            const auto upper = static_cast<char>(std::toupper(static_cast<unsigned char>(tag.name[at])));
            text[tag.begin + 1 + at] = upper;
            text[end + at] = upper;
          }
        }
    }
  }
  return text;
}

std::size_t rounds() { return from_environment("PROLEG_ROUNDS", 1); }

/// The shipped scenarios, and one of the thesis.
std::vector<Scenario> all_scenarios() {
  DiskFiles disk;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    if (entry.path().string().ends_with(".simulation.xml")) {
      paths.push_back(entry.path());
    }
  }
  paths.push_back(source_path("/tests/sim/scenario/thesis/MFIdemo.simulation.xml"));
  std::ranges::sort(paths);
  std::vector<Scenario> scenarios;
  for (const std::filesystem::path& path : paths) {
    scenarios.push_back(read_scenario(path, disk));
  }
  return scenarios;
}

/// The files of a scenario, with mutations of one of them.
SourceTexts with_mutations(const Scenario& original, const std::string& file, std::mt19937& random) {
  SourceTexts texts;
  for (const SourceFile& source : original.sources) {
    texts.add(source.path, source.path == file ? SharedText(mutated(source.text, random)) : source.text);
  }
  return texts;
}

/// Everything outside of an element of the text before is as it was.
void expect_same_around(const XmlText& before, ElementNumber element, const std::string& after) {
  const std::string& text = before.text();
  const std::size_t begin = before.at(element).tag.begin;
  const std::size_t behind = text.size() - before.at(element).end;
  EXPECT_EQ(after.substr(0, begin), text.substr(0, begin));
  EXPECT_EQ(after.substr(after.size() - behind), text.substr(text.size() - behind));
}

TEST(MutatedFiles, AChangeOfTheWorldTouchesItsObject) {
  constexpr unsigned seed = 300;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<Scenario> originals = all_scenarios();
  std::size_t changes = 0;
  const std::size_t cases = 2 * rounds() * originals.size();
  for (std::size_t i = 0; i < cases; ++i) {
    const Scenario& original = originals[i % originals.size()];
    SCOPED_TRACE(original.path + ", mutation " + std::to_string(i));
    SourceTexts texts = with_mutations(original, original.environment_file, random);
    const std::string before = *texts.read(original.environment_file);
    Draft draft(read_scenario(original.path, texts), texts);
    ASSERT_EQ(draft.text(original.environment_file), before);
    const WorldContents world = read_world_contents(draft);
    ASSERT_EQ(world.objects.size(), original.environment.objects.size() + original.environment.moving_objects.size());
    const std::size_t object = std::uniform_int_distribution<std::size_t>(0, world.objects.size() - 1)(random);
    const WorldObject& chosen = world.objects[object];
    if (!chosen.body || !chosen.group) {
      continue;
    }
    const XmlText xml("before", before);
    const std::size_t kind = i % 4;
    draft.change("test", {}, [&](DraftChange& edit) {
      WorldChange change(world, edit);
      switch (kind) {
        case 0:
          return change.set_friction(object, 0.375);
        case 1:
          return change.set_colour(object, {0.25, 0.5, 0.75});
        case 2:
          return change.rename(object, "renamed");
        default:
          return change.place(object, {chosen.pose.position + Eigen::Vector3d(0.0625, 0, 0), chosen.pose.orientation},
                              i % 8 == 3);
      }
    });
    const std::string after = draft.text(original.environment_file);
    expect_same_around(xml, *chosen.group, after);
    const WorldObject changed = read_world_contents(draft).objects[object];
    EXPECT_TRUE(kind != 0 || chosen.shapes.empty() || changed.shapes[0].friction == 0.375);
    EXPECT_TRUE(kind != 2 || changed.name == "renamed");
    EXPECT_TRUE(kind != 3 || std::abs(changed.pose.position.x() - chosen.pose.position.x() - 0.0625) < 2e-6);
    ASSERT_TRUE(draft.undo());
    ASSERT_EQ(draft.text(original.environment_file), before);
    ++changes;
  }
  EXPECT_GT(6 * changes, 5 * cases);
}

TEST(MutatedFiles, AChangeOfAJointTouchesItsElement) {
  constexpr unsigned seed = 301;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<Scenario> originals = all_scenarios();
  for (std::size_t i = 0; i < rounds() * originals.size(); ++i) {
    const Scenario& original = originals[i % originals.size()];
    const std::size_t kind = (i + i / originals.size()) % 3;
    SCOPED_TRACE(original.path + ", mutation " + std::to_string(i));
    SourceTexts texts = with_mutations(original, original.robot_file, random);
    const std::string before = *texts.read(original.robot_file);
    Draft draft(read_scenario(original.path, texts), texts);
    const auto joint =
        static_cast<unsigned>(std::uniform_int_distribution<std::size_t>(0, original.robot.joints.size() - 1)(random));
    const XmlText xml("before", before);
    const RobotElements elements = find_robot_elements(
        xml, original.path, [&](const std::string& name) { return draft.has(name) ? &draft.text(name) : nullptr; });
    const ElementNumber element = elements.joints.at(original.robot.joints[joint].name).joint;
    const Scenario present = draft.scenario();
    draft.change("test", {}, [&](DraftChange& edit) {
      RobotChange change(present, edit);
      switch (kind) {
        case 0:
          return change.set_axis(JointMask::of(joint), {0.6, 0, 0.8});
        case 1:
          return change.set_limits(JointMask::of(joint), -45.5, 30.25);
        default:
          return change.set_max_torque(JointMask::of(joint), 0.375);
      }
    });
    expect_same_around(xml, element, draft.text(original.robot_file));
    const Joint& changed = draft.scenario().robot.joints[joint];
    EXPECT_TRUE(kind != 2 || changed.max_torque == 0.375);
    ASSERT_TRUE(draft.undo());
    ASSERT_EQ(draft.text(original.robot_file), before);
    if (original.robot.joints.size() < 20) {
      draft.change("test", {}, [&](DraftChange& edit) { ChainChange(edit).duplicate(joint); });
      EXPECT_EQ(draft.scenario().robot.joints.size(), original.robot.joints.size() + 1);
      ASSERT_TRUE(draft.undo());
      ASSERT_EQ(draft.text(original.robot_file), before);
    }
  }
}

TEST(MutatedFiles, AChangeOfTheBehaviourTouchesItsModule) {
  constexpr unsigned seed = 302;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<Scenario> originals = all_scenarios();
  for (std::size_t i = 0; i < rounds() * originals.size(); ++i) {
    const Scenario& original = originals[i % originals.size()];
    const std::size_t kind = (i + i / originals.size()) % 3;
    SCOPED_TRACE(original.path + ", mutation " + std::to_string(i));
    SourceTexts texts = with_mutations(original, original.actuation_file, random);
    const std::string before = *texts.read(original.actuation_file);
    Draft draft(read_scenario(original.path, texts), texts);
    const auto slot =
        static_cast<unsigned>(std::uniform_int_distribution<std::size_t>(0, used_slots(original).size() - 1)(random));
    const XmlText xml("before", before);
    const ElementNumber module = xml.children(0, "actuationModule").at(slot);
    const Slot& used = original.kernel.slots[slot];
    const Scenario present = draft.scenario();
    draft.change("test", {}, [&](DraftChange& edit) {
      BehaviourChange change(present, edit);
      const Parameter& parameter = used.algorithm->declaration().parameters[0];
      switch (kind) {
        case 0:
          return change.set_parameter(slot, std::string(parameter.name), used.group, "1");
        case 1:
          return change.set_joints(slot, JointMask::of(used.group.front()));
        default:
          return change.set_algorithm(slot, "DirectJointAccess");
      }
    });
    expect_same_around(xml, module, draft.text(original.actuation_file));
    draft.undo();
    ASSERT_EQ(draft.text(original.actuation_file), before);
  }
}

}  // namespace
}  // namespace proleg::sim
