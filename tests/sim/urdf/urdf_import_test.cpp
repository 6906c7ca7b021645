// What an import makes of masses, frames, limits, meshes, and its first gait. Expected values come from closed forms.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "imported.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/robot/bounds.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

using std::numbers::pi;

constexpr double rounding = 1e-9;

std::string inertial(const std::string& mass, const std::string& origin, double xx, double yy, double zz) {
  return "<inertial>" + origin + "<mass value=\"" + mass + "\"/><inertia ixx=\"" + std::to_string(xx) +
         "\" ixy=\"0\" ixz=\"0\" iyy=\"" + std::to_string(yy) + "\" iyz=\"0\" izz=\"" + std::to_string(zz) +
         "\"/></inertial>";
}

const std::string box = "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>";

/// A cube of 0.1 m and 6 kg, whose moments are 0.01 kg m^2, with its centre at x.
std::string cube(const std::string& x) {
  return inertial("6", "<origin xyz=\"" + x + " 0 0\"/>", 0.01, 0.01, 0.01) + box;
}

std::string link(const std::string& name, const std::string& contents) {
  return "<link name=\"" + name + "\">" + contents + "</link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& origin, const std::string& axis = "0 1 0",
                  const std::string& limit = "lower=\"-1\" upper=\"1\" effort=\"2\" velocity=\"3\"") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><origin " + origin + "/><axis xyz=\"" + axis + "\"/>" +
         (type == "fixed" ? "" : "<limit " + limit + "/>") + "</joint>\n";
}

std::string robot(const std::string& contents) { return "<robot name=\"r\">\n" + contents + "</robot>\n"; }

/// Two cubes, the second one in front of the joint.
std::string two_cubes(const std::string& axis, const std::string& limit) {
  return robot(link("rear", cube("0")) + link("front", cube("0.05")) +
               joint("j", "revolute", "rear", "front", "xyz=\"0.05 0 0\"", axis, limit));
}

TEST(UrdfImport, LinksAtFixedJointsAreOneSolid) {
  // Two cubes side by side are a box of 0.2 x 0.1 x 0.1 m and 12 kg: 0.02 about its long axis, 0.05 across. The second
  // one is turned, and its inertial frame too, which changes nothing of a cube.
  const Scenario scenario = scenario_of(
      import_text(robot(link("base", "") + link("a", cube("0")) + link("b", cube("0")) + link("c", cube("0.05")) +
                        joint("f0", "fixed", "base", "a", "xyz=\"0 0 1\"") +
                        joint("f1", "fixed", "a", "b", "xyz=\"0.1 0 0\" rpy=\"0 1.5707963267948966 0\"") +
                        joint("j", "revolute", "b", "c", "xyz=\"0 0 0.05\" rpy=\"0 -1.5707963267948966 0\""))));
  ASSERT_EQ(scenario.robot.links.size(), 2U);
  const Link& whole = scenario.robot.links[1];
  EXPECT_EQ(whole.name, "a");  // the first one with a mass or a shape
  EXPECT_EQ(whole.geometries.size(), 2U);
  EXPECT_NEAR(whole.mass.mass, 12.0, rounding);
  EXPECT_TRUE(whole.mass.center.isApprox(Eigen::Vector3d(0.05, 0.0, 0.0), rounding));
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.02, 0.05, 0.05).asDiagonal();
  EXPECT_TRUE(whole.mass.inertia.isApprox(expected, 1e-6)) << whole.mass.inertia;
  EXPECT_TRUE(scenario.robot.joints[0].anchor.isApprox(Eigen::Vector3d(0.0, 0.15, 1.0), 1e-9));
}

TEST(UrdfImport, AnInertiaIsTurnedWithItsFrame) {
  const std::string turned = inertial("1", "<origin rpy=\"0 0 1.5707963267948966\"/>", 0.001, 0.002, 0.0025) + box;
  const Scenario scenario = scenario_of(import_text(robot(link("rear", turned) + link("front", cube("0")) +
                                                          joint("j", "revolute", "rear", "front", "xyz=\"0.1 0 0\""))));
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.002, 0.001, 0.0025).asDiagonal();
  EXPECT_TRUE(scenario.robot.links[1].mass.inertia.isApprox(expected, 1e-9));
}

Eigen::Matrix3d rotation(double roll, double pitch, double yaw) {
  Eigen::Matrix3d x;
  Eigen::Matrix3d y;
  Eigen::Matrix3d z;
  x << 1, 0, 0, 0, std::cos(roll), -std::sin(roll), 0, std::sin(roll), std::cos(roll);
  y << std::cos(pitch), 0, std::sin(pitch), 0, 1, 0, -std::sin(pitch), 0, std::cos(pitch);
  z << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
  return z * y * x;
}

TEST(UrdfImport, FramesAreThoseOfTheJointsTurnedForwards) {
  const Scenario scenario = scenario_of(
      import_text(robot(link("a", cube("0")) + link("b", cube("0")) + link("c", cube("0")) +
                        joint("j1", "revolute", "a", "b", "xyz=\"0.2 0.1 -0.3\" rpy=\"0.3 -0.4 0.5\"", "1 2 -1") +
                        joint("j2", "revolute", "b", "c", "xyz=\"0.1 0 0.2\" rpy=\"-0.7 0.2 0.1\"", "0 0 1"))));
  const Eigen::Matrix3d forwards = rotation(0.0, 0.0, pi / 2.0);
  const Eigen::Matrix3d b = forwards * rotation(0.3, -0.4, 0.5);
  const Eigen::Matrix3d c = b * rotation(-0.7, 0.2, 0.1);
  const Eigen::Vector3d at_b = forwards * Eigen::Vector3d(0.2, 0.1, -0.3);
  const Eigen::Vector3d at_c = at_b + b * Eigen::Vector3d(0.1, 0.0, 0.2);
  const std::vector<Joint>& joints = scenario.robot.joints;  // from the head: c is farther forwards
  ASSERT_EQ(joints.size(), 2U);
  EXPECT_EQ(joints[0].name, "j2");
  EXPECT_TRUE(joints[0].anchor.isApprox(at_c, rounding));
  EXPECT_TRUE(joints[1].anchor.isApprox(at_b, rounding));
  EXPECT_TRUE(joints[0].axis.isApprox(c * Eigen::Vector3d::UnitZ(), rounding));
  EXPECT_TRUE(joints[1].axis.isApprox(b * Eigen::Vector3d(1.0, 2.0, -1.0).normalized(), rounding));
  EXPECT_TRUE(scenario.robot.links[0].pose.orientation.toRotationMatrix().isApprox(c, rounding));
  EXPECT_EQ(joints[0].max_torque, 2.0);
  EXPECT_EQ(joints[0].max_speed, 3.0);
}

TEST(UrdfImport, AnAngleTurnsTheChildWhereverTheRootIs) {
  // The angle of Proleg turns the part towards the head. With the root at the head the child is the other part.
  const std::string name = "head_of_robot_head";
  const std::string front_root = robot(link(name, cube("0")) + link("tail", cube("-0.05")) +
                                       joint("j", "revolute", name, "tail", "xyz=\"-0.05 0 0\"", "0 0 1"));
  const Scenario at_head = scenario_of(import_text(front_root));
  EXPECT_EQ(at_head.robot.links[0].name, name);
  EXPECT_TRUE(at_head.robot.joints[0].axis.isApprox(-Eigen::Vector3d::UnitZ(), rounding));
  const Scenario at_tail =
      scenario_of(import_text(two_cubes("0 0 1", "lower=\"-1\" upper=\"1\" effort=\"2\" velocity=\"3\"")));
  EXPECT_EQ(at_tail.robot.links[0].name, "front");
  EXPECT_TRUE(at_tail.robot.joints[0].axis.isApprox(Eigen::Vector3d::UnitZ(), rounding));
}

TEST(UrdfImport, LimitsWithout0MoveTheZeroAngleIntoTheirMiddle) {
  // The front is bent down by 1 rad: its centre is 0.05 m from the joint.
  const UrdfImport import = import_text(two_cubes("0 1 0", "lower=\"0.5\" upper=\"1.5\" effort=\"2\" velocity=\"3\""));
  const Scenario scenario = scenario_of(import);
  EXPECT_NEAR(scenario.robot.joints[0].lower_limit, -0.5, rounding);
  EXPECT_NEAR(scenario.robot.joints[0].upper_limit, 0.5, rounding);
  const Eigen::Vector3d center = scenario.robot.links[0].pose * scenario.robot.links[0].mass.center;
  EXPECT_TRUE(center.isApprox(Eigen::Vector3d(0.0, 0.05 + 0.05 * std::cos(1.0), -0.05 * std::sin(1.0)), rounding));
}

TEST(UrdfImport, ACylinderLiesAlongItsZAxis) {
  const std::string cylinder = inertial("1", "", 0.01, 0.01, 0.01) +
                               "<collision><geometry><cylinder radius=\"0.02\" length=\"0.3\"/></geometry></collision>";
  const Scenario scenario = scenario_of(import_text(
      robot(link("a", cylinder) + link("b", cube("0")) + joint("j", "revolute", "a", "b", "xyz=\"0.1 0 0\""))));
  const Bounds bounds = *bounds_of(scenario.robot.links[1].geometries, scenario.robot.links[1].pose);
  EXPECT_TRUE(bounds.highest.isApprox(Eigen::Vector3d(0.02, 0.02, 0.15), 1e-6));
  EXPECT_NEAR(scenario.environment.robot_pose.position.z(), 0.15, 1e-6);  // it stands on the floor
}

TEST(UrdfImport, FrictionOfGazeboIsThatOfTheLink) {
  const Scenario scenario = scenario_of(import_text(robot_text("gazebo_friction")));
  EXPECT_EQ(scenario.robot.links[1].geometries[0].friction, 0.3);
  EXPECT_EQ(scenario.robot.links[0].geometries[0].friction, 0.5);
}

TEST(UrdfImport, TheFirstGaitStaysWithinLimitsAndSpeeds) {
  const UrdfImport import =
      import_text(two_cubes("0 1 0", "lower=\"-0.2\" upper=\"0.3\" effort=\"2\" velocity=\"0.5\""));
  const std::string gait = import.files[2].text;
  // 0.2 rad are 11.459 degrees: nine tenths of them; 0.98 of 0.5 rad/s with that amplitude: 0.434 Hz.
  EXPECT_NE(gait.find("name=\"amplitude\" value=\"10.3\" unit=\"deg\" joint=\"j\""), std::string::npos) << gait;
  EXPECT_NE(gait.find("name=\"frequency\" value=\"0.433\""), std::string::npos) << gait;
}

TEST(UrdfImport, AJointThatBendsToOneSideSwingsAboutTheMiddle) {
  const UrdfImport import = import_text(two_cubes("0 1 0", "lower=\"0\" upper=\"1.57\" effort=\"2\" velocity=\"9\""));
  const std::string gait = import.files[2].text;
  EXPECT_NE(gait.find("name=\"offset\" value=\"45\" unit=\"deg\" joint=\"j\""), std::string::npos) << gait;
}

TEST(UrdfImport, AJointThatTurnsTheOtherWaySwingsInOppositePhase) {
  std::string text = robot(link("a", cube("0")) + link("b", cube("0.05")) + link("c", cube("0.05")) +
                           link("d", cube("0.05")) + joint("j1", "revolute", "a", "b", "xyz=\"0.05 0 0\"", "0 1 0") +
                           joint("j2", "revolute", "b", "c", "xyz=\"0.1 0 0\"", "0 -1 0") +
                           joint("j3", "revolute", "c", "d", "xyz=\"0.1 0 0\"", "0 1 0"));
  const std::string gait = import_text(text).files[2].text;
  EXPECT_NE(gait.find("name=\"phase\" value=\"180\" unit=\"deg\" joint=\"j2\""), std::string::npos) << gait;
  EXPECT_EQ(gait.find("joint=\"j1\""), std::string::npos) << gait;
}

// A tetrahedron with sides of 100 in the unit of the file.
const std::string off_text = "OFF\n4 4 0\n0 0 0\n100 0 0\n0 100 0\n0 0 100\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string mesh_robot(const std::string& mesh, const std::string& scale = "0.001 0.001 0.001") {
  const std::string shape = "<geometry><mesh filename=\"" + mesh + "\" scale=\"" + scale + "\"/></geometry>";
  return robot(link("a", cube("0")) +
               link("b", inertial("1", "", 0.001, 0.001, 0.001) + "<collision>" + shape + "</collision><visual>" +
                             shape + "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material></visual>") +
               joint("j", "revolute", "a", "b", "xyz=\"0.1 0 0\""));
}

TEST(UrdfImport, MeshesAreFoundWhereverRosFindsThem) {
  struct Place {
    const char* name;
    const char* file;
    const char* package_xml;
  };
  for (const Place& place :
       {Place{"package://crawler/meshes/b.off", "/ws/src/crawler/meshes/b.off", nullptr},
        Place{"package://other/meshes/b.off", "/ws/src/other/meshes/b.off", nullptr},
        Place{"package://named/meshes/b.off", "/ws/src/crawler/meshes/b.off", "/ws/src/crawler/package.xml"},
        Place{"model://crawler/b.off", "/ws/src/crawler/b.off", nullptr},
        Place{"package://far/b.off", "/opt/far_away/b.off", nullptr}, Place{"file:///opt/b.off", "/opt/b.off", nullptr},
        Place{"file://b.off", "/ws/src/crawler/urdf/b.off", nullptr},
        Place{"../meshes/b.off", "/ws/src/crawler/urdf/../meshes/b.off", nullptr}}) {
    SourceTexts files;
    files.add("/ws/src/crawler/urdf/robot.urdf", mesh_robot(place.name));
    files.add(place.file, off_text);
    if (place.package_xml != nullptr) {
      files.add(place.package_xml, std::string("<package>\n  <name> named </name>\n</package>"));
    }
    UrdfImportOptions options;
    options.packages["far"] = "/opt/far_away";
    const Scenario scenario = scenario_of(import_urdf("/ws/src/crawler/urdf/robot.urdf", files, options));
    const Link& link = scenario.robot.links[0];
    ASSERT_EQ(link.geometries.size(), 1U) << place.name;
    EXPECT_TRUE(link.geometries[0].extents.isApprox(Eigen::Vector3d::Constant(0.1), 1e-6)) << place.name;
    ASSERT_EQ(link.looks.size(), 1U);
    EXPECT_EQ(link.looks[0].mesh->colours.at(0), Eigen::Vector3f(1.0F, 0.0F, 0.0F));
  }
}

std::string refusal_of_mesh(const std::string& scale, const std::string& text) {
  SourceTexts files;
  files.add("robot.urdf", mesh_robot("b.off", scale));
  files.add("b.off", text);
  return message_of<InputError>([&] { static_cast<void>(import_urdf("robot.urdf", files)); });
}

TEST(UrdfImport, AMeshThatCannotTouchIsRefusedWithTheLineOfItsLink) {
  EXPECT_NE(refusal_of_mesh("1 1 1", off_text)
                .find("robot.urdf:3: found a mesh of 100 x 100 x 100 m in 'meshes/b.off', expected a longest side"),
            std::string::npos)
      << refusal_of_mesh("1 1 1", off_text);
  EXPECT_NE(refusal_of_mesh("0.001 -0.001 0.001", off_text).find("robot.urdf:3: found the scale '0.001 -0.001 0.001'"),
            std::string::npos);
  const std::string damaged = refusal_of_mesh("1 1 1", "OFF\n4 4 0\n");
  EXPECT_TRUE(damaged.starts_with("robot.urdf:3: found")) << damaged;
}

}  // namespace
}  // namespace proleg::sim
