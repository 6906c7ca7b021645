#include "sim/authoring/world_change.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/robot/bounds.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

constexpr double rounding = 2e-6;  // m and rad; files have micrometres and millionths of a degree

Pose pose_at(double x, double y, double z, double degrees = 0.0, const Eigen::Vector3d& axis = {0, 0, 1}) {
  return {{x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()))};
}

void expect_pose(const Pose& pose, const Pose& expected) {
  EXPECT_LT((pose.position - expected.position).norm(), rounding) << pose.position.transpose();
  EXPECT_LT(pose.orientation.angularDistance(expected.orientation), rounding);
}

class WorldTest : public testing::Test {
 protected:
  [[nodiscard]] WorldContents world() const { return read_world_contents(draft_); }
  [[nodiscard]] std::string text() const { return text_of(draft_, "environment.xml"); }
  [[nodiscard]] std::size_t find(const std::string& name) const {
    const WorldContents now = world();
    const auto found = std::ranges::find(now.objects, name, &WorldObject::name);
    EXPECT_NE(found, now.objects.end()) << name;
    return static_cast<std::size_t>(found - now.objects.begin());
  }
  [[nodiscard]] WorldObject object(const std::string& name) const { return world().objects.at(find(name)); }
  template <typename Change>
  [[nodiscard]] std::string refusal(const Change& change) {
    const std::string before = text();
    std::string message = message_of<InputError>([&] { change_world(draft_, change); });
    EXPECT_EQ(text(), before) << "what is refused changes nothing";
    return message;
  }

  MemoryFiles files_ = world_files();
  Draft draft_{files_.scenario(), files_};
};

TEST_F(WorldTest, ListsTheObjectsOfTheFile) {
  const WorldContents now = world();
  EXPECT_EQ(now.file, "environment.xml");
  ASSERT_EQ(now.objects.size(), 5U);
  EXPECT_EQ(now.objects[0].name, "floor");
  EXPECT_EQ(now.objects[0].shapes.at(0).size, (std::vector<double>{2000, 2000, 0.006}));
  EXPECT_EQ(now.objects[0].shapes.at(0).friction, 0.1);
  EXPECT_EQ(now.objects[1].name, "low");
  EXPECT_EQ(now.objects[1].group_size, 2U);
  EXPECT_EQ(now.objects[1].shapes.at(0).colour, Eigen::Vector3d(0.6, 0.5, 0.4));
  EXPECT_EQ(now.objects[2].shapes.size(), 2U);
  EXPECT_EQ(now.objects[2].shapes[1].type, "sphere");
  EXPECT_TRUE(now.objects[3].moves);
  EXPECT_NEAR(now.objects[3].mass, 100.0 * 4.0 / 3.0 * std::numbers::pi * std::pow(0.05, 3), 1e-12);
  EXPECT_EQ(now.objects[4].file, "pole.xml");
  EXPECT_FALSE(now.objects[4].body) << "of another file";
  EXPECT_EQ(now.rulers.size(), 1U);
  EXPECT_EQ(now.start, Eigen::Vector3d(0, 0, 0.03));
  EXPECT_EQ(now.start_degrees, Eigen::Vector3d(0, 0, 45));
}

TEST_F(WorldTest, AMovedObjectKeepsTheRestOfTheFile) {
  change_world(draft_, [&](WorldChange& change) { change.place(find("floor"), pose_at(0, 0, -0.103), false); });
  EXPECT_EQ(text(), replaced(world_text, "0 0 -0.003", "0 0 -0.103"));
}

TEST_F(WorldTest, AnObjectOfAGroupGoesWhereItIsPut) {
  const Pose wanted = pose_at(0.4, -0.2, 0.1, 37, {1, 2, 3});
  for (const char* name : {"low", "high", "ball"}) {
    change_world(draft_, [&](WorldChange& change) { change.place(find(name), wanted, false); });
    expect_pose(object(name).pose, wanted);
  }
}

TEST_F(WorldTest, AGroupMovesAsARigidBody) {
  const Pose between = object("low").pose.inverse() * object("high").pose;
  const Pose wanted = pose_at(0.4, -0.2, 0.1, 37, {1, 2, 3});
  change_world(draft_, [&](WorldChange& change) { change.place(find("high"), wanted, true); });
  expect_pose(object("high").pose, wanted);
  expect_pose(object("low").pose.inverse() * object("high").pose, between);
}

TEST_F(WorldTest, AnyPoseIsWrittenAndReadBack) {
  constexpr unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond turn(number(random), number(random), number(random), number(random));
    const Pose wanted{{number(random), number(random), number(random)}, turn.normalized()};
    change_world(draft_, [&](WorldChange& change) { change.place(find("high"), wanted, i % 2 == 0); });
    expect_pose(object("high").pose, wanted);
  }
}

TEST_F(WorldTest, ATurnToTheRightIsANegativeAngle) {
  change_world(draft_, [&](WorldChange& change) { change.place(find("ball"), pose_at(1, 1, 0.05, -30), false); });
  EXPECT_NE(text().find("<RotationAxis>0 0 1 -30</RotationAxis>"), std::string::npos) << text();
  change_world(draft_, [&](WorldChange& change) { change.place(find("ball"), pose_at(1, 1, 0.05), false); });
  EXPECT_EQ(text(), world_text) << "without a turn the tag goes";
}

TEST_F(WorldTest, SizesAreSides) {
  change_world(draft_, [&](WorldChange& change) { change.set_size(find("low"), 0, {1, 0.2, 0.06}); });
  EXPECT_EQ(text(), replaced(replaced(world_text, "0.5 0.1 0.015", "0.5 0.1 0.03"), "0 0.1 0.015", "0 0.1 0.03"))
      << "it stays on the ground";
  change_world(draft_, [&](WorldChange& change) { change.set_size(find("ball"), 0, {0.07}); });
  EXPECT_NE(text().find("<radius>0.07</radius>"), std::string::npos);
}

TEST_F(WorldTest, FrictionHoldsForAllShapes) {
  change_world(draft_, [&](WorldChange& change) { change.set_friction(find("high"), 0.7); });
  for (const WorldShape& shape : object("high").shapes) {
    EXPECT_EQ(shape.friction, 0.7);
  }
  change_world(draft_, [&](WorldChange& change) { change.set_friction(find("high"), std::nullopt); });
  EXPECT_EQ(text().find("0.7"), std::string::npos);
}

TEST_F(WorldTest, AnObjectThatMovesHasAMass) {
  change_world(draft_, [&](WorldChange& change) { change.set_moves(find("low"), true); });
  EXPECT_TRUE(object("low").moves);
  EXPECT_NEAR(object("low").mass, 500.0 * 1.0 * 0.2 * 0.03, 1e-9);
  change_world(draft_, [&](WorldChange& change) { change.set_mass(find("low"), 2.5); });
  EXPECT_EQ(object("low").mass, 2.5);
  change_world(draft_, [&](WorldChange& change) { change.set_moves(find("low"), false); });
  EXPECT_FALSE(object("low").moves);
  EXPECT_NE(refusal([&](WorldChange& change) { change.set_mass(find("low"), 1.0); }).find("does not move"),
            std::string::npos);
  EXPECT_NE(refusal([&](WorldChange& change) { change.set_mass(find("ball"), 0.0); }).find("<total>"),
            std::string::npos)
      << "the reader refuses it";
}

TEST_F(WorldTest, ObjectsAreRenamedRemovedAndRepeated) {
  change_world(draft_, [&](WorldChange& change) { change.rename(find("ball"), "red \"ball\""); });
  EXPECT_EQ(text(), replaced(world_text, "name=\"ball\"", "name=\"red &quot;ball&quot;\""));
  change_world(draft_, [&](WorldChange& change) { change.remove({find("low")}, false); });
  EXPECT_EQ(object("high").group_size, 1U);
  change_world(draft_, [&](WorldChange& change) { change.duplicate({find("high")}, false, {0, 0.5, 0}, 3); });
  ASSERT_EQ(world().objects.size(), 7U);
  const Pose first = object("high").pose;
  std::size_t found = 0;
  for (const WorldObject& other : world().objects) {
    if (other.name == "high") {
      expect_pose(other.pose,
                  {first.position + static_cast<double>(found) * Eigen::Vector3d(0, 0.5, 0), first.orientation});
      ++found;
    }
  }
  EXPECT_EQ(found, 4U);
  change_world(draft_, [&](WorldChange& change) { change.remove({find("high")}, true); });
  EXPECT_EQ(world().objects.size(), 6U);
}

TEST_F(WorldTest, EveryItemOfTheLibraryIsAWorldThatCanBeSimulated) {
  for (const LibraryDeclaration& item : library()) {
    SCOPED_TRACE(std::string(item.name));
    for (const double LibraryParameter::*extreme :
         {&LibraryParameter::usual, &LibraryParameter::lowest, &LibraryParameter::highest}) {
      Draft draft(files_.scenario(), files_);
      std::map<std::string, double> values;
      for (const LibraryParameter& parameter : item.parameters) {
        values[std::string(parameter.name)] = parameter.*extreme;
      }
      change_world(draft, [&](WorldChange& change) { change.add(item.item, values, {0.3, 2, 0}, 90); });
      EXPECT_TRUE(std::ranges::any_of(read_world_contents(draft).objects,
                                      [&](const WorldObject& object) { return object.name == item.name; }));
      Simulation simulation(draft.scenario());
      for (int i = 0; i < 20; ++i) {
        simulation.advance();
      }
    }
  }
}

TEST_F(WorldTest, TheHighestPointOfAnItemIsWhereItsNumbersSay) {
  struct Row {
    LibraryItem item;
    double highest;
  };
  for (const Row& row : {Row{LibraryItem::box, 0.03},
                         {LibraryItem::stairs, 0.09},
                         {LibraryItem::cylinder, 0.06},
                         {LibraryItem::sphere, 0.1},
                         {LibraryItem::hills, 0.03},
                         {LibraryItem::ramp, std::tan(10.0 * std::numbers::pi / 180.0)}}) {
    Draft draft(files_.scenario(), files_);
    const std::size_t before = draft.scenario().environment.objects.size();
    change_world(draft, [&](WorldChange& change) { change.add(row.item, {}, {5, 5, 0}, 0); });
    const EnvironmentModel& environment = draft.scenario().environment;
    double highest = 0.0;
    for (std::size_t i = before - 1; i < environment.objects.size(); ++i) {  // the pole of the other file is the last
      const StaticObject& object = environment.objects[i];
      if (object.file == "environment.xml") {
        for (const Geometry& geometry : object.geometries) {
          highest = std::max(highest, bounds_of(geometry, object.pose).highest.z());
        }
      }
    }
    EXPECT_NEAR(highest, row.highest, 2e-3) << "item " << static_cast<int>(row.item);
  }
}

TEST_F(WorldTest, ANewObjectHasANameOfItsOwn) {
  for (int i = 0; i < 3; ++i) {
    change_world(draft_, [&](WorldChange& change) { change.add(LibraryItem::box, {}, {0, i + 3.0, 0}, 0); });
  }
  EXPECT_EQ(world().objects.size(), 8U);
  EXPECT_LT(find("box 2"), find("box 3"));
}

TEST_F(WorldTest, TheStartOfTheRobotIsTheCommentOfTheFile) {
  change_world(draft_, [&](WorldChange& change) { change.set_start({0.5, -0.25, 0.03}, {0, 0, 180}); });
  EXPECT_EQ(text(), replaced(world_text, "<!--Pose: ,0 0 0.03,0 0 45,-->", "<!--Pose: ,0.5 -0.25 0.03,0 0 180,-->"));
  files_.replace("environment.xml", "<!--Pose: ,0 0 0.03,0 0 45,-->\n", "");
  Draft draft(files_.scenario(), files_);
  change_world(draft, [&](WorldChange& change) { change.set_start({1, 2, 3}, {0, 0, 0}); });
  EXPECT_LT((draft.scenario().environment.robot_pose.position - Eigen::Vector3d(1, 2, 3)).norm(), 1e-9);
}

TEST_F(WorldTest, RulersAreAddedMovedAndRemoved) {
  change_world(draft_, [&](WorldChange& change) { change.add_ruler({1, 0, 0}, {1, 5, 0}); });
  change_world(draft_, [&](WorldChange& change) { change.set_ruler(0, {0, 1, 0}, {0, 2, 0}); });
  ASSERT_EQ(world().rulers.size(), 2U);
  EXPECT_EQ(world().rulers[0].to, Eigen::Vector3d(0, 2, 0));
  change_world(draft_, [&](WorldChange& change) { change.remove_ruler(1); });
  EXPECT_EQ(text(), replaced(replaced(world_text, "<from>0 0 0", "<from>0 1 0"), "<to>0 3 0", "<to>0 2 0"));
}

TEST_F(WorldTest, WhatCannotBeDoneIsRefusedWithItsReason) {
  const std::size_t pole = find("pole");
  const std::size_t ball = find("ball");
  struct Row {
    std::function<void(WorldChange&)> change;
    const char* reason;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Row& row : std::vector<Row>{
           {[&](WorldChange& change) { change.place(pole, {}, false); }, "'pole' is in pole.xml"},
           {[&](WorldChange& change) { change.place(99, {}, false); }, "object: found 99, expected a number below 5"},
           {[&](WorldChange& change) { change.place(ball, pose_at(nan, 0, 0), false); }, "<Translation>"},
           {[&](WorldChange& change) { change.place(ball, pose_at(1e9, 0, 0), false); }, "<Translation>"},
           {[&](WorldChange& change) {
              change.set_size(ball, 0, {1, 2});
            },
            "2 numbers for 'sphere'"},
           {[&](WorldChange& change) { change.set_size(ball, 0, {0.0}); }, "above 0"},
           {[&](WorldChange& change) { change.set_size(ball, 0, {nan}); }, "above 0"},
           {[&](WorldChange& change) { change.set_size(ball, 1, {1.0}); }, "shape: found 1"},
           {[&](WorldChange& change) { change.set_friction(ball, -1.0); }, "<friction>"},
           {[&](WorldChange& change) {
              change.set_colour(ball, {2, 0, 0});
            },
            "<diffuseColor>"},
           {[&](WorldChange& change) { change.rename(ball, ""); }, "1 to 60 characters"},
           {[&](WorldChange& change) { change.rename(ball, "a\nb"); }, "1 to 60 characters"},
           {[&](WorldChange& change) {
              change.duplicate({ball}, false, {1, 0, 0}, 0);
            },
            "1 to 200"},
           {[&](WorldChange& change) {
              change.duplicate({ball}, false, {1, 0, 0}, 200);
            },
            "more than 200 bodies"},
           {[&](WorldChange& change) {
              change.add(LibraryItem::stairs, {{"steps", 2.5}}, {0, 0, 0}, 0);
            },
            "whole"},
           {[&](WorldChange& change) {
              change.add(LibraryItem::stairs, {{"height", 2}}, {0, 0, 0}, 0);
            },
            "'height'"},
           {[&](WorldChange& change) {
              change.add(LibraryItem::box, {{"width", nan}}, {0, 0, 0}, 0);
            },
            "width"},
           {[&](WorldChange& change) {
              change.add(LibraryItem::box, {}, {0, nan, 0}, 0);
            },
            "out of range"},
           {[&](WorldChange& change) {
              change.add_ruler({0, 0, 0}, {0, 0, 0});
            },
            "ruler"},
           {[&](WorldChange& change) { change.remove_ruler(1); }, "ruler: found 1"},
           {[&](WorldChange& change) {
              change.set_start({nan, 0, 0}, {0, 0, 0});
            },
            "Pose"}}) {
    EXPECT_NE(refusal(row.change).find(row.reason), std::string::npos) << row.reason << "\n" << refusal(row.change);
  }
}

// Many of them in a line, as XML that a program writes has them.
TEST_F(WorldTest, ObjectsInOneLineAreToldApart) {
  files_.replace(
      "environment.xml", "  <ruler>",
      R"(<KinBody name="a"><Body type="static"><Translation>0 5 0</Translation><Geom type="sphere"><radius>0.1</radius></Geom></Body></KinBody><KinBody name="b"><Body type="static"><Translation>0 6 0</Translation><Geom type="sphere"><radius>0.1</radius></Geom></Body></KinBody><ruler>)");
  Draft draft(files_.scenario(), files_);
  const WorldContents now = read_world_contents(draft);
  const auto b = std::ranges::find(now.objects, "b", &WorldObject::name);
  ASSERT_NE(b, now.objects.end());
  change_world(draft, [&](WorldChange& change) {
    change.place(static_cast<std::size_t>(b - now.objects.begin()), pose_at(0, 7, 0), false);
  });
  EXPECT_NE(text_of(draft, "environment.xml").find("<Translation>0 5 0<"), std::string::npos);
  EXPECT_NE(text_of(draft, "environment.xml").find("<Translation>0 7 0<"), std::string::npos);
}

}  // namespace
}  // namespace proleg::sim
