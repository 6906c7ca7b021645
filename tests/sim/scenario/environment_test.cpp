#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "memory_files.hpp"

namespace proleg::sim {
namespace {

TEST(Environment, ThePoseCommentTurnsAboutXThenYThenZ) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "Pose: ,0 0 0.1,0 0 0,", " pose: , 1 -2  3 ,90 90 0, ");
  const Pose& pose = files.scenario().environment.robot_pose;
  EXPECT_EQ(pose.position, Eigen::Vector3d(1, -2, 3));
  // The turn about x moves y to z; the turn about y moves it on to x.
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  // The first turn does not move x; the second moves it to -z.
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(Environment, TheTurnAboutZComesLast) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "Pose: ,0 0 0.1,0 0 0,", "Pose: ,0 0 9,90 0 90,");
  const Pose& pose = files.scenario().environment.robot_pose;
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(Environment, WithoutAPoseTheRobotStartsAtTheOrigin) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "Pose: ,0 0 0.1,0 0 0,", "a floor").replace("environment.xml", "0 0 -0.5", "0 0 -9");
  EXPECT_EQ(files.scenario().environment.robot_pose.position, Eigen::Vector3d::Zero());
}

TEST(Environment, ARobotAboveTheGroundIsNotMoved) {
  const Scenario scenario = small_scenario().scenario();
  EXPECT_EQ(scenario.environment.robot_pose.position.z(), 0.1);
  EXPECT_EQ(scenario.remarks.size(), 1U) << "only the joint map";
}

TEST(Environment, TheOtherEnginesHaveThePropertiesOfOde) {
  const std::pair<const char*, PhysicsEngine> reduced{"Reduced", PhysicsEngine::reduced};
  const std::pair<const char*, PhysicsEngine> mujoco{"mujoco", PhysicsEngine::mujoco};
  for (const auto& [properties, engine] : {std::pair("odeproperties", reduced), std::pair("reducedproperties", reduced),
                                           std::pair("odeproperties", mujoco), std::pair("mujocoproperties", mujoco)}) {
    MemoryFiles files = small_scenario();
    files.replace("environment.xml", "type=\"ode\"", "type=\"" + std::string(engine.first) + "\"")
        .replace("environment.xml", "<odeproperties>", "<" + std::string(properties) + ">")
        .replace("environment.xml", "</odeproperties>", "</" + std::string(properties) + ">")
        .replace("environment.xml", "0 0 -9.81", "0 0 -1.62");
    const Scenario scenario = files.scenario();
    EXPECT_EQ(scenario.environment.engine, engine.second);
    EXPECT_EQ(scenario.environment.gravity, Eigen::Vector3d(0, 0, -1.62)) << properties;
    EXPECT_TRUE(scenario.environment.self_collision) << properties;
  }
}

/// Start height of a robot whose only low part is the head's geometry, on a floor with its top at 0.
double height_with_head(const std::string& geometry) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<Geom type=\"sphere\">\n        <radius>0.03</radius>\n      </Geom>", geometry);
  files.replace("environment.xml", "0 0 0.1,", "0 0 0,");
  return files.scenario().environment.robot_pose.position.z();
}

TEST(Environment, TheLowestPointOfASphereIsItsRadiusBelowItsCentre) {
  EXPECT_NEAR(height_with_head("<Geom type=\"sphere\"><radius>0.3</radius><translation>0 0 0.1</translation></Geom>"),
              0.2, 1e-12);
}

TEST(Environment, TheLowestPointOfATurnedBoxIsACorner) {
  EXPECT_NEAR(height_with_head("<Geom type=\"box\"><extents>0.1 0.2 0.3</extents><rotationaxis>1 0 0 30</rotationaxis>"
                               "</Geom>"),
              0.2 * std::sin(std::numbers::pi / 6) + 0.3 * std::cos(std::numbers::pi / 6), 1e-12);
}

TEST(Environment, TheLowestPointOfATurnedCylinderIsOnItsRim) {
  // Axis along y, raised by 30 degrees: half the height by its sine, the radius by its cosine.
  EXPECT_NEAR(height_with_head("<Geom type=\"cylinder\"><radius>0.1</radius><height>0.8</height>"
                               "<rotationaxis>1 0 0 30</rotationaxis></Geom>"),
              0.4 * 0.5 + 0.1 * std::sqrt(0.75), 1e-12);
}

TEST(Environment, ALiftIsRemarked) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "0 0 0.1,", "0 0 0.01,");
  const Scenario scenario = files.scenario();
  EXPECT_NEAR(scenario.environment.robot_pose.position.z(), 0.03, 1e-15);
  EXPECT_EQ(scenario.remarks.back(),
            "the robot starts 20 mm higher than its start pose says, so that it rests on 'floor'");
}

TEST(Environment, TheRobotRestsOnTheHighestObjectBelowItsStart) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "</Environment>", R"(
    <KinBody name="step"><Body type="static"><Geom type="box"><extents>1 1 0.25</extents></Geom></Body></KinBody>
    <KinBody name="wall"><Body type="static"><translation>5 0 0</translation>
      <Geom type="box"><extents>1 1 3</extents></Geom></Body></KinBody>
    </Environment>)");
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.environment.objects.size(), 3U);
  EXPECT_NEAR(scenario.environment.robot_pose.position.z(), 0.25 + 0.03, 1e-12);
  EXPECT_NE(scenario.remarks.back().find("'step'"), std::string::npos);
}

/// A bar under the head and not under the robot's start position; its box reaches `half_height` (m) up and down from 0.
MemoryFiles with_bar_under_head(const std::string& half_height) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "</Environment>",
                "<KinBody name=\"bar\"><Body type=\"static\"><translation>0 0.2 0</translation><Geom type=\"box\">"
                "<extents>1 0.15 " +
                    half_height + "</extents></Geom></Body></KinBody></Environment>");
  return files;
}

TEST(Environment, ARobotOfWhichOneLinkIsInAHillIsLifted) {
  const Scenario flat = small_scenario().scenario();
  const Scenario scenario = with_bar_under_head("0.15").scenario();
  EXPECT_EQ(scenario.warnings, flat.warnings);
  EXPECT_GT(scenario.environment.robot_pose.position.z(), flat.environment.robot_pose.position.z());
  EXPECT_NE(scenario.remarks.back().find("so that it rests on 'bar'"), std::string::npos);
}

TEST(Environment, ARobotOfWhichOneLinkIsInAWallIsNotLifted) {
  const Scenario flat = small_scenario().scenario();
  const Scenario scenario = with_bar_under_head("0.8").scenario();
  EXPECT_EQ(scenario.environment.robot_pose.position.z(), flat.environment.robot_pose.position.z());
  ASSERT_GT(scenario.warnings.size(), flat.warnings.size());
  EXPECT_NE(scenario.warnings.back().find("inside 'bar'"), std::string::npos);
}

/// Where the robot starts with more objects in the world and its pose at this height.
Scenario among(const std::string& geometries, const std::string& height = "0.03") {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "0 0 0.1,", "0 0 " + height + ",");
  files.replace("environment.xml", "</Environment>",
                "<KinBody name=\"thing\"><Body type=\"static\">" + geometries + "</Body></KinBody></Environment>");
  return files.scenario();
}

TEST(Environment, WhatIsAboveTheRobotOrBesideItDoesNotLiftIt) {
  const double on_the_floor =
      among("<Geom type=\"box\"><translation>9 9 0</translation><extents>1 1 1</extents></Geom>")
          .environment.robot_pose.position.z();
  for (const char* geometries :
       {"<Geom type=\"box\"><translation>0 0 2.5</translation><extents>4 4 0.1</extents></Geom>",   // a ceiling
        "<Geom type=\"box\"><translation>0 0 0.5</translation><extents>1 1 0.01</extents></Geom>",  // of a tunnel
        "<Geom type=\"box\"><translation>0.5 0 0</translation><extents>0.1 2 0.3</extents></Geom>"  // a corridor
        "<Geom type=\"box\"><translation>-0.5 0 0</translation><extents>0.1 2 0.3</extents></Geom>",
        // A wall across the corner: only its bounds contain the robot.
        "<Geom type=\"box\"><translation>0.8 0.8 0</translation><rotationaxis>0 0 1 45</rotationaxis>"
        "<extents>0.05 2 0.2</extents></Geom>",
        // A dome, beside which the floor is free.
        "<Geom type=\"sphere\"><translation>1.5 1.5 -1.9</translation><radius>2</radius></Geom>"}) {
    const Scenario scenario = among(geometries);
    EXPECT_EQ(scenario.environment.robot_pose.position.z(), on_the_floor) << geometries;
    EXPECT_TRUE(scenario.warnings.empty()) << geometries;
  }
}

TEST(Environment, ARobotInASlopeIsLiftedUntilItIsOutAndNotOntoItsHighestPoint) {
  // The slope rises towards the head, 20 degrees; its surface goes through the origin.
  const std::string slope =
      "<Geom type=\"box\"><translation>0 0.171 -0.4698</translation><rotationaxis>1 0 0 20</rotationaxis>"
      "<extents>8 8 0.5</extents></Geom>";
  const double tangent = std::tan(20.0 * std::numbers::pi / 180.0);
  const Scenario scenario = among(slope, "0");
  const double height = scenario.environment.robot_pose.position.z();
  // The head is 0.2 m in front, with a radius of 0.03.
  EXPECT_GT(height, 0.2 * tangent);
  EXPECT_LT(height, 0.23 * tangent + 0.04);
  EXPECT_TRUE(scenario.warnings.empty());
  EXPECT_EQ(among(slope, "0.5").environment.robot_pose.position.z(), 0.5) << "above it";
}

TEST(Environment, ARobotBelowAllIsLiftedOntoTheLowestOfIt) {
  MemoryFiles files = small_scenario();
  files.replace("environment.xml", "0 0 0.1,", "0 0 -7,");
  EXPECT_NEAR(files.scenario().environment.robot_pose.position.z(), 0.03, 1e-12);
}

TEST(Environment, ObjectsMayComeFromFilesAndKeepTheirPose) {
  MemoryFiles files = small_scenario();
  files.texts["step.xml"] =
      "<KinBody name=\"step\"><Body name=\"b\" type=\"static\"><translation>0 1 0</translation>"
      "<Geom type=\"box\"><extents>1 1 1</extents></Geom></Body></KinBody>";
  files.replace("environment.xml", "</Environment>",
                "<KinBody file=\"step.xml\" prefix=\"far\"><rotationaxis>0 0 1 90</rotationaxis>"
                "<translation>100 0 0</translation></KinBody></Environment>");
  const Scenario scenario = files.scenario();
  const StaticObject& step = scenario.environment.objects.back();
  EXPECT_EQ(step.name, "farb");
  EXPECT_TRUE(step.pose.position.isApprox(Eigen::Vector3d(99, 0, 0)));
}

}  // namespace
}  // namespace proleg::sim
