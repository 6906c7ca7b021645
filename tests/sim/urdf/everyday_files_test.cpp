// What URDF files of other programs have and the format does not: values with blanks, looks that cannot be shown,
// numbers that mean "none", quaternions, degrees, names of Windows. What has one meaning is read; the rest is lost in a
// line, or refused with the line of the file and a way out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "imported.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {
namespace {

namespace fs = std::filesystem;

/// Two links of 70 mm; a case replaces parts of them. Each part is in a line of its own.
const std::string plain_robot =
    "<robot name=\"r\">\n"
    "<link name=\"a\"><inertial><origin xyz=\"0.04 0 0\"/><mass value=\"0.2\"/>"
    "<inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial>"
    "<collision><origin xyz=\"0.04 0 0\"/><geometry><box size=\"0.07 0.05 0.05\"/></geometry></collision></link>\n"
    "<link name=\"b\">\n"
    "<inertial><origin xyz=\"0.04 0 0\"/><mass value=\"0.2\"/>"
    "<inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial>\n"
    "<collision><origin xyz=\"0.04 0 0\"/><geometry><box size=\"0.07 0.05 0.05\"/></geometry></collision>\n"
    "</link>\n"
    "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\n"
    "<origin xyz=\"0.08 0 0\"/><axis xyz=\"0 1 0\"/>\n"
    "<limit lower=\"-1\" upper=\"1\" effort=\"1.5\" velocity=\"5\"/></joint>\n"
    "</robot>\n";
constexpr int robot_line = 1;
constexpr int inertial_line = 4;
constexpr int shape_line = 5;
constexpr int joint_line = 7;
constexpr int origin_line = 8;
constexpr int limit_line = 9;

const std::string inertial_of_b =
    "<inertial><origin xyz=\"0.04 0 0\"/><mass value=\"0.2\"/>"
    "<inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/></inertial>\n";
const std::string box_of_b = "<geometry><box size=\"0.07 0.05 0.05\"/></geometry>";
const std::string origin_of_joint = "<origin xyz=\"0.08 0 0\"/>";
const std::string limit_of_joint = "<limit lower=\"-1\" upper=\"1\" effort=\"1.5\" velocity=\"5\"/>";

/// The text with its last `from` replaced: that of link b, or of the joint.
std::string with(const std::string& from, const std::string& to) {
  std::string text = plain_robot;
  const std::size_t at = text.rfind(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
std::string with_look(const std::string& visual) { return with("</link>", "<visual>" + visual + "</visual></link>"); }
std::string with_end(const std::string& tags) { return with("</robot>", tags + "</robot>"); }
std::string with_limit(const std::string& attributes) { return with(limit_of_joint, "<limit " + attributes + "/>"); }
std::string with_origin(const std::string& attributes) {
  return with(origin_of_joint, "<origin xyz=\"0.08 0 0\" " + attributes + "/>");
}
std::string with_inertia(const std::string& tags) {
  return with(inertial_of_b, "<inertial><origin xyz=\"0.04 0 0\"/>" + tags + "</inertial>\n");
}

std::string at(int line) { return "robot.urdf:" + std::to_string(line) + ": found "; }

struct Said {
  bool is_read = false;
  std::string lost;
  std::string notes;
  std::string warnings;
  std::string refusal;
};

Said said_of(const std::string& text) {
  try {
    const UrdfImport import = import_text(text);
    return {scenario_of(import).robot.joints.size() == 1, joined(import.lost), joined(import.notes),
            joined(import.warnings), ""};
  } catch (const InputError& error) {
    return {false, "", "", "", error.what()};
  }
}

struct Case {
  std::string text;
  std::string says;  ///< a part of its only kind of remark; empty: none at all
};

/// Each robot is read, and says in the list that `list` names only what is expected, once.
void expect_read(const std::vector<Case>& cases, std::string Said::*list) {
  for (const Case& each : cases) {
    const Said said = said_of(each.text);
    EXPECT_TRUE(said.is_read) << each.text << said.refusal;
    EXPECT_NE((said.*list).find(each.says), std::string::npos) << each.says << "\nin: " << said.*list;
    for (const std::string Said::*other : {&Said::lost, &Said::notes, &Said::warnings}) {
      EXPECT_TRUE((other == list && !each.says.empty()) || (said.*other).empty()) << each.text << said.*other;
    }
  }
}

void expect_refused(const std::vector<Case>& cases) {
  for (const Case& each : cases) {
    const Said said = said_of(each.text);
    EXPECT_TRUE(said.refusal.starts_with(each.says)) << each.text << "says: " << said.refusal;
  }
}

Scenario robot_of(const std::string& text) { return scenario_of(import_text(text)); }

TEST(EverydayFiles, WhatHasOneMeaningIsReadWithoutAWord) {
  expect_read(
      {
          // Blanks, tabs and line ends in values: XML makes blanks of them.
          {with("0.2\"/>", "0.2 \"/>"), ""},
          {with("ixz=\"0\"", "ixz=\" 0\n\""), ""},
          {with("0.08 0 0", "0.08\t0\n0"), ""},
          {with("0.07 0.05 0.05", "\n0.07\r\n0.05\t\t0.05 "), ""},
          {with_limit("lower=\" -1\" upper=\"1 \" effort=\"\t1\" velocity=\"1\n\""), ""},
          {with("link name=\"b\"", "link name=\"b \""), ""},
          {with("child link=\"b\"", "child link=\"\tb\""), ""},
          {with("type=\"revolute\"", "type=\" revolute\""), ""},
          {with("name=\"j\"", "name=\"the\njoint\""), ""},
          // Capitals, and the order of attributes.
          {with_limit("Upper=\"1\" LOWER=\"-1\" effort=\"1\" velocity=\"1\""), ""},
          // Versions, namespaces, declarations.
          {with("<robot name=\"r\">", "<robot name=\"r\" version=\"1.1\" xmlns:xacro=\"http://ros.org/wiki/xacro\">"),
           ""},
          {with("<robot name=\"r\">", "<robot version=\"1.2\" name=\"r\" xmlns=\"http://drake.mit.edu\">"), ""},
          {"\n  <?xml version=\"1.0\" ?>\n" + plain_robot, ""},
          {"<!-- made by a program --><?xml version='1.0' encoding=\"UTF-8\"?>" + plain_robot, ""},
          {"<?xml version=\"1.0\"?>\n<?xml-model href=\"urdf.xsd\"?>\n<!DOCTYPE robot>\n" + plain_robot, ""},
          {"\xEF\xBB\xBF<?xml version=\"1.0\"?>\n<!DOCTYPE robot SYSTEM \"robot.dtd\">\n" + plain_robot +
               "<!-- end -->",
           ""},
          // What has no effect.
          {with(limit_of_joint, limit_of_joint + "<dynamics/>"), ""},
          {with(limit_of_joint, limit_of_joint + "<dynamics damping=\"0.0\" friction=\" 0 \"/>"), ""},
          {with("<inertial>", "<!-- a comment --><inertial>"), ""},
          {with("<collision>", "<collision name=\"shell\">"), ""},
          {with_end("<material name=\"red\"><color rgba=\"1 0 0 1\"/></material>"), ""},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b + "<material name=\"nowhere\"/>"), ""},
      },
      &Said::lost);
}

TEST(EverydayFiles, WhatIsOnlyShownOrNotUsedIsLostInALine) {
  const std::string lone = "a box, sphere or cylinder is shown where it touches";
  expect_read(
      {
          {with_look("<geometry><mesh filename=\"none.stl\"/></geometry>"),
           "'none.stl' of link 'b': found no such file"},
          {with_look("<geometry><box size=\"0.1 0 0.1\"/></geometry>"), "a <box> without volume"},
          {with_look("<geometry><box size=\"0 0 0\"/></geometry>"), "a <box> without volume"},
          {with_look("<geometry><sphere radius=\"0\"/></geometry>"), "a <sphere> without volume"},
          {with_look("<geometry><cylinder radius=\"0.1\" length=\"0\"/></geometry>"), "a <cylinder> without volume"},
          {with_look("<geometry><box size=\"-1 1 1\"/></geometry>"),
           "the look of link 'b': found size='-1 1 1' in <box>"},
          {with_look("<geometry><box size=\"1 1\"/></geometry>"), "the look of link 'b': found size='1 1' in <box>"},
          {with_look("<geometry><box/></geometry>"), "the look of link 'b': found no attribute 'size' in <box>"},
          {with_look("<geometry><capsule radius=\"0.02\" length=\"0.05\"/></geometry>"), lone},
          {with_look("<geometry><ellipsoid radii=\"1 1 1\"/></geometry>"), "the look of link 'b': found <ellipsoid>"},
          {with_look("<geometry><box size=\"1 1 1\"/><sphere radius=\"1\"/></geometry>"),
           "found 2 shapes in <geometry>"},
          {with_look("<geometry/>"), "a <visual> without a geometry"},
          {with_look(""), "a <visual> without a geometry (line 6)"},
          {with_look("<origin xyz=\"0 0\"/>" + box_of_b), "the look of link 'b': found xyz='0 0' in <origin>"},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b +
                     "<material name=\"m\"><color rgba=\"255 0 0 1\"/></material>"),
           "the colour '255 0 0 1': expected 4 numbers from 0 to 1 (line 6)"},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b + "<material name=\"m\"><color rgba=\"red\"/></material>"),
           "the colour 'red'"},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b +
                     "<material name=\"m\"><texture filename=\"a.png\"/></material>"),
           "<texture> of a <visual>"},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b + "<material name=\"m\"/><material name=\"n\"/>"),
           "a second <material> of a <visual>"},
          {with_look("<origin xyz=\"0.04 0 0\"/>" + box_of_b + "<material><color rgba=\"1 0 0 1\"/></material>"),
           "colours of boxes"},
          // Frictions, sensors, transmissions and the like: a line for each kind, however often it is there.
          {with("</collision>", "<contact_coefficients mu=\"0.9\"/></collision>"),
           "<contact_coefficients> in <collision> (line 5)"},
          {with(
               "</collision>",
               "<d:proximity_properties xmlns:d=\"d\"><d:mu_static value=\"1\"/></d:proximity_properties></collision>"),
           "<d:proximity_properties> in <collision> (line 5)"},
          {with("</collision>", "<material name=\"m\"/></collision>"), "<material> in <collision> (line 5)"},
          {with("</link>", "<contact><lateral_friction value=\"1\"/></contact></link>"),
           "<contact> of a link (line 6)"},
          {with("</link>", "<collision/></link>"), "a <collision> without a geometry (line 6)"},
          {with("</link>", "<collision><geometry><box size=\"0 0 0\"/></geometry></collision></link>"),
           "a <box> without volume"},
          {with("<box size", "<box margin=\"1\" size"), "the attribute 'margin' of <box> (line 5)"},
          {with("name=\"b\"", "name=\"b\" type=\"laser\""), "the attribute 'type' of <link> (line 3)"},
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\" acceleration=\"2\""),
           "'acceleration' of <limit> (line 9)"},
          {with(limit_of_joint, limit_of_joint + "<dynamics damping=\"0.1\"/>"), "<dynamics> of a joint (line 9)"},
          {with(limit_of_joint, limit_of_joint + "<dynamics damping=\"nothing\"/>"), "<dynamics> of a joint (line 9)"},
          {with(limit_of_joint, limit_of_joint + "<safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/>"),
           "<calibration> of a joint"},
          {with_end("<sensor name=\"s\"><parent link=\"a\"/><camera/></sensor>"), "<sensor> (line 10)"},
          {with_end("<transmission/>\n<transmission/>\n<transmission/>"), "<transmission> (lines 10, 11, 12)"},
          {with_end("<gazebo><plugin name=\"p\"/></gazebo>"), "<plugin> in <gazebo> (line 10)"},
          {with_end("<gazebo reference=\"x\"><mu1>1</mu1></gazebo>"), "unknown link or joint 'x' (line 10)"},
          {with("<robot name=\"r\">", "<robot name=\"r\" version=\"2.0\">"), "version='2.0' of <robot>"},
      },
      &Said::lost);
  std::string many;
  for (int i = 0; i < 50; ++i) {
    many += "<transmission name=\"t\"/>\n<gazebo reference=\"a\"><kp>1</kp><kd>1</kd></gazebo>\n";
  }
  const Said said = said_of(with_end(many));
  EXPECT_EQ(std::ranges::count(said.lost, '\n'), 3) << said.lost;
}

TEST(EverydayFiles, ALookThatTouchesIsNoLook) {
  // Without a <collision> in the whole file the <visual>s touch the ground.
  std::string text = plain_robot;
  for (std::size_t at = text.find("collision"); at != std::string::npos; at = text.find("collision", at)) {
    text.replace(at, std::string_view("collision").size(), "visual");
  }
  EXPECT_TRUE(said_of(text).is_read);
  const std::size_t size = text.rfind("0.07 0.05 0.05");
  std::string frame = text;
  EXPECT_NE(said_of(frame.replace(size, 14, "0 0 0")).lost.find("a <box> without volume"), std::string::npos);
  EXPECT_TRUE(said_of(text.replace(size, 14, "1")).refusal.starts_with(at(shape_line) + "size='1' in <box>"));
}

TEST(EverydayFiles, NumbersThatMeanNoneAreReadWithANote) {
  const std::string none = " in <limit> means no limit: as if it is missing (line 9)";
  expect_read(
      {
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"1e7\" velocity=\"1\""), "effort='1e7'" + none},
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"-1\" velocity=\"1\""), "effort='-1'" + none},
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"inf\" velocity=\"1\""), "effort='inf'" + none},
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1e10\""), "velocity='1e10'" + none},
          {with_limit("lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"-1.0\""), "velocity='-1.0'" + none},
          {with_limit("lower=\"-1\" upper=\"1\" velocity=\"1\""), "effort is missing or 0: "},
          {with_limit("lower=\"-1\" upper=\"1\""), "velocity is missing or 0: 4.5 rad/s for j"},
          {with_limit("lower=\"-999999\" upper=\"999999\" effort=\"1\" velocity=\"1\""),
           "its limits are cut to -360 and 360 degrees"},
          {with_limit("lower=\"-1e16\" upper=\"1e16\" effort=\"1\" velocity=\"1\""),
           "its limits are cut to -360 and 360 degrees"},
          {with_limit("effort=\"1\" velocity=\"1\""), "limits 0 to 0 rad of joint 'j': it does not move (line 9)"},
          {with_limit("lower=\"0.5\" upper=\"0.5\" effort=\"1\" velocity=\"1\""), "limits 0.5 to 0.5 rad of joint 'j'"},
          {with("name=\"r\"", ""), "the robot has no name"},
          {with(" ixy=\"0\" ixz=\"0\"", ""), "products of inertia that are missing are 0 (line 4)"},
          {with(inertial_of_b, ""), "link 'b' has no mass"},
          {with(inertial_of_b, "<inertial/>"), "link 'b' has no mass"},
          {with_inertia("<mass value=\"0.2\"/>"),
           "link 'b' has no moments of inertia, or they are 0: its geometry gives them"},
      },
      &Said::notes);
  // The values of a continuous joint that say what the type says.
  const std::string wheel = with("revolute", "continuous");
  EXPECT_EQ(said_of(wheel).lost, "the angles of <limit> in a continuous joint (line 9)\n");
  std::string endless = wheel;
  endless.replace(endless.find("lower=\"-1\" upper=\"1\""), 20, "lower=\"-1e16\" upper=\"1e16\"");
  EXPECT_EQ(said_of(endless).lost, "");
}

TEST(EverydayFiles, AZeroInertiaIsThatOfTheGeometry) {
  const std::string zero =
      "<mass value=\"0.2\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>";
  const Scenario scenario = robot_of(with_inertia(zero));
  const MassProperties& mass = scenario.robot.links[0].mass;
  EXPECT_EQ(mass.mass, 0.2);
  EXPECT_NEAR(mass.center.x(), 0.04, 1e-12);
  EXPECT_NEAR(mass.inertia(0, 0), 0.2 / 12.0 * (0.05 * 0.05 + 0.05 * 0.05), 1e-12);  // a solid box
  EXPECT_NEAR(mass.inertia(2, 2), 0.2 / 12.0 * (0.07 * 0.07 + 0.05 * 0.05), 1e-12);
  // A link at a fixed joint counts as a point: 1 kg at 1 m from the centre of the other one.
  const std::string point =
      "<link name=\"c\"><inertial><mass value=\"0.2\"/></inertial></link><joint name=\"f\" type=\"fixed\"><origin "
      "xyz=\"1.04 0 0\"/><parent link=\"b\"/><child link=\"c\"/></joint>";
  const MassProperties both = robot_of(with_end(point)).robot.links[0].mass;
  EXPECT_NEAR(both.inertia(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(both.inertia(1, 1), 1e-4 + 0.1, 1e-12);  // m/2 d^2
}

TEST(EverydayFiles, ACapsuleTouchesWithACylinderAndTwoSpheres) {
  const Scenario scenario = robot_of(with(box_of_b, "<geometry><capsule radius=\"0.02\" length=\"0.05\"/></geometry>"));
  const std::vector<Geometry>& solids = scenario.robot.links[0].geometries;
  ASSERT_EQ(solids.size(), 3U);
  EXPECT_EQ(solids[0].shape, Shape::cylinder);
  EXPECT_EQ(solids[0].extents.y(), 0.025);
  EXPECT_TRUE(solids[1].pose.position.isApprox(Eigen::Vector3d(0.04, 0.0, -0.025), 1e-9));
  EXPECT_TRUE(solids[2].pose.position.isApprox(Eigen::Vector3d(0.04, 0.0, 0.025), 1e-9));
}

TEST(EverydayFiles, AQuaternionIsTheSameRotationAsItsAngles) {
  const auto axis_of = [](const std::string& rotation) { return robot_of(with_origin(rotation)).robot.joints[0].axis; };
  const Eigen::Vector3d expected = axis_of("rpy=\"0.3 -0.4 0.5\"");
  // Rz(0.5) Ry(-0.4) Rx(0.3) by the closed form for the half angles.
  const double cr = std::cos(0.15);
  const double sr = std::sin(0.15);
  const double cp = std::cos(-0.2);
  const double sp = std::sin(-0.2);
  const double cy = std::cos(0.25);
  const double sy = std::sin(0.25);
  const auto text = [](double value) { return std::to_string(2.0 * value); };  // of any length
  const std::string quaternion = "quat_xyzw=\"" + text(sr * cp * cy - cr * sp * sy) + ' ' +
                                 text(cr * sp * cy + sr * cp * sy) + '\n' + text(cr * cp * sy - sr * sp * cy) + ' ' +
                                 text(cr * cp * cy + sr * sp * sy) + '"';
  EXPECT_TRUE(axis_of(quaternion).isApprox(expected, 1e-5));
  EXPECT_FALSE(axis_of("").isApprox(expected, 1e-2));
  expect_refused({
      {with_origin("quat_xyzw=\"0 0 0 0\""),
       at(origin_line) + "quat_xyzw='0 0 0 0' in <origin>, expected a quaternion"},
      {with_origin("quat_xyzw=\"0 0 1\""), at(origin_line) + "quat_xyzw='0 0 1' in <origin>, expected 4 numbers"},
      {with_origin("quat_xyzw=\"0 0 nan 1\""), at(origin_line) + "quat_xyzw='0 0 nan 1' in <origin>"},
      {with_origin("rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\""),
       at(origin_line) + "both rpy and quat_xyzw in <origin>, expected one"},
  });
}

TEST(EverydayFiles, AnglesThatLookLikeDegreesAreNamed) {
  const std::string usual = "; usually it is in degrees, and URDF has radians";
  expect_read(
      {{with_origin("rpy=\"0 0 90\""), "robot.urdf:8: an rpy of 90 rad in <origin>" + usual},
       {with_origin("rpy=\"-45 0 0\""), "robot.urdf:8: an rpy of 45 rad"},
       {with("0.04 0 0\"/><geometry>", "0.04 0 0\" rpy=\"0 30 0\"/><geometry>"), "robot.urdf:5: an rpy of 30 rad"}},
      &Said::warnings);
  const Said limits = said_of(with_limit("lower=\"-90\" upper=\"90\" effort=\"1\" velocity=\"1\""));
  EXPECT_EQ(limits.warnings,
            "robot.urdf:9: limits -90 to 90 rad of joint 'j'; usually they are in degrees, and URDF has radians\n");
  expect_read({{with_origin("rpy=\"0 0 6.2832\""), ""}, {with_origin("rpy=\"0 0 -6.28\""), ""}}, &Said::warnings);
  EXPECT_EQ(said_of(with_limit("lower=\"-6.2832\" upper=\"6.2832\" effort=\"1\" velocity=\"1\"")).warnings, "");
}

TEST(EverydayFiles, AJointFarFromTheShellOfOneLinkIsAWrist) {
  expect_read({{with("0.08 0 0", "0.16 0 0"), ""}, {with("0.08 0 0", "0.08 0 0.4"), ""}}, &Said::warnings);
  EXPECT_NE(
      said_of(with("0.08 0 0", "80 0 0")).warnings.find("robot.urdf:7: joint 'j' is 79925 mm outside of its body 'a'"),
      std::string::npos);
  EXPECT_NE(said_of(with("0.08 0 0", "2 0 0")).warnings.find("usually an <origin> is wrong"), std::string::npos);
}

TEST(EverydayFiles, LinksThatOverlapAtTheStartAreNamed) {
  const auto chain = [](double step) {
    std::string text = "<robot name=\"r\">\n";
    for (int i = 0; i < 4; ++i) {
      const std::string name = std::to_string(i);
      text += "<link name=\"l" + name +
              "\"><inertial><mass value=\"1\"/><inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" "
              "iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/></inertial><collision><geometry><cylinder radius=\"0.05\" "
              "length=\"0.1\"/></geometry></collision></link>\n";
      if (i > 0) {
        text += "<joint name=\"j" + name + "\" type=\"revolute\"><parent link=\"l" + std::to_string(i - 1) +
                "\"/><child link=\"l" + name + "\"/><origin xyz=\"" + std::to_string(step) +
                " 0 0\"/><axis xyz=\"0 0 1\"/>" + limit_of_joint + "</joint>\n";
      }
    }
    return said_of(text + "</robot>\n").warnings;
  };
  EXPECT_EQ(chain(0.06), "");
  EXPECT_EQ(chain(0.0499), "");  // they touch
  EXPECT_EQ(chain(0.032),
            "robot.urdf:7: bodies overlap at the start that are no neighbours, and their contact may throw the robot "
            "away: 'l3' and 'l1', 'l2' and 'l0'; make what touches smaller, or write <selfcollision>0</selfcollision> "
            "into the environment\n");
}

TEST(EverydayFiles, TheRestIsRefusedWithItsLineAndAWayOut) {
  expect_refused({
      {with_inertia("<mass value=\"1e6\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>"),
       at(3) + "a mass of 1e+06 kg of link 'b', expected 1e-06 to 10000 kg"},
      {with_inertia("<mass value=\"1e-9\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>"),
       at(3) + "a mass of 1e-09 kg of link 'b'"},
      {with_inertia("<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>"),
       at(inertial_line) + "no <mass> in <inertial>"},
      {with(box_of_b, "<geometry><box size=\"1 1 1\"/><sphere radius=\"1\"/></geometry>"),
       at(shape_line) + "2 shapes in <geometry>, <box> and <sphere>, expected one; give each a <collision> of its own"},
      {with(box_of_b, "<geometry><plane/></geometry>"), at(shape_line) + "<plane> in <geometry>, expected one <box>"},
      {with(box_of_b, "<geometry><mesh filename=\"\"/></geometry>"), at(shape_line) + "an empty filename in <mesh>"},
      {with(box_of_b, "<geometry><mesh filename=\"package://b.stl\"/></geometry>"),
       at(shape_line) + "no file for the mesh 'package://b.stl', expected package://NAME/PATH of a mesh"},
      {with(box_of_b, "<geometry><mesh filename=\"package://../b.stl\"/></geometry>"),
       at(shape_line) + "no file for the mesh 'package://../b.stl', expected package://NAME/PATH of a mesh"},
      {with(box_of_b, "<geometry><mesh filename=\"package:///p/b.stl\"/></geometry>"),
       at(shape_line) +
           "no file for the mesh 'package:///p/b.stl', expected it in a folder 'p' beside or above the URDF "
           "file, or --package p=FOLDER"},
      {with(origin_of_joint, origin_of_joint + origin_of_joint),
       at(origin_line) + "a second <origin> in <joint>, expected one"},
      {with("<collision>", "<collision><origin/>"), at(shape_line) + "a second <origin> in <collision>"},
      {with(limit_of_joint, limit_of_joint + limit_of_joint), at(limit_line) + "a second <limit> in <joint>"},
      {with_limit("lower=\"1\" upper=\"-1\" effort=\"1\" velocity=\"1\""),
       at(limit_line) + "limits 1 to -1 rad of joint 'j'"},
      {with_limit("lower=\"-1\" upper=\"1\" effort=\"much\" velocity=\"1\""),
       at(limit_line) + "effort='much' in <limit>"},
      {with("child link=\"b\"", "child link=\"B\""),
       at(joint_line) + "the unknown link 'B' in joint 'j', expected one of a, b"},
      {with_end("<<<<<<< HEAD\n=======\n>>>>>>> 24a2559\n"),
       at(10) + "the mark of a merge conflict, '<<<<<<< HEAD', expected one of the two versions"},
      {"<!DOCTYPE robot [<!ENTITY pi \"3.14\">]>\n" + plain_robot, at(robot_line) + "'DOCTYPE robot"},
      {with(origin_of_joint, "<origin xyz=\"$(arg x) 0 0\"/>"),
       at(origin_line) + "the expression '$(arg x) 0 0' in <origin>, expected plain URDF"},
  });
}

/// Files on disk: FileSource alone cannot list a folder.
class MeshFiles : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name) << text;
  }
  [[nodiscard]] Said imported(const std::string& urdf, const UrdfImportOptions& options = {}) const {
    DiskFiles files;
    try {
      const UrdfImport import = import_urdf(folder_.path() / urdf, files, options);
      return {!scenario_of(import).robot.joints.empty(), joined(import.lost), joined(import.notes),
              joined(import.warnings), ""};
    } catch (const InputError& error) {
      return {false, "", "", "", error.what()};
    }
  }
  static std::string mesh(const std::string& name) { return "<geometry><mesh filename=\"" + name + "\"/></geometry>"; }

  // A tetrahedron.
  const std::string off_ = "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 0.1 0\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  TemporaryFolder folder_;
};

TEST_F(MeshFiles, NamesOfWindowsFindTheirFiles) {
  write("meshes/Shell.off", off_);
  write("slash.urdf", with(box_of_b, mesh("meshes\\Shell.off")));
  write("case.urdf", with(box_of_b, mesh("Meshes/shell.OFF")));
  for (const char* name : {"slash.urdf", "case.urdf"}) {
    const Said said = imported(name);
    EXPECT_TRUE(said.is_read) << said.refusal;
    EXPECT_NE(said.notes.find("/meshes/Shell.off': names count as on Windows"), std::string::npos) << said.notes;
  }
  write("meshes/shell.off", off_);  // now there are two
  EXPECT_NE(imported("case.urdf").refusal.find("no file for the mesh 'Meshes/shell.OFF'"), std::string::npos);
}

TEST_F(MeshFiles, TheMessageOnAPackageHasAFolderThatWorks) {
  write("p_repository/meshes/b.off", off_);
  write("p_repository/urdf/r.urdf", with(box_of_b, mesh("package://p/meshes/b.off")));
  const std::string refusal = imported("p_repository/urdf/r.urdf").refusal;
  const std::string way_out = "--package p=" + (folder_.path() / "p_repository").string();
  EXPECT_NE(refusal.find(way_out + ", which has it"), std::string::npos) << refusal;
  UrdfImportOptions options;
  options.packages["p"] = folder_.path() / "p_repository";
  const Said said = imported("p_repository/urdf/r.urdf", options);
  EXPECT_TRUE(said.is_read && said.warnings.empty()) << said.refusal << said.warnings;
}

TEST_F(MeshFiles, AMeshThatCannotBeShownIsLost) {
  write("good.off", off_);
  write("lfs.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 5\n");
  write("damaged.off", "OFF\n4 4 0\n");
  write("large.off", "OFF\n3 1 0\n0 0 0\n900 0 0\n0 900 0\n3 0 1 2\n");
  for (const auto& [name, says] : {std::pair("lfs.stl", "a pointer of Git LFS instead of the mesh"),
                                   {"damaged.off", "'meshes/damaged.off'"},
                                   {"large.off", "a mesh of 900 x 900 x 0 m"}}) {
    write("look.urdf", with_look(mesh(name)));
    const Said look = imported("look.urdf");
    EXPECT_TRUE(look.is_read) << look.refusal;
    EXPECT_NE(look.lost.find(says), std::string::npos) << look.lost;
    EXPECT_NE(look.lost.find("(line 6)"), std::string::npos) << look.lost;
    write("solid.urdf", with(box_of_b, mesh(name)));
    const std::string refusal = imported("solid.urdf").refusal;
    EXPECT_NE(refusal.find("solid.urdf:5: found"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find(says), std::string::npos) << refusal;
  }
  write("look.urdf", with_look(mesh("good.off")));
  EXPECT_EQ(imported("look.urdf").lost, "");
}

TEST_F(MeshFiles, AFileOutsideOfTheRobotIsNamedAndNotShown) {
  write("secret.stl", "root:x:0:0:root\n");
  write("b.off", off_);
  write("p/package.xml", "<package><name>p</name></package>");
  write("p/meshes/b.off", off_);
  write("p/urdf/inside.urdf", with(box_of_b, mesh("../meshes/b.off")));
  const Said inside = imported("p/urdf/inside.urdf");
  EXPECT_TRUE(inside.is_read && inside.warnings.empty()) << inside.refusal << inside.warnings;

  fs::create_symlink(folder_.path() / "b.off", folder_.path() / "p/meshes/link.off");
  fs::create_symlink(folder_.path() / "secret.stl", folder_.path() / "p/meshes/link.stl");
  for (const std::string& name :
       {std::string("../../b.off"), std::string("../meshes/link.off"), std::string("package://p/../b.off"),
        "file://" + (folder_.path() / "b.off").string()}) {
    write("p/urdf/outside.urdf", with(box_of_b, mesh(name)));
    const Said said = imported("p/urdf/outside.urdf");
    EXPECT_TRUE(said.is_read) << said.refusal;
    EXPECT_NE(said.warnings.find("meshes outside of the robot's folder are copied into the scenario: '" + name + "'"),
              std::string::npos)
        << said.warnings;
  }
  for (const char* name : {"../../secret.stl", "../meshes/link.stl"}) {
    write("p/urdf/outside.urdf", with(box_of_b, mesh(name)));
    const std::string refusal = imported("p/urdf/outside.urdf").refusal;
    EXPECT_NE(refusal.find(std::string("outside.urdf:5: found '") + name + "' outside of the robot's folder"),
              std::string::npos)
        << refusal;
    EXPECT_EQ(refusal.find("root:x"), std::string::npos) << refusal;
    write("p/urdf/outside.urdf", with_look(mesh(name)));
    EXPECT_EQ(imported("p/urdf/outside.urdf").lost.find("root:x"), std::string::npos);
  }
}

}  // namespace
}  // namespace proleg::sim
