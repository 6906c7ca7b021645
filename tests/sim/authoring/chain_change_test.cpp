#include "sim/authoring/chain_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/behaviour_change.hpp"
#include "sim/authoring/chain_text.hpp"
#include "sim/authoring/module_change.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/authoring/robot_change.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/sensor_change.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

MemoryFiles new_files(const RobotKind& kind, const std::string& axes) {
  MemoryFiles files;
  for (SourceFile& file : new_scenario_files(kind, axes)) {
    files.texts[file.path] = std::move(file.text);
  }
  return files;
}

Scenario read_new(MemoryFiles& files) { return read_scenario("robot.simulation.xml", files); }

/// A draft of a robot as `proleg new robot` writes it. Axes count from the tail.
class NewDraft {
 public:
  explicit NewDraft(const std::string& axes, const RobotKind& kind = robot_kinds().front())
      : files_(new_files(kind, axes)), draft_(read_new(files_), files_) {}

  template <typename Change>
  void change(const Change& change) {
    draft_.change("test", {}, [&](DraftChange& edit) {
      ChainChange chain(edit);
      change(chain);
    });
  }
  template <typename Change>
  std::string refusal(const Change& refused) {
    const std::string before = text();
    std::string message = message_of<InputError>([&] { change(refused); });
    EXPECT_EQ(text(), before);
    return message;
  }
  void set_axis(std::size_t joint, char axis) {
    const Scenario before = draft_.scenario();
    draft_.change("test", {}, [&](DraftChange& edit) {
      const auto kernel_joint = static_cast<unsigned>(before.robot.joints.size() - 1 - joint);
      RobotChange(before, edit)
          .set_axis(JointMask::of(kernel_joint), axis == 'p' ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0, 0, 1));
    });
  }
  [[nodiscard]] std::string axes() const {
    std::string axes;
    for (auto joint = draft_.scenario().robot.joints.rbegin(); joint != draft_.scenario().robot.joints.rend();
         ++joint) {
      axes += direction_of(*joint) == JointDirection::yaw ? 'y' : 'p';
    }
    return axes;
  }
  [[nodiscard]] std::string text() const { return draft_.text("robot.robot.xml"); }
  Draft& draft() { return draft_; }

 private:
  MemoryFiles files_;
  Draft draft_;
};

void expect_same_robot(const RobotModel& robot, const RobotModel& expected) {
  ASSERT_EQ(robot.links.size(), expected.links.size());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const Link& other = expected.links[i];
    EXPECT_EQ(link.name, other.name);
    EXPECT_LT((link.pose.position - other.pose.position).norm(), 1e-9) << link.name;
    EXPECT_LT(link.pose.orientation.angularDistance(other.pose.orientation), 1e-9) << link.name;
    EXPECT_EQ(link.mass.mass, other.mass.mass);
    EXPECT_TRUE(link.mass.inertia.isApprox(other.mass.inertia));
    ASSERT_EQ(link.geometries.size(), other.geometries.size());
    for (std::size_t g = 0; g < link.geometries.size(); ++g) {
      EXPECT_EQ(link.geometries[g].extents, other.geometries[g].extents);
      EXPECT_EQ(link.geometries[g].friction, other.geometries[g].friction);
    }
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    const Joint& other = expected.joints[i];
    EXPECT_EQ(joint.name, other.name);
    EXPECT_EQ(joint.file_index, other.file_index);
    EXPECT_LT((joint.anchor - other.anchor).norm(), 1e-9) << joint.name;
    EXPECT_EQ(joint.axis, other.axis) << joint.name;
    EXPECT_EQ(joint.lower_limit, other.lower_limit);
    EXPECT_EQ(joint.max_torque, other.max_torque);
  }
}

TEST(ChainChange, AJointMoreIsTheRobotThatIsWrittenWithOneMore) {
  NewDraft draft("ppppp");
  draft.change([](ChainChange& chain) { chain.duplicate(2); });
  MemoryFiles expected = new_files(robot_kinds().front(), "pppppp");
  const Scenario other = read_new(expected);
  expect_same_robot(draft.draft().scenario().robot, other.robot);
  EXPECT_EQ(draft.draft().scenario().kernel.slots[0].group, other.kernel.slots[0].group);
  ASSERT_TRUE(draft.draft().undo());
  MemoryFiles before = new_files(robot_kinds().front(), "ppppp");
  EXPECT_EQ(draft.text(), before.texts.at("robot.robot.xml"));
}

// The oracle is another writer: whatever joints come and go, the robot is the one that `proleg new robot` writes with
// these axes; and undo leads back to the first byte.
TEST(ChainChange, AnyWayToAChainGivesThatChain) {
  constexpr unsigned seed = 48;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  for (const char* const name : {"caterpillar", "cubo"}) {
    SCOPED_TRACE(name);
    const RobotKind& kind = *find_robot_kind(name);
    NewDraft draft("pyppy", kind);
    const std::string first = draft.text();
    std::string axes = "pyppy";
    for (int i = 0; i < 30; ++i) {
      SCOPED_TRACE("operation " + std::to_string(i) + " on " + axes);
      const std::size_t joint = below(axes.size());
      switch (below(5)) {
        case 0:
          if (axes.size() < 12 && axes.size() > 1) {
            draft.change([&](ChainChange& chain) { chain.duplicate(joint); });
            axes.insert(joint, 1, axes[joint]);
          }
          break;
        case 1:
          if (axes.size() > 2) {
            draft.change([&](ChainChange& chain) { chain.remove(joint); });
            axes.erase(joint, 1);
          }
          break;
        case 2:
          axes[joint] = below(2) == 0 ? 'p' : 'y';
          draft.set_axis(joint, axes[joint]);
          break;
        case 3: {
          std::vector<std::size_t> order(axes.size());
          std::string ordered;
          for (std::size_t j = 0; j < order.size(); ++j) {
            order[j] = j;
          }
          std::ranges::shuffle(order, random);
          for (const std::size_t j : order) {
            ordered += axes[j];
          }
          draft.change([&](ChainChange& chain) { chain.order(order); });
          axes = ordered;
          break;
        }
        default: {
          const std::size_t count = 2 + below(9);
          draft.change([&](ChainChange& chain) { chain.set_joint_count(count); });
          while (axes.size() > count) {
            axes.pop_back();
          }
          while (axes.size() < count) {
            axes += axes[axes.size() - 2];
          }
        }
      }
      MemoryFiles expected = new_files(kind, axes);
      ASSERT_EQ(draft.axes(), axes);
      ASSERT_NO_FATAL_FAILURE(expect_same_robot(draft.draft().scenario().robot, read_new(expected).robot));
    }
    while (draft.draft().undo()) {
    }
    EXPECT_EQ(draft.text(), first);
  }
}

TEST(ChainChange, TheActuationFollowsItsJoints) {
  NewDraft draft("pypy");
  const auto set = [&](unsigned slot, const std::string& name, unsigned kernel_joint, const std::string& value) {
    const Scenario before = draft.draft().scenario();
    draft.draft().change("test", {}, [&](DraftChange& edit) {
      BehaviourChange(before, edit).set_parameter(slot, name, JointMask::of(kernel_joint), value);
    });
  };
  set(0, "offset", 3, "7");   // J1, pitch
  set(1, "offset", 0, "-9");  // J4, yaw
  const auto offset = [&](unsigned slot, unsigned kernel_joint) {
    const Scenario& scenario = draft.draft().scenario();
    const int number = find_parameter(scenario.kernel.slots[slot].algorithm->declaration(), "offset");
    return start_value(scenario, slot, kernel_joint, static_cast<unsigned>(number)) * 90.0 / quarter_turn;
  };
  draft.change([](ChainChange& chain) { chain.order({3, 2, 1, 0}); });
  EXPECT_EQ(draft.axes(), "ypyp");
  EXPECT_NEAR(offset(0, 0), 7.0, 1e-6) << "the pitch joint is at the head now";
  EXPECT_NEAR(offset(1, 3), -9.0, 1e-6);
  draft.change([](ChainChange& chain) { chain.duplicate(3); });
  EXPECT_EQ(draft.axes(), "ypypp");
  EXPECT_NEAR(offset(0, 0), 7.0, 1e-6);
  EXPECT_NEAR(offset(0, 1), 7.0, 1e-6) << "the copy has the values of the joint";
  draft.change([](ChainChange& chain) { chain.remove(0); });
  EXPECT_EQ(draft.axes(), "pypp");
  EXPECT_EQ(draft.draft().text("robot.actuation.xml").find("value=\"-9"), std::string::npos);
}

TEST(ChainChange, SensorsAndModulesGoWithTheirJoints) {
  DiskFiles disk;
  Draft draft(read_scenario(source_path("/sim/scenarios/retreat/wall.simulation.xml"), disk), disk);
  const std::size_t sensors = draft.scenario().robot.sensors.size();
  const auto part_of = [&](const std::string& name) {
    const RobotContents robot = read_robot_contents(draft);
    const auto found = std::ranges::find(robot.sensors, name, [](const auto& other) { return other.sensor.name; });
    return found == robot.sensors.end() ? std::string("none") : found->part;
  };
  EXPECT_EQ(part_of("level"), "2Seg");
  draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).duplicate(0); });
  EXPECT_EQ(part_of("level"), "3Seg") << "the same link, which counts on";
  EXPECT_EQ(part_of("effort"), "J4");
  EXPECT_EQ(part_of("bumper"), "Head");
  draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).remove(3); });
  EXPECT_EQ(part_of("effort"), "none");
  EXPECT_EQ(part_of("level"), "3Seg");
  EXPECT_EQ(draft.scenario().robot.sensors.size(), sensors - 1);
}

TEST(ChainChange, EveryShippedRobotCanBeLongerShorterAndAsItWas) {
  DiskFiles disk;
  std::set<std::string> robots;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    if (!entry.path().string().ends_with(".simulation.xml")) {
      continue;
    }
    SCOPED_TRACE(entry.path().string());
    Draft draft(read_scenario(entry.path(), disk), disk);
    if (!robots.insert(draft.scenario().robot_file).second) {
      continue;
    }
    const std::string before = draft.text(draft.scenario().robot_file);
    const std::size_t joints = draft.scenario().robot.joints.size();
    if (joints < max_joints) {
      draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).duplicate(1); });
      EXPECT_EQ(draft.scenario().robot.joints.size(), joints + 1);
      draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).remove(1); });
    }
    EXPECT_EQ(draft.scenario().robot.joints.size(), joints);
    draft.change("test", {}, [&](DraftChange& edit) { ChainChange(edit).set_joint_count(joints - 2); });
    EXPECT_EQ(draft.scenario().robot.joints.size(), joints - 2);
    while (draft.undo()) {
    }
    EXPECT_EQ(draft.text(draft.scenario().robot_file), before);
  }
}

TEST(ChainChange, ARobotOfTheThesisGrows) {
  DiskFiles disk;
  Draft draft(read_scenario(source_path("/tests/sim/scenario/thesis/MFIdemo.simulation.xml"), disk), disk);
  draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).set_joint_count(8); });
  EXPECT_EQ(draft.scenario().robot.joints.size(), 8U);
  EXPECT_EQ(direction_of(draft.scenario().robot.joints[0]), JointDirection::yaw) << "pitch and yaw alternate";
}

TEST(ChainChange, OtherFormsOfChainsAreRefusedWithTheReason) {
  NewDraft draft("ppp");
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.duplicate(3); }).find("below 3"), std::string::npos);
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.remove(17); }).find("below 3"), std::string::npos);
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.order({0, 1, 1}); }).find("each once"), std::string::npos);
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.set_joint_count(0); }).find("1 to 64"), std::string::npos);
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.set_joint_count(65); }).find("1 to 64"), std::string::npos);
  draft.change([](ChainChange& chain) { chain.set_joint_count(1); });
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.remove(0); }).find("only joint"), std::string::npos);
  EXPECT_NE(draft.refusal([](ChainChange& chain) { chain.duplicate(0); }).find("one joint"), std::string::npos);

  MemoryFiles nested = small_scenario();
  nested.replace("robot.xml", "<Body name=\"Head\">",
                 "<KinBody><Body name=\"Neck\"><Geom type=\"sphere\"><radius>0.1</radius></Geom><Mass "
                 "type=\"mimicgeom\"><total>1</total></Mass></Body><Body name=\"Head\">");
  nested.replace("robot.xml", "<Joint name=\"J1\"", "</KinBody><Joint name=\"J1\"");
  nested.replace("robot.xml", "<body>Head</body>", "<body>Neck</body>");
  nested.replace("robot.xml", "<offsetfrom>Head</offsetfrom>", "<offsetfrom>Neck</offsetfrom>");
  nested.replace("robot.xml", "</Joint>\n  </KinBody>", R"(</Joint>
    <Joint name="J3" type="hinge"><body>Neck</body><body>Head</body><offsetfrom>Head</offsetfrom><axis>1 0 0</axis>
    <maxtorque>1</maxtorque><maxvel>1</maxvel><limitsdeg>-9 9</limitsdeg></Joint>
  </KinBody>)");
  nested.replace("actuation.xml", "joints=\"11\"", "joints=\"111\"");
  nested.replace("actuation.xml", "joints=\"01\"", "joints=\"001\"");
  Draft other(nested.scenario(), nested);
  EXPECT_NE(read_robot_contents(other).obstacle.value_or("").find("in another <KinBody>"), std::string::npos);
}

TEST(ModuleChange, AllLinksOfAKindAreTheRobotOfThatKind) {
  for (const RobotKind& kind : robot_kinds()) {
    SCOPED_TRACE(std::string(kind.name));
    NewDraft draft("pypy");
    draft.draft().change("test", {}, [&](DraftChange& edit) { set_kind_of_links(edit, module_kind(kind), {}); });
    MemoryFiles expected = new_files(kind, "pypy");
    expect_same_robot(draft.draft().scenario().robot, read_new(expected).robot);
    ASSERT_TRUE(draft.draft().undo());
    EXPECT_TRUE(draft.draft().changed_files().empty()) << "the files of the modules go, too";
  }
}

TEST(ModuleChange, OneLinkMovesThoseInFrontOfIt) {
  NewDraft draft("pppp");
  const ModuleKind cubes = module_kind(*find_robot_kind("cube-chain"));
  const auto change = [&](std::size_t link) {
    draft.draft().change("test", {}, [&](DraftChange& edit) { set_kind_of_links(edit, cubes, std::array{link}); });
  };
  change(2);
  const RobotModel& robot = draft.draft().scenario().robot;  // from the head: links 4, 3, 2, 1, 0
  EXPECT_NEAR(robot.links[2].pose.position.y(), 0.072, 1e-9);
  EXPECT_NEAR(robot.links[1].pose.position.y(), 0.072 + 0.060, 1e-9);
  EXPECT_NEAR(robot.links[0].pose.position.y(), 2 * 0.072 + 0.060, 1e-9);
  change(0);
  EXPECT_EQ(draft.draft().scenario().robot.links[4].name, "Tail");
  EXPECT_NE(message_of<InputError>([&] { change(9); }).find("below 5"), std::string::npos);
}

/// The files of the links from the tail, without their folders' common beginning.
std::string kinds_from_tail(NewDraft& draft) {
  std::string kinds;
  const RobotContents contents = read_robot_contents(draft.draft());
  for (auto link = contents.links.rbegin(); link != contents.links.rend(); ++link) {
    kinds += link->file.find("cube-chain") != std::string::npos ? 'C' : '-';
  }
  return kinds;
}

class MovedJoint : public testing::Test {
 protected:
  // Link 2, in front of joint 1, is a cube with a sensor.
  void SetUp() override {
    draft_.draft().change("test", {}, [&](DraftChange& edit) {
      set_kind_of_links(edit, module_kind(*find_robot_kind("cube-chain")), std::array<std::size_t, 1>{2});
    });
    const Scenario before = draft_.draft().scenario();
    const RobotContents contents = read_robot_contents(draft_.draft());
    draft_.draft().change("test", {}, [&](DraftChange& edit) {
      SensorChange(before, contents, edit).add(SensorKind::inclinometer, 2, SensorPlace::front);
    });
    ASSERT_EQ(kinds_from_tail(draft_), "--C--");
    ASSERT_EQ(sensor_link(), 2U);
  }
  [[nodiscard]] std::size_t sensor_link() {
    const RobotContents contents = read_robot_contents(draft_.draft());
    const auto link = std::ranges::find(contents.links, contents.sensors.at(0).part, &LinkContents::name);
    return static_cast<std::size_t>(link - contents.links.begin());
  }
  [[nodiscard]] double head() { return draft_.draft().scenario().robot.links[0].pose.position.y(); }

  NewDraft draft_{"pypp"};
};

TEST_F(MovedJoint, TakesItsLinkAndTheSensorsOnItAlong) {
  const std::string before = draft_.text();
  const double length = head();
  draft_.change([](ChainChange& chain) { chain.move(1, 0); });
  EXPECT_EQ(draft_.axes(), "yppp");
  EXPECT_EQ(kinds_from_tail(draft_), "-C---");
  EXPECT_EQ(sensor_link(), 3U) << "from the head";
  EXPECT_NEAR(head(), length, 1e-9);
  EXPECT_NEAR(draft_.draft().scenario().robot.links[2].pose.position.y() -
                  draft_.draft().scenario().robot.links[3].pose.position.y(),
              0.060, 1e-9)
      << "the short link is behind the second one";
  ASSERT_TRUE(draft_.draft().undo());
  EXPECT_EQ(draft_.text(), before);
  draft_.change([](ChainChange& chain) { chain.move(0, 2); });
  EXPECT_EQ(draft_.axes(), "yppp");
  EXPECT_EQ(kinds_from_tail(draft_), "-C---") << "those between close up";
}

TEST_F(MovedJoint, AtTheHeadHasTheLinkBehindIt) {
  draft_.change([](ChainChange& chain) { chain.move(1, 3); });
  EXPECT_EQ(draft_.axes(), "pppy");
  EXPECT_EQ(kinds_from_tail(draft_), "---C-") << "the head stays";
  EXPECT_EQ(sensor_link(), 1U);
  draft_.change([](ChainChange& chain) { chain.move(3, 1); });
  EXPECT_EQ(draft_.axes(), "pypp");
  EXPECT_EQ(kinds_from_tail(draft_), "--C--");
  EXPECT_EQ(sensor_link(), 2U);
}

TEST_F(MovedJoint, IsAJointThatExists) {
  EXPECT_NE(draft_.refusal([](ChainChange& chain) { chain.move(0, 4); }).find("below 4"), std::string::npos);
  EXPECT_NE(draft_.refusal([](ChainChange& chain) { chain.move(9, 0); }).find("below 4"), std::string::npos);
}

TEST(MovedJointOfASmallRobot, LeavesALinkInTheRobotsFileWhereItIs) {
  MemoryFiles files = small_scenario();
  Draft draft(files.scenario(), files);
  draft.change("test", {}, [](DraftChange& edit) { ChainChange(edit).move(0, 1); });
  EXPECT_EQ(read_robot_contents(draft).links[1].name, "Middle");
  EXPECT_EQ(read_robot_contents(draft).joints[1].axis, Eigen::Vector3d(0, 0, 1));
}

TEST(CountedNames, CountInEitherDirection) {
  EXPECT_EQ(counted_names({"J1", "J2", "J3"})->at(3, 4), "J4");
  EXPECT_EQ(counted_names({"1Seg", "2Seg"})->at(0, 2), "1Seg");
  EXPECT_EQ(counted_names({"J3", "J2", "J1"})->at(0, 4), "J4");
  EXPECT_FALSE(counted_names({"J1", "J3"}));
  EXPECT_FALSE(counted_names({"hip", "knee"}));
  EXPECT_FALSE(counted_names({}));
}

}  // namespace
}  // namespace proleg::sim
