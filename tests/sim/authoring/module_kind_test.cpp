#include "sim/authoring/module_kind.hpp"

#include <gtest/gtest.h>

#include <array>

#include "memory_files.hpp"
#include "mesh_shapes.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/module_change.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

constexpr double precision = 2e-6;  // m; files have micrometres

class OwnModuleTest : public testing::Test {
 protected:
  OwnModuleTest() {
    for (const SourceFile& file : new_scenario_files(robot_kinds().front(), "pppp")) {
      files_.texts[file.path] = file.text;
    }
    draft_.emplace(read_scenario("robot.simulation.xml", files_), files_);
  }

  /// A module of a box with the sides 40, 20 and 60 mm in a file in centimetres, whose longest side lies along the
  /// robot.
  static OwnModule module() { return {"foot", {0.1, {1, 0, 0}, {1, 0, 0}}, 0.08, 0.15}; }
  static OwnMesh mesh() { return read_own_mesh({{"box.off", box_off}}); }
  void set(const ModuleKind& kind, std::vector<std::size_t> links) {
    draft_->change("test", {}, [&](DraftChange& edit) { set_kind_of_links(edit, kind, links); });
  }
  [[nodiscard]] const RobotModel& robot() const { return draft_->scenario().robot; }
  /// Of what touches, at the start; link: from the head.
  [[nodiscard]] Bounds bounds(std::size_t link) const {
    return bounds_of(robot().links[link].geometries.at(0), robot().links[link].pose);
  }

  MemoryFiles files_;
  std::optional<Draft> draft_;
};

TEST_F(OwnModuleTest, AllLinksHaveTheMeshBetweenTheirJoints) {
  set(own_module_kind(mesh(), module()), {});
  ASSERT_EQ(robot().links.size(), 5U);
  for (std::size_t link = 0; link < 5; ++link) {
    SCOPED_TRACE(link);
    // The tail lies behind its joint, the others in front of theirs: a joint each 80 mm, and a box in the middle.
    const double middle = 0.08 * (3.5 - static_cast<double>(link));
    EXPECT_NEAR((bounds(link).lowest.y() + bounds(link).highest.y()) / 2.0, middle, precision);
    const Eigen::Vector3d sides = bounds(link).highest - bounds(link).lowest;
    EXPECT_TRUE(sides.isApprox(Eigen::Vector3d(0.02, 0.06, 0.04), 1e-4)) << sides.transpose();
    EXPECT_NEAR(robot().links[link].mass.mass, 0.15, 1e-9);
    EXPECT_EQ(robot().links[link].geometries.at(0).shape, Shape::hull);
    EXPECT_EQ(robot().links[link].looks.at(0).mesh->colours.at(0), Eigen::Vector3f(1, 0, 0));
  }
  Simulation simulation(draft_->scenario());
  simulation.advance();
  EXPECT_EQ(simulation.tick(), 1U);
  EXPECT_TRUE(draft_->undo());
  EXPECT_TRUE(draft_->changed_files().empty());
}

TEST_F(OwnModuleTest, SomeLinksBecomeOneAndTheOthersMove) {
  const double before = robot().links[0].pose.position.y();
  set(own_module_kind(mesh(), module()), {1, 3});
  EXPECT_NEAR(robot().links[0].pose.position.y(), before + 2.0 * (0.08 - 0.072), precision);
  EXPECT_NEAR(robot().links[1].mass.mass, 0.15, 1e-9);
  EXPECT_NEAR(robot().links[3].mass.mass, 0.15, 1e-9);
  EXPECT_NE(robot().links[2].mass.mass, 0.15);
}

// Only the modules that are used stay in the draft: the others are made from them.
TEST_F(OwnModuleTest, ItsKindIsOneOfTheDraftForOtherLinks) {
  EXPECT_TRUE(own_kinds(draft_->scenario()).empty());
  set(own_module_kind(mesh(), module()), {0});
  ASSERT_EQ(read_robot_contents(*draft_).kinds.size(), 1U);
  EXPECT_EQ(read_robot_contents(*draft_).kinds[0].name, "foot");
  EXPECT_NEAR(read_robot_contents(*draft_).kinds[0].length, 0.08, 1e-9);
  EXPECT_FALSE(draft_->has("modules_foot/head.kinbody.xml"));
  set(own_kinds(draft_->scenario()).at(0), {1, 2, 3, 4});
  EXPECT_TRUE(draft_->has("modules_foot/head.kinbody.xml"));
  const RobotModel one_by_one = robot();
  Draft all(read_scenario("robot.simulation.xml", files_), files_);
  all.change("test", {}, [&](DraftChange& edit) { set_kind_of_links(edit, own_module_kind(mesh(), module()), {}); });
  for (std::size_t link = 0; link < 5; ++link) {
    const Link& expected = all.scenario().robot.links[link];
    EXPECT_TRUE(one_by_one.links[link].pose.position.isApprox(expected.pose.position, 1e-6)) << link;
    EXPECT_TRUE(
        one_by_one.links[link].geometries[0].pose.position.isApprox(expected.geometries[0].pose.position, 1e-6));
  }
  EXPECT_EQ(draft_->changed_files().size(), 5U) << "the robot, three modules and one mesh";
}

TEST_F(OwnModuleTest, AModuleThatWasChangedByHandKeepsThatInItsOtherPlaces) {
  set(own_module_kind(mesh(), module()), {1});
  draft_->change("by hand", {}, [](DraftChange& edit) {
    const XmlText& xml = edit.xml("modules_foot/segment.kinbody.xml");
    const std::size_t at = xml.text().find("0.15");
    edit.apply("modules_foot/segment.kinbody.xml", {at, "0.15", "0.2"});
  });
  set(own_kinds(draft_->scenario()).at(0), {0, 4});
  EXPECT_NEAR(robot().links[0].mass.mass, 0.2, 1e-9);
  EXPECT_NEAR(robot().links[4].mass.mass, 0.2, 1e-9);
}

TEST_F(OwnModuleTest, TwoKindsAreBesideEachOther) {
  set(own_module_kind(mesh(), module()), {});
  OwnModule other = module();
  other.name = "long foot";
  other.length = 0.1;
  set(own_module_kind(mesh(), other), {2});
  EXPECT_EQ(own_kinds(draft_->scenario()).size(), 2U);
  set(module_kind(robot_kinds().front()), {});
  EXPECT_TRUE(own_kinds(draft_->scenario()).empty());
  EXPECT_EQ(draft_->changed_files().size(), 4U) << "the robot and the modules of its kind: unused files are not saved";
}

TEST_F(OwnModuleTest, ValuesOutOfRangeAreRefused) {
  const auto refusal = [](const auto& change) {
    OwnModule changed = module();
    change(changed);
    return message_of<InputError>([&] { static_cast<void>(own_module_kind(mesh(), changed)); });
  };
  for (const char* const name :
       {"", "cubo", "a/b", "..", " a", "a\nb", "a\"b", "<a>", "a123456789a123456789a123456789a"}) {
    EXPECT_NE(refusal([&](OwnModule& own) { own.name = name; }), "") << name;
  }
  for (const double value : {0.0, -1.0, 1e9, std::nan("")}) {
    EXPECT_NE(refusal([&](OwnModule& own) { own.length = value; }), "");
    EXPECT_NE(refusal([&](OwnModule& own) { own.mass = value; }), "");
    EXPECT_NE(refusal([&](OwnModule& own) { own.fit.factor = value; }), "");
  }
  const OwnMesh flat = read_own_mesh({{"flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}});
  EXPECT_NE(message_of<InputError>([&] { static_cast<void>(own_module_kind(flat, module())); }), "");
}

}  // namespace
}  // namespace proleg::sim
