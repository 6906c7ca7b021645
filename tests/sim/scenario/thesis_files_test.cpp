// The files of the thesis (listings B.1, B.2, B.5, B.6) as printed there, and module files, which the thesis omits. The
// expected values are those of the listings.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "shared/gait/registry.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

Scenario thesis_scenario() {
  DiskFiles files;
  return read_scenario(source_path("/tests/sim/scenario/thesis/MFIdemo.simulation.xml"), files);
}

TEST(ThesisFiles, LinksAreOrderedFromTheHeadAndHaveTheTranslationsOfTheFile) {
  const Scenario scenario = thesis_scenario();
  const std::vector<std::pair<std::string, double>> expected{{"Head", 0.288}, {"4Seg", 0.216}, {"3Seg", 0.144},
                                                             {"2Seg", 0.072}, {"1Seg", 0.0},   {"Tail", 0.0}};
  ASSERT_EQ(scenario.robot.links.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Link& link = scenario.robot.links[i];
    EXPECT_EQ(link.name, expected[i].first);
    EXPECT_EQ(link.pose.position, Eigen::Vector3d(0.0, expected[i].second, 0.0));
    EXPECT_TRUE(link.pose.orientation.isApprox(Eigen::Quaterniond::Identity()));
    ASSERT_EQ(link.geometries.size(), 1U);
    EXPECT_EQ(link.geometries[0].shape, Shape::box);
  }
  EXPECT_EQ(scenario.robot.name, "MFIdemo_5py");
}

TEST(ThesisFiles, KernelJointZeroIsTheHeadsJoint) {
  const Scenario scenario = thesis_scenario();
  ASSERT_EQ(scenario.robot.joints.size(), 5U);
  EXPECT_EQ(scenario.kernel.joint_count, 5);
  for (std::size_t j = 0; j < 5; ++j) {
    EXPECT_EQ(scenario.robot.joints[j].name, "J" + std::to_string(5 - j));
    EXPECT_EQ(scenario.robot.joints[j].file_index, 4 - j);
    EXPECT_EQ(scenario.robot.joints[j].anchor.y(), scenario.robot.links[j].pose.position.y());
  }
  EXPECT_EQ(
      std::ranges::count(scenario.remarks,
                         "joints from the head, where recordings count from 0: J5 (Head - 4Seg), J4 (4Seg - 3Seg), "
                         "J3 (3Seg - 2Seg), J2 (2Seg - 1Seg), J1 (1Seg - Tail)"),
      1);
}

TEST(ThesisFiles, AxesKeepTheirSignBecauseTheFileListsTheHeadwardBodySecond) {
  const Scenario scenario = thesis_scenario();
  for (std::size_t j = 0; j < 5; ++j) {
    const bool pitch = j % 2 == 0;
    EXPECT_EQ(scenario.robot.joints[j].axis, pitch ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ());
  }
}

TEST(ThesisFiles, JointsHaveTheirServoData) {
  const Scenario scenario = thesis_scenario();
  for (std::size_t j = 0; j < 5; ++j) {
    const Joint& joint = scenario.robot.joints[j];
    EXPECT_EQ(joint.max_torque, 0.4);
    EXPECT_EQ(joint.max_speed, 4.5);
    EXPECT_DOUBLE_EQ(joint.lower_limit, -std::numbers::pi / 2);
    EXPECT_DOUBLE_EQ(joint.upper_limit, std::numbers::pi / 2);
    EXPECT_EQ(scenario.joint_limits[j].lower, -(1 << 30));
    EXPECT_EQ(scenario.joint_limits[j].upper, 1 << 30);
  }
  // The OpenMR servo plug-in's values, as the listings have none.
  EXPECT_EQ(scenario.robot.servo.gain, 8.3);
  EXPECT_EQ(scenario.robot.servo.period_us, 20'000U);
}

TEST(ThesisFiles, AMassWithoutComAndInertiaTakesBothFromTheGeometry) {
  const Scenario scenario = thesis_scenario();
  const MassProperties& segment = scenario.robot.links[1].mass;
  EXPECT_EQ(segment.mass, 0.05);
  EXPECT_TRUE(segment.center.isApprox(Eigen::Vector3d(0, 0.036, 0)));
  // m/12 (a^2 + b^2) for a box of 52 x 72 x 52 mm.
  EXPECT_NEAR(segment.inertia(0, 0), 0.05 / 12 * (0.072 * 0.072 + 0.052 * 0.052), 1e-15);
  EXPECT_NEAR(segment.inertia(1, 1), 0.05 / 12 * (0.052 * 0.052 + 0.052 * 0.052), 1e-15);
}

TEST(ThesisFiles, MasksCountJointsFromTheFirstOfTheRobotFile) {
  Scenario scenario = thesis_scenario();
  const auto& slots = scenario.kernel.slots;
  EXPECT_EQ(slots[0].algorithm, find_algorithm("DirectJointAccess"));
  EXPECT_EQ(slots[0].group, JointMask(0b01010));
  EXPECT_EQ(slots[1].algorithm, find_algorithm("PatternGenerator_sinusoidal"));
  EXPECT_EQ(slots[1].group, JointMask(0b10101));
  EXPECT_EQ(slots[2].algorithm, nullptr);
  EXPECT_TRUE(scenario.settings.empty()) << "the listings have no parameters, so the defaults hold";
}

TEST(ThesisFiles, TheEnvironmentIsAFloorWithItsTopAtZero) {
  const Scenario scenario = thesis_scenario();
  EXPECT_EQ(scenario.environment.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_TRUE(scenario.environment.self_collision);
  ASSERT_EQ(scenario.environment.objects.size(), 1U);
  const StaticObject& floor = scenario.environment.objects[0];
  EXPECT_EQ(floor.name, "floor");
  EXPECT_EQ(floor.pose.position, Eigen::Vector3d(0, 0, -0.003));
  ASSERT_EQ(floor.geometries.size(), 1U);
  EXPECT_EQ(floor.geometries[0].extents, Eigen::Vector3d(8, 8, 0.003));
  EXPECT_EQ(floor.geometries[0].friction, 0.1);
}

TEST(ThesisFiles, TheRobotIsLiftedOutOfTheFloor) {
  const Scenario scenario = thesis_scenario();
  EXPECT_NEAR(scenario.environment.robot_pose.position.z(), 0.026, 1e-15);
  EXPECT_TRUE(std::ranges::any_of(scenario.remarks, [](const std::string& remark) {
    return remark.find("26 mm higher") != std::string::npos && remark.find("'floor'") != std::string::npos;
  }));
}

TEST(ThesisFiles, EveryFileIsKeptOnceForTheRecording) {
  const Scenario scenario = thesis_scenario();
  // Top, robot, four module files (two of them named twice), actuation, environment.
  ASSERT_EQ(scenario.sources.size(), 8U);
  EXPECT_TRUE(scenario.sources.front().path.ends_with("MFIdemo.simulation.xml"));
  EXPECT_TRUE(scenario.sources.front().text.str().starts_with("<simulation>"));
}

TEST(ThesisFiles, TagsWithoutEffectGetARemark) {
  const Scenario scenario = thesis_scenario();
  const auto mentions = [&](const std::string& text) {
    return std::ranges::any_of(scenario.remarks,
                               [&](const std::string& remark) { return remark.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(mentions("MFIdemo.simulation.xml:6: <showViewer> has no effect"));
  EXPECT_TRUE(mentions("MFIdemo.simulation.xml:8: <storingData> has no effect"));
  EXPECT_TRUE(mentions("MFIdemo.simulation.xml:10: <accuracy> has no effect"));
  EXPECT_FALSE(mentions("<mode>")) << "a single run is what happens";
}

}  // namespace
}  // namespace proleg::sim
