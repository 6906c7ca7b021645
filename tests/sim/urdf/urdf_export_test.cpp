// The shipped robots in URDF, and back: the same chain in the same frames.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imported.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/urdf/urdf_export.hpp"

namespace proleg::sim {
namespace {

std::vector<std::filesystem::path> shipped_scenarios() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    if (entry.path().string().ends_with(".simulation.xml")) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

UrdfImport imported_again(const UrdfExport& from) {
  SourceTexts files;
  files.add("robot.urdf", from.text);
  for (const SourceFile& mesh : from.meshes) {
    files.add(mesh.path, mesh.text);
  }
  return import_urdf("robot.urdf", files);
}

/// Mass, centre and inertia in the robot's frame.
MassProperties in_robot(const Link& link) {
  const Eigen::Matrix3d rotation = link.pose.orientation.toRotationMatrix();
  return {link.mass.mass, link.pose * link.mass.center, rotation * link.mass.inertia * rotation.transpose()};
}

void expect_same(const RobotModel& robot, const RobotModel& again) {
  constexpr double rounding = 1e-9;
  constexpr double mesh_rounding = 1e-6;  // m: the numbers of an STL file have 24 bits
  ASSERT_EQ(again.joints.size(), robot.joints.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    const Joint& same = again.joints[j];
    EXPECT_EQ(same.name, joint.name);
    EXPECT_EQ(same.file_index, joint.file_index);
    EXPECT_LT((same.anchor - joint.anchor).norm(), rounding);
    EXPECT_LT((same.axis - joint.axis).norm(), rounding);
    EXPECT_NEAR(same.lower_limit, joint.lower_limit, rounding);
    EXPECT_NEAR(same.upper_limit, joint.upper_limit, rounding);
    EXPECT_EQ(same.max_torque, joint.max_torque);
    EXPECT_EQ(same.max_speed, joint.max_speed);
  }
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const MassProperties mass = in_robot(robot.links[i]);
    const MassProperties same = in_robot(again.links[i]);
    EXPECT_EQ(again.links[i].name, robot.links[i].name);
    EXPECT_EQ(same.mass, mass.mass);
    EXPECT_LT((same.center - mass.center).norm(), rounding);
    EXPECT_LT((same.inertia - mass.inertia).norm(), rounding * mass.inertia.norm());
    const std::vector<Geometry>& solids = robot.links[i].geometries;
    ASSERT_EQ(again.links[i].geometries.size(), solids.size());
    // URDF has one friction for a link; the export says which links lose theirs.
    const bool has_one_friction =
        std::ranges::all_of(solids, [&](const Geometry& solid) { return solid.friction == solids.front().friction; });
    for (std::size_t g = 0; g < solids.size(); ++g) {
      const Geometry& solid = solids[g];
      const Geometry& same_solid = again.links[i].geometries[g];
      const Bounds bounds = bounds_of(solid, robot.links[i].pose);
      const Bounds same_bounds = bounds_of(same_solid, again.links[i].pose);
      EXPECT_LT((same_bounds.lowest - bounds.lowest).norm(), mesh_rounding);
      EXPECT_LT((same_bounds.highest - bounds.highest).norm(), mesh_rounding);
      EXPECT_EQ(same_solid.shape, solid.shape);
      EXPECT_EQ(same_solid.friction, has_one_friction ? solid.friction : std::nullopt);
    }
  }
}

TEST(UrdfExport, AShippedRobotComesBackAsItWas) {
  const std::vector<std::filesystem::path> files = shipped_scenarios();
  ASSERT_GE(files.size(), 30U);
  DiskFiles disk;
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file.string());
    const Scenario scenario = read_scenario(file, disk);
    const UrdfImport import = imported_again(export_urdf(scenario.robot, "robot_meshes"));
    const Scenario again = scenario_of(import);
    expect_same(scenario.robot, again.robot);
    for (std::size_t j = 0; j < scenario.joint_limits.size(); ++j) {
      EXPECT_EQ(again.joint_limits[j].lower, scenario.joint_limits[j].lower);
      EXPECT_EQ(again.joint_limits[j].upper, scenario.joint_limits[j].upper);
    }
  }
}

TEST(UrdfExport, AnObliqueCylinderAndAnAnchorAwayFromTheOriginComeBack) {
  SourceTexts files;
  files.add(
      "top",
      std::string("<simulation><robot>r</robot><actuation>a</actuation><environment>e</environment></simulation>"));
  files.add(
      "r",
      std::string(
          "<Robot name=\"a &amp; b\"><KinBody><rotationaxis>1 2 3 40</rotationaxis>"
          "<Body name=\"base_link\"><translation>0 -1 0</translation><Geom type=\"cylinder\"><rotationaxis>1 0 1 "
          "70</rotationaxis>"
          "<radius>0.1</radius><height>0.6</height><friction>0.3</friction></Geom><Mass "
          "type=\"mimicgeom\"><total>2</total></Mass></Body>"
          "<Body name=\"base\"><rotationaxis>0 1 0 90</rotationaxis><Geom type=\"sphere\"><radius>0.2</radius></Geom>"
          "<Mass type=\"mimicgeom\"><total>3</total></Mass></Body>"
          "<Joint name=\"j\" "
          "type=\"hinge\"><body>base</body><body>base_link</body><offsetfrom>base</offsetfrom><anchor>0 -0.5 "
          "0.1</anchor>"
          "<axis>1 1 0</axis><maxtorque>1</maxtorque><maxvel>2</maxvel><limitsdeg>-33.3 "
          "44.4</limitsdeg></Joint></KinBody></Robot>"));
  files.add(
      "a",
      std::string("<actuation><actuationModule name=\"PatternGenerator_sinusoidal\"><jointConfiguration joints=\"1\"/>"
                  "</actuationModule></actuation>"));
  files.add("e", std::string("<Environment/>"));
  const Scenario scenario = read_scenario("top", files);
  const UrdfExport urdf = export_urdf(scenario.robot, "m");
  const Scenario again = scenario_of(imported_again(urdf));
  ASSERT_EQ(again.robot.links[0].name, scenario.robot.links[0].name);
  expect_same(scenario.robot, again.robot);
}

TEST(UrdfExport, AJointThatDoesNotMoveComesBack) {
  DiskFiles disk;
  Scenario scenario = read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), disk);
  scenario.robot.joints[2].lower_limit = 0.0;
  scenario.robot.joints[2].upper_limit = 0.0;
  const UrdfImport import = imported_again(export_urdf(scenario.robot, "m"));
  EXPECT_NE(joined(import.notes).find("it does not move"), std::string::npos);
  expect_same(scenario.robot, scenario_of(import).robot);
}

TEST(UrdfExport, SaysWhatUrdfHasNot) {
  DiskFiles disk;
  const Scenario scenario = read_scenario(source_path("/sim/scenarios/gaits/serpenoid.simulation.xml"), disk);
  const std::string lost = joined(export_urdf(scenario.robot, "m").lost);
  EXPECT_NE(lost.find("the servos (gain 50 1/s)"), std::string::npos) << lost;
  const Scenario cubo = read_scenario(source_path("/sim/scenarios/robots/cubo/robot.simulation.xml"), disk);
  const std::string lost_of_cubo = joined(export_urdf(cubo.robot, "m").lost);
  EXPECT_NE(lost_of_cubo.find("the friction of link 'Head', whose geometries have different ones"), std::string::npos);
}

}  // namespace
}  // namespace proleg::sim
