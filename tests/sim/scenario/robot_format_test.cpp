// Nested KinBodies, poses, joints and masses, against numbers computed by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "memory_files.hpp"

namespace proleg::sim {
namespace {

Link link_of(const Scenario& scenario, const std::string& name) {
  for (const Link& link : scenario.robot.links) {
    if (link.name == name) {
      return link;
    }
  }
  throw std::out_of_range(name);
}

Joint joint_of(const Scenario& scenario, const std::string& name) {
  for (const Joint& joint : scenario.robot.joints) {
    if (joint.name == name) {
      return joint;
    }
  }
  throw std::out_of_range(name);
}

TEST(RobotFormat, TagsAndAttributesMayHaveAnyCase) {
  MemoryFiles files = small_scenario();
  const Scenario plain = files.scenario();
  for (auto& [name, text] : files.texts) {
    // Upper case for every tag and attribute name, but not for values.
    std::string upper;
    bool in_tag = false;
    bool in_value = false;
    for (const char c : text) {
      in_tag = c == '<' || (in_tag && c != '>');
      in_value = in_tag && (in_value != (c == '"'));
      upper += in_tag && !in_value && !text.starts_with("<!--") ? static_cast<char>(std::toupper(c)) : c;
    }
    text = upper;
  }
  const Scenario scenario = files.scenario();
  ASSERT_EQ(scenario.robot.links.size(), plain.robot.links.size());
  EXPECT_EQ(scenario.robot.links.back().name, "TailEnd");
  EXPECT_EQ(scenario.robot.servo.gain, plain.robot.servo.gain);
  EXPECT_EQ(scenario.settings.size(), plain.settings.size());
  EXPECT_EQ(scenario.environment.robot_pose.position, plain.environment.robot_pose.position);
}

TEST(RobotFormat, TagsAndAttributesMayMixCases) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>", "<tRanslaTion>0 0.2 0</tRanslaTion>")
      .replace("robot.xml", "file=\"end.xml\" prefix=\"Tail\"", "File=\"end.xml\" PREFIX=\"Tail\"");
  EXPECT_EQ(files.scenario().robot.links.front().pose.position.y(), 0.2);
}

TEST(RobotFormat, PosesOfNestedKinBodiesCompound) {
  MemoryFiles files = small_scenario();
  // Outer: 1 m along x, turned by 90 degrees about z. Inner: 2 m along its x, turned by 90 degrees about its x.
  // Body: 0.1 m along its z.
  files.replace("robot.xml", "<KinBody file=\"end.xml\" prefix=\"Tail\"/>", R"(
    <KinBody prefix="T"><translation>1 0 0</translation><rotationaxis>0 0 1 90</rotationaxis>
      <KinBody prefix="ail" file="end.xml"><translation>2 0 0</translation><rotationaxis>5 0 0 90</rotationaxis></KinBody>
    </KinBody>)");
  files.replace("end.xml", "<Geom", "<translation>0 0 0.1</translation><Geom");
  const Scenario scenario = files.scenario();
  const Pose pose = link_of(scenario, "TailEnd").pose;
  // The inner frame's z is the outer frame's -y, which is the robot's +x: (1, 0, 0) + (0, 2, 0) + (0.1, 0, 0).
  EXPECT_TRUE(pose.position.isApprox(Eigen::Vector3d(1.1, 2.0, 0.0), 1e-12)) << pose.position.transpose();
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(RobotFormat, AQuaternionIsWrittenWithTheRealPartFirst) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>",
                "<translation>0 0.2 0</translation><quat>2 0 0 2</quat>");
  const Pose pose = link_of(files.scenario(), "Head").pose;
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12))
      << "1 0 0 1 is a quarter turn about z";
}

TEST(RobotFormat, ARotationMatrixIsWrittenRowByRow) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>",
                "<translation>0 0.2 0</translation><RotationMat>0.866 -0.5 0 0.5 0.866 0 0 0 1</RotationMat>");
  const Pose pose = link_of(files.scenario(), "Head").pose;
  // By 30 degrees about z; three digits are as many as people write.
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(0.8660254, 0.5, 0), 1e-4));
  EXPECT_NEAR(pose.orientation.norm(), 1.0, 1e-15);
}

TEST(RobotFormat, RepeatedTranslationsAddUpAndRepeatedRotationsFollowEachOther) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>",
                "<translation>0 0.2 0</translation><rotationaxis>1 0 0 90</rotationaxis>"
                "<translation>0.5 0 0</translation><rotationaxis>0 0 1 90</rotationaxis>");
  const Pose pose = link_of(files.scenario(), "Head").pose;
  EXPECT_TRUE(pose.position.isApprox(Eigen::Vector3d(0.5, 0.2, 0)));
  // x: y first, as the turn about x leaves x alone. y: first to z, where the turn about z leaves it.
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_TRUE((pose.orientation * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(RobotFormat, ABodyMayHaveItsPoseInTheFrameOfAnother) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>",
                "<offsetfrom>Middle</offsetfrom><translation>0 0.05 0</translation>");
  files.replace("robot.xml", "<Body name=\"Middle\">", "<Body name=\"Middle\"><translation>0 0.2 0</translation>");
  EXPECT_DOUBLE_EQ(link_of(files.scenario(), "Head").pose.position.y(), 0.25);
}

TEST(RobotFormat, AnchorAndAxisAreInTheFrameOfTheBodyOfOffsetfrom) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<translation>0 0.2 0</translation>",
                "<translation>0 0.2 0</translation><rotationaxis>1 0 0 90</rotationaxis>");
  const Joint joint = joint_of(files.scenario(), "J2");
  // The body's y is the robot's z and its z is the robot's -y.
  EXPECT_TRUE(joint.anchor.isApprox(Eigen::Vector3d(0, 0.2, 0.001), 1e-12)) << joint.anchor.transpose();
  EXPECT_TRUE(joint.axis.isApprox(-Eigen::Vector3d::UnitY(), 1e-12)) << joint.axis.transpose();
}

TEST(RobotFormat, WithoutOffsetfromTheFrameIsThatOfTheKinBody) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<KinBody name=\"body\">", "<KinBody name=\"body\"><translation>0 0 3</translation>");
  files.replace("robot.xml", "<offsetfrom>Head</offsetfrom>", "");
  EXPECT_TRUE(joint_of(files.scenario(), "J2").anchor.isApprox(Eigen::Vector3d(0, 0.001, 3)));
}

TEST(RobotFormat, AnAxisBecomesAUnitVector) {
  EXPECT_EQ(joint_of(small_scenario().scenario(), "J1").axis, Eigen::Vector3d::UnitX());
}

TEST(RobotFormat, AnAxisIsReversedIfTheHeadwardBodyIsFirst) {
  // In OpenRAVE the angle turns the second body relative to the first, here the one towards the head.
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<body>Middle</body>\n      <body>Head</body>",
                "<body>Head</body>\n      <body>Middle</body>");
  const Scenario scenario = files.scenario();
  EXPECT_EQ(joint_of(scenario, "J2").axis, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(joint_of(scenario, "J2").lower_limit, -0.5) << "the angle itself is the same";
  EXPECT_EQ(joint_of(scenario, "J1").axis, Eigen::Vector3d::UnitX());
}

TEST(RobotFormat, TheHeadMayHaveAPrefixAndAnyCase) {
  MemoryFiles files = small_scenario();
  files.replace("end.xml", "name=\"End\"", "name=\"hEAD\"").replace("robot.xml", "TailEnd", "TailhEAD");
  std::string& robot = files.texts["robot.xml"];
  for (std::size_t at = robot.find("Head"); at != std::string::npos; at = robot.find("Head", at)) {
    robot.replace(at, 4, "Tip");
  }
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.robot.links.front().name, "TailhEAD");
  EXPECT_EQ(scenario.robot.joints.front().name, "J1");
  EXPECT_EQ(scenario.kernel.slots[1].group, JointMask(0b10)) << "mask 01 is J2, which is kernel joint 1 here";
}

TEST(RobotFormat, WithoutAHeadTheEndThatComesLastInTheFileLeads) {
  MemoryFiles files = small_scenario();
  std::string& robot = files.texts["robot.xml"];
  for (std::size_t at = robot.find("Head"); at != std::string::npos; at = robot.find("Head", at)) {
    robot.replace(at, 4, "Tip");
  }
  EXPECT_EQ(files.scenario().robot.links.front().name, "Tip");
}

TEST(RobotFormat, LimitsInDegreesReachTheKernelFromTheirText) {
  const Scenario scenario = small_scenario().scenario();
  EXPECT_EQ(scenario.joint_limits[1].lower, -(1 << 29));
  EXPECT_EQ(scenario.joint_limits[1].upper, 1 << 30);
  EXPECT_DOUBLE_EQ(scenario.robot.joints[1].lower_limit, -std::numbers::pi / 4);
}

TEST(RobotFormat, LimitsInRadiansAreRoundedToTheKernelsSteps) {
  const Scenario scenario = small_scenario().scenario();
  const double steps_per_radian = 2.0 / std::numbers::pi * (1 << 30);
  EXPECT_NEAR(scenario.joint_limits[0].lower, -0.5 * steps_per_radian, 0.5);
  EXPECT_NEAR(scenario.joint_limits[0].upper, 0.75 * steps_per_radian, 0.5);
}

TEST(RobotFormat, LimitsBeyondARightAngleStayInTheModelButNotInTheKernel) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<limitsdeg>-45 90</limitsdeg>", "<limitsdeg>-270 120</limitsdeg>");
  const Scenario scenario = files.scenario();
  EXPECT_DOUBLE_EQ(scenario.robot.joints[1].lower_limit, -1.5 * std::numbers::pi);
  EXPECT_EQ(scenario.joint_limits[1].lower, -(1 << 30));
  EXPECT_EQ(scenario.joint_limits[1].upper, 1 << 30);
  EXPECT_NE(scenario.remarks[0].find("'J1' has limits beyond +-90 degrees"), std::string::npos);
}

TEST(RobotFormat, TheOlderStopsAreDegreesAboutTheOppositeAxis) {
  // As in OpenRAVE, which asks its users to write <limitsdeg> instead and to negate the axis.
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<limitsdeg>-45 90</limitsdeg>", "<lostop>-45</lostop><histop>90</histop>");
  const Scenario scenario = files.scenario();
  const Joint& joint = joint_of(scenario, "J1");
  EXPECT_EQ(joint.axis, -Eigen::Vector3d::UnitX());
  EXPECT_DOUBLE_EQ(joint.lower_limit, -std::numbers::pi / 4);
  EXPECT_EQ(scenario.joint_limits[1].lower, -(1 << 29));
  EXPECT_EQ(scenario.joint_limits[1].upper, 1 << 30);
}

TEST(RobotFormat, LimitsAndSpeedsHaveOneValueInEveryWriting) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<limits>-0.5 0.75</limits>", "<limitsrad>-0.5 0.75</limitsrad>")
      .replace("robot.xml", "<maxvel>5</maxvel>", "<maxveldeg>180</maxveldeg><hardmaxvel>9</hardmaxvel>");
  const Scenario scenario = files.scenario();
  EXPECT_EQ(joint_of(scenario, "J2").lower_limit, -0.5);
  EXPECT_EQ(joint_of(scenario, "J2").upper_limit, 0.75);
  EXPECT_DOUBLE_EQ(joint_of(scenario, "J2").max_speed, std::numbers::pi);
}

TEST(RobotFormat, LimitsMayHaveAnyNumberOfDigitsAndAPlus) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<limitsdeg>-45 90</limitsdeg>",
                "<limitsdeg>-45.0000000000000000000000000000 +22.5</limitsdeg>");
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.joint_limits[1].lower, -(1 << 29));
  EXPECT_EQ(scenario.joint_limits[1].upper, 1 << 28);
}

TEST(RobotFormat, AMassOfItsOwnBoxHasThatBoxesInertia) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<Mass type=\"mimicgeom\">\n        <density>",
                "<Mass type=\"box\"><extents>0.5 1 2</extents><com>1 2 3</com>\n        <density>");
  const MassProperties mass = link_of(files.scenario(), "Head").mass;
  EXPECT_DOUBLE_EQ(mass.mass, 1000.0 * 1 * 2 * 4);
  EXPECT_EQ(mass.center, Eigen::Vector3d(1, 2, 3));
  // m/12 (b^2 + c^2) with full sides 1, 2, 4.
  EXPECT_TRUE(mass.inertia.isApprox(Eigen::Vector3d(20, 17, 5).asDiagonal().toDenseMatrix() * (8000.0 / 12)));
}

TEST(RobotFormat, AMassOfItsOwnSphereOrCylinderHasThatSolidsInertia) {
  MemoryFiles files = small_scenario();
  files
      .replace("robot.xml", "<Mass type=\"mimicgeom\">\n        <density>",
               "<Mass type=\"sphere\"><radius>0.5</radius>\n        <density>")
      .replace("robot.xml", "<Mass type=\"mimicgeom\">\n        <total>",
               "<Mass type=\"cylinder\"><radius>0.2</radius><height>0.6</height><com>0 1 0</com>\n        <total>");
  const Scenario scenario = files.scenario();
  const MassProperties sphere = link_of(scenario, "Head").mass;
  EXPECT_DOUBLE_EQ(sphere.mass, 1000.0 * std::numbers::pi / 6);  // diameter 1
  EXPECT_TRUE(sphere.inertia.isApprox(Eigen::Matrix3d::Identity() * (0.4 * sphere.mass * 0.25)));
  const MassProperties cylinder = link_of(scenario, "Middle").mass;
  EXPECT_EQ(cylinder.mass, 0.3);
  EXPECT_EQ(cylinder.center, Eigen::Vector3d(0, 1, 0));
  const double across = 0.3 * (3 * 0.04 + 0.36) / 12;
  EXPECT_TRUE(cylinder.inertia.isApprox(Eigen::Vector3d(across, 0.006, across).asDiagonal().toDenseMatrix()));
}

TEST(RobotFormat, TheDensityOfAKinBodyCountsForItsBodiesWithoutAMass) {
  MemoryFiles files = small_scenario();
  const double head = link_of(files.scenario(), "Head").mass.mass;
  files.replace("robot.xml", "<Mass type=\"mimicgeom\">\n        <density>1000</density>\n      </Mass>", "")
      .replace("robot.xml", "<KinBody name=\"body\">",
               "<KinBody name=\"body\"><Mass type=\"mimicgeom\"><density>500</density></Mass>");
  const Scenario scenario = files.scenario();
  EXPECT_DOUBLE_EQ(link_of(scenario, "Head").mass.mass, head / 2);
  EXPECT_EQ(link_of(scenario, "Middle").mass.mass, 0.3);
  EXPECT_EQ(link_of(scenario, "TailEnd").mass.mass, 0.1) << "of the file's own KinBody";
}

TEST(RobotFormat, AdjacentBodiesThatNoJointJoinsAreWarnedOfIfLinksTouchEachOther) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<KinBody name=\"body\">",
                "<KinBody name=\"body\"><adjacent>Middle Head</adjacent><adjacent>Head TailEnd</adjacent>");
  EXPECT_EQ(files.scenario().warnings,
            std::vector<std::string>{"robot.xml:6: <adjacent> has no effect: no joint joins 'Head' and 'TailEnd', so "
                                     "they touch each other"});
  files.replace("environment.xml", "<selfcollision>1", "<selfcollision>0");
  EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{});
}

TEST(RobotFormat, AMimickedSphereHasTheMassOfItsDensity) {
  const MassProperties mass = link_of(small_scenario().scenario(), "Head").mass;
  const double expected = 1000.0 * 4.0 / 3.0 * std::numbers::pi * std::pow(0.03, 3);
  EXPECT_NEAR(mass.mass, expected, 1e-12);
  EXPECT_NEAR(mass.inertia(1, 1), 0.4 * expected * 0.03 * 0.03, 1e-15);
}

TEST(RobotFormat, AMimickedCylinderHasItsAxisAlongY) {
  MemoryFiles files = small_scenario();
  files.replace("end.xml", R"(<Mass type="custom">
      <total>0.1</total>
      <com>0 -0.01 0</com>
      <inertia>1e-4 0 0 0 2e-4 0 0 0 3e-4</inertia>)",
                R"(<Mass type="mimicgeom"><total>0.1</total>)");
  const MassProperties mass = link_of(files.scenario(), "TailEnd").mass;
  const double along = 0.1 * 0.02 * 0.02 / 2;
  const double across = 0.1 * (3 * 0.02 * 0.02 + 0.06 * 0.06) / 12;
  EXPECT_TRUE(mass.inertia.isApprox(Eigen::Vector3d(across, along, across).asDiagonal().toDenseMatrix()));
}

TEST(RobotFormat, SeveralSolidsAddUpByTheParallelAxisTheorem) {
  // Two cubes of side 0.2, one of them turned, centres 1 m apart along z.
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<Geom type=\"sphere\">\n        <radius>0.03</radius>\n      </Geom>",
                "<Geom type=\"box\"><extents>0.1 0.1 0.1</extents></Geom><Geom type=\"box\">"
                "<extents>0.1 0.1 0.1</extents><translation>0 0 1</translation><rotationaxis>1 2 3 50</rotationaxis>"
                "</Geom>");
  const MassProperties mass = link_of(files.scenario(), "Head").mass;
  EXPECT_NEAR(mass.mass, 16.0, 1e-12);
  EXPECT_TRUE(mass.center.isApprox(Eigen::Vector3d(0, 0, 0.5)));
  const double cube = 8.0 * 0.2 * 0.2 / 6;
  EXPECT_NEAR(mass.inertia(0, 0), 2 * (cube + 8 * 0.25), 1e-9);
  EXPECT_NEAR(mass.inertia(2, 2), 2 * cube, 1e-9);
  EXPECT_NEAR(mass.inertia(0, 1), 0.0, 1e-9);
}

TEST(RobotFormat, ACustomMassGivesTotalCentreAndInertia) {
  const MassProperties mass = link_of(small_scenario().scenario(), "TailEnd").mass;
  EXPECT_EQ(mass.mass, 0.1);
  EXPECT_EQ(mass.center, Eigen::Vector3d(0, -0.01, 0));
  EXPECT_EQ(mass.inertia, Eigen::Matrix3d(Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal()));
}

TEST(RobotFormat, GeometriesKeepShapeSizePoseAndFriction) {
  const Scenario scenario = small_scenario().scenario();
  const Geometry cylinder = link_of(scenario, "TailEnd").geometries[0];
  EXPECT_EQ(cylinder.shape, Shape::cylinder);
  EXPECT_EQ(cylinder.extents.x(), 0.02);
  EXPECT_EQ(cylinder.extents.y(), 0.03) << "half the height";
  EXPECT_EQ(cylinder.friction, 0.5);
  const Geometry box = link_of(scenario, "Middle").geometries[0];
  EXPECT_EQ(box.extents, Eigen::Vector3d(0.01, 0.1, 0.02));
  EXPECT_EQ(box.pose.position, Eigen::Vector3d(0, 0.1, 0));
  EXPECT_FALSE(box.friction.has_value());
}

TEST(RobotFormat, APathIsFirstRelativeToTheFileThatNamesIt) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "<robot>robot.xml</robot>", "<robot>robots/robot.xml</robot>");
  files.texts["robots/robot.xml"] = files.texts["robot.xml"];
  EXPECT_EQ(files.scenario().robot.links.back().mass.mass, 0.1) << "end.xml beside the top-level file";
  files.texts["robots/end.xml"] = files.texts["end.xml"];
  files.replace("robots/end.xml", "<total>0.1</total>", "<total>0.2</total>");
  EXPECT_EQ(files.scenario().robot.links.back().mass.mass, 0.2) << "end.xml beside the robot file";
}

TEST(RobotFormat, PathsMayGoUp) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "<robot>robot.xml</robot>", "<robot>a/b/../../c/robot.xml</robot>");
  files.texts["c/robot.xml"] = files.texts["robot.xml"];
  files.texts["shared/end.xml"] = files.texts["end.xml"];
  files.replace("c/robot.xml", "file=\"end.xml\"", "file=\"../shared/end.xml\"");
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.sources[1].path, "c/robot.xml");
  EXPECT_EQ(scenario.sources[2].path, "shared/end.xml");
}

TEST(RobotFormat, SixtyFourJointsAreAccepted) {
  MemoryFiles files = small_scenario();
  std::string robot = "<Robot><KinBody>";
  for (int i = 0; i <= 64; ++i) {
    robot += "<KinBody prefix=\"b" + std::to_string(i) + "\" file=\"end.xml\"/>";
  }
  for (int i = 0; i < 64; ++i) {
    const std::string number = std::to_string(i);
    robot +=
        "<Joint name=\"J" + number + "\" type=\"hinge\"><body>b" + number + "End</body><body>b" +
        std::to_string(i + 1) +
        "End</body><axis>1 0 0</axis><maxtorque>1</maxtorque><maxvel>1</maxvel><limitsdeg>-1 1</limitsdeg></Joint>";
  }
  files.texts["robot.xml"] = robot + "</KinBody></Robot>";
  files.texts["actuation.xml"] =
      "<actuation><actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"" + std::string(64, '1') +
      "\"/></actuationModule></actuation>";
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.robot.links.size(), 65U);
  EXPECT_EQ(scenario.kernel.joint_count, 64);
  EXPECT_EQ(scenario.robot.joints[0].name, "J63");
  EXPECT_EQ(scenario.robot.servo.gain, ServoModel{}.gain);
}

TEST(RobotFormat, AServoMayHaveALatency) {
  MemoryFiles files = small_scenario();
  EXPECT_EQ(files.scenario().robot.servo.latency_us, 0U);
  files.replace("robot.xml", "</period>", "</period><latency unit=\"ms\">12.5</latency>");
  EXPECT_EQ(files.scenario().robot.servo.latency_us, 12'500U);
}

}  // namespace
}  // namespace proleg::sim
