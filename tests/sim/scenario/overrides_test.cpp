// Values of the command line that replace values of the files.

#include "sim/scenario/overrides.hpp"

#include <gtest/gtest.h>

#include "memory_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

Scenario scenario_with(const OverrideWords& words, MemoryFiles files = small_scenario()) {
  return read_scenario("top.xml", files, read_overrides(words));
}

/// Words with only this one.
OverrideWords only(std::optional<std::string> OverrideWords::*word, const std::string& value) {
  OverrideWords words;
  words.*word = value;
  return words;
}

TEST(Overrides, TheSeedReplacesThatOfTheFile) {
  EXPECT_EQ(scenario_with(only(&OverrideWords::seed, "18446744073709551615")).kernel.seed, ~std::uint64_t{0});
  EXPECT_EQ(scenario_with({}).kernel.seed, 7U);
}

TEST(Overrides, TheFrictionReplacesThatOfEveryObjectAndOfNoLink) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "</Environment>",
                "<KinBody name=\"wall\"><Body type=\"static\"><translation>5 0 0</translation><Geom type=\"box\">"
                "<extents>1 1 3</extents></Geom></Body></KinBody></Environment>");
  const Scenario scenario = scenario_with(only(&OverrideWords::friction, "0.75"), files);
  ASSERT_EQ(scenario.environment.objects.size(), 2U);
  for (const StaticObject& object : scenario.environment.objects) {
    EXPECT_EQ(object.geometries.at(0).friction, 0.75) << object.name;
  }
  EXPECT_EQ(scenario.robot.links.back().geometries.at(0).friction, 0.5) << "the tail states its own";
  EXPECT_FALSE(scenario.robot.links.front().geometries.at(0).friction);
}

TEST(Overrides, ThePositionReplacesThatOfTheFileAndKeepsItsHeight) {
  EXPECT_EQ(scenario_with(only(&OverrideWords::at, "1,-2.5")).environment.robot_pose.position,
            Eigen::Vector3d(1.0, -2.5, 0.1));
  EXPECT_EQ(scenario_with(only(&OverrideWords::at, "1,-2.5,0.7")).environment.robot_pose.position,
            Eigen::Vector3d(1.0, -2.5, 0.7));
}

TEST(Overrides, TheRobotIsLiftedOntoTheGroundOfItsNewPosition) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "</Environment>",
                "<KinBody name=\"step\"><Body type=\"static\"><translation>5 0 0</translation><Geom type=\"box\">"
                "<extents>1 1 0.25</extents></Geom></Body></KinBody></Environment>");
  EXPECT_EQ(scenario_with({}, files).environment.robot_pose.position.z(), 0.1) << "it does not start on the step";
  EXPECT_NEAR(scenario_with(only(&OverrideWords::at, "5,0"), files).environment.robot_pose.position.z(), 0.25 + 0.03,
              1e-12);
}

TEST(Overrides, TheHeadingTurnsTheStartPoseToTheLeft) {
  const Pose& pose = scenario_with(only(&OverrideWords::heading, "90")).environment.robot_pose;
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitX(), 1e-12))
      << "to the left of the y axis is the negative x axis";
  EXPECT_EQ(pose.position, Eigen::Vector3d(0, 0, 0.1));

  MemoryFiles lying = small_scenario();
  lying.replace("environment.xml", "0 0 0.1,0 0 0,", "0 0 0.5,0 90 0,");
  const Pose& turned = scenario_with(only(&OverrideWords::heading, "90"), lying).environment.robot_pose;
  // The turn of the file moves x to -z, which a turn about the vertical does not move.
  EXPECT_TRUE((turned.orientation * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(Overrides, TheEngineReplacesThatOfTheEnvironment) {
  EXPECT_EQ(scenario_with({}).environment.engine, PhysicsEngine::ode);
  EXPECT_EQ(scenario_with(only(&OverrideWords::engine, "reduced")).environment.engine, PhysicsEngine::reduced);
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "type=\"ode\"", "type=\"reduced\"");
  EXPECT_EQ(scenario_with({}, files).environment.engine, PhysicsEngine::reduced);
  EXPECT_EQ(scenario_with(only(&OverrideWords::engine, "ode"), files).environment.engine, PhysicsEngine::ode);
}

TEST(Overrides, TheirWordsGiveTheSameOverrides) {
  OverrideWords words;
  words.engine = "reduced";
  words.seed = "18446744073709551615";
  words.friction = "0.75";
  words.at = "1,-2.5,0.7";
  words.heading = "-90";
  for (const OverrideDeclaration& declaration : override_declarations()) {
    EXPECT_EQ(words_of(read_overrides(words)).*declaration.word, words.*declaration.word) << declaration.name;
    EXPECT_EQ(words_of({}).*declaration.word, std::nullopt) << declaration.name;
  }
}

TEST(Overrides, RefuseBadWords) {
  const auto expect_refused = [](std::optional<std::string> OverrideWords::*word, const std::string& option,
                                 std::initializer_list<const char*> values, const std::string& expected) {
    for (const char* value : values) {
      const std::string message = message_of<InputError>([&] { static_cast<void>(read_overrides(only(word, value))); });
      EXPECT_EQ(message, option + ": found '" + value + "', expected " + expected);
    }
  };
  expect_refused(&OverrideWords::engine, "--engine", {"", "ODE", "bullet", "reduced "}, "'ode', 'reduced' or 'mujoco'");
  expect_refused(&OverrideWords::seed, "--seed", {"", "-1", "1.5", "one", "18446744073709551616"},
                 "a whole number from 0 to 18446744073709551615");
  expect_refused(&OverrideWords::friction, "--friction", {"", "-0.1", "1001", "nan", "inf", "ice"}, "0 to 1000");
  expect_refused(&OverrideWords::at, "--at", {"", "1", "1,", "1,2,", "1,2,3,4", "1;2", "1,nan", "1,10001"},
                 "X,Y or X,Y,Z, each -10000 to 10000 m");
  expect_refused(&OverrideWords::heading, "--heading", {"", "361", "-361", "north"}, "-360 to 360 degrees");
}

}  // namespace
}  // namespace proleg::sim
