#include "sim/authoring/robot_change.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "sim/authoring/sensor_change.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

class RobotTest : public testing::Test {
 protected:
  template <typename Change>
  void change(const Change& change) {
    const Scenario before = draft_.scenario();
    draft_.change("test", {}, [&](DraftChange& edit) {
      RobotChange robot(before, edit);
      change(robot);
    });
  }
  template <typename Change>
  void change_sensors(const Change& change) {
    const Scenario before = draft_.scenario();
    const RobotContents contents = robot();
    draft_.change("test", {}, [&](DraftChange& edit) {
      SensorChange sensors(before, contents, edit);
      change(sensors);
    });
  }
  template <typename Change>
  [[nodiscard]] std::string refusal(const Change& refused) {
    const std::string before = text();
    std::string message = message_of<InputError>([&] { change(refused); });
    EXPECT_EQ(text(), before) << "what is refused changes nothing";
    return message;
  }
  [[nodiscard]] RobotContents robot() const { return read_robot_contents(draft_); }
  [[nodiscard]] std::string text(const std::string& file = "robot.xml") const { return draft_.text(file); }
  [[nodiscard]] const Joint& joint(std::size_t number) const { return draft_.scenario().robot.joints[number]; }

  MemoryFiles files_ = small_scenario();
  const std::string original_ = files_.texts.at("robot.xml");
  Draft draft_{files_.scenario(), files_};
};

// Kernel order: the head's joint J2 is joint 0.
constexpr unsigned front = 0;
constexpr unsigned rear = 1;

TEST_F(RobotTest, IsAChainFromTheHead) {
  const RobotContents now = robot();
  ASSERT_EQ(now.joints.size(), 2U);
  EXPECT_EQ(now.joints[front].name, "J2");
  EXPECT_EQ(now.joints[front].axis, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(now.joints[rear].axis, Eigen::Vector3d(2, 0, 0)) << "as in the file";
  EXPECT_NEAR(now.joints[rear].lower_deg, -45.0, 1e-9);
  ASSERT_EQ(now.links.size(), 3U);
  EXPECT_EQ(now.links[1].name, "Middle");
  EXPECT_EQ(now.links[1].file, "robot.xml");
  EXPECT_EQ(now.links[2].file, "end.xml");
  EXPECT_TRUE(now.sensors.empty());
}

TEST_F(RobotTest, AValueOfAJointChangesItsTag) {
  change([](RobotChange& robot) { robot.set_axis(JointMask::of(rear), {0, 0, 1}); });
  EXPECT_EQ(text(), replaced(original_, "<axis>2 0 0</axis>", "<axis>0 0 1</axis>"));
  change([](RobotChange& robot) { robot.set_axis(JointMask::of(rear), {2, 0, 0}); });
  change([](RobotChange& robot) { robot.set_max_torque(JointMask::of(front), 0.25); });
  EXPECT_EQ(text(), replaced(original_, "<maxtorque>0.3</maxtorque>", "<maxtorque>0.25</maxtorque>"));
  EXPECT_EQ(joint(front).max_torque, 0.25);
}

TEST_F(RobotTest, LimitsKeepTheUnitOfTheFile) {
  change([](RobotChange& robot) { robot.set_limits(JointMask::first(2), -30, 60); });
  for (const unsigned number : {front, rear}) {
    EXPECT_NEAR(joint(number).lower_limit, -30 * degree, 1e-8);
    EXPECT_NEAR(joint(number).upper_limit, 60 * degree, 1e-8);
  }
  EXPECT_NE(text().find("<limitsdeg>-30 60</limitsdeg>"), std::string::npos);
  EXPECT_NE(text().find("<limits>-0.523598776 1.04719755</limits>"), std::string::npos) << text();
}

TEST_F(RobotTest, OldLimitsAndSpeedsInDegreesStaySo) {
  files_.replace("robot.xml", "<limitsdeg>-45 90</limitsdeg>", "<lostop>-45</lostop><histop>90</histop>");
  files_.replace("robot.xml", "<maxvel>5</maxvel>", "<maxveldeg>200</maxveldeg>");
  Draft draft(files_.scenario(), files_);
  const Scenario before = draft.scenario();
  draft.change("test", {}, [&](DraftChange& edit) {
    RobotChange robot(before, edit);
    robot.set_limits(JointMask::of(rear), -20, 30);
    robot.set_max_speed(JointMask::of(front), std::numbers::pi);
  });
  EXPECT_NE(draft.text("robot.xml").find("<lostop>-20</lostop><histop>30</histop>"), std::string::npos);
  EXPECT_NE(draft.text("robot.xml").find("<maxveldeg>180</maxveldeg>"), std::string::npos);
  EXPECT_NEAR(draft.scenario().robot.joints[front].max_speed, std::numbers::pi, 1e-9);
}

TEST_F(RobotTest, AJointIsRenamedWhereverItIsNamed) {
  files_.replace("robot.xml", "</Robot>",
                 R"(<module joint="J1" node="3"/><module joint="J2" node="9"/>
<AttachedSensor name="effort"><joint>J1</joint><sensor type="ServoCurrent"/></AttachedSensor></Robot>)");
  files_.replace("actuation.xml", R"(value="10" unit="deg" joint="J1"/>)", R"(value="10" joint="J1"/>)");
  Draft draft(files_.scenario(), files_);
  const Scenario before = draft.scenario();
  draft.change("test", {}, [&](DraftChange& edit) { RobotChange(before, edit).rename_joint(rear, "knee & hip"); });
  const Scenario& now = draft.scenario();
  EXPECT_EQ(now.robot.joints[rear].name, "knee & hip");
  EXPECT_EQ(now.modules[rear].node, 3);
  EXPECT_EQ(now.robot.sensors.at(0).part, rear);
  EXPECT_NE(draft.text("actuation.xml").find("joint=\"knee &amp; hip\""), std::string::npos);
}

TEST_F(RobotTest, ServosHaveTheirTags) {
  change([](RobotChange& robot) { robot.set_servo("gain", 12.5); });
  EXPECT_EQ(text(), replaced(original_, "<gain>20</gain>", "<gain>12.5</gain>"));
  change([](RobotChange& robot) { robot.set_servo("latency", 5); });
  EXPECT_EQ(draft_.scenario().robot.servo.latency_us, 5000U);
}

TEST_F(RobotTest, MassAndFrictionAreOfTheBody) {
  change([](RobotChange& robot) { robot.set_mass(1, 0.2); });
  EXPECT_EQ(text(), replaced(original_, "<total>0.3</total>", "<total>0.2</total>"));
  change([](RobotChange& robot) { robot.set_friction(0, 0.8); });
  EXPECT_EQ(draft_.scenario().robot.links[0].geometries[0].friction, 0.8);
  change([](RobotChange& robot) { robot.set_friction(0, std::nullopt); });
  EXPECT_FALSE(draft_.scenario().robot.links[0].geometries[0].friction);
}

TEST_F(RobotTest, WhatCannotBeIsRefusedWithItsReason) {
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_limits(JointMask::of(rear), 10, 20); }).find("include 0"),
            std::string::npos);
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_axis(JointMask::of(rear), {0, 0, 0}); }), "");
  EXPECT_NE(refusal([](RobotChange& robot) {
              robot.set_axis(JointMask::of(7), {0, 0, 1});
            }).find("below 2"),
            std::string::npos);
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_axis({}, {0, 0, 1}); }).find("no joint"), std::string::npos);
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_mass(9, 1); }).find("below 3"), std::string::npos);
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_mass(1, -1); }), "");
  EXPECT_NE(refusal([](RobotChange& robot) { robot.set_servo("gain", 1e9); }), "");
  EXPECT_NE(refusal([](RobotChange& robot) { robot.rename_joint(front, "J1"); }).find("second joint"),
            std::string::npos);
  EXPECT_NE(refusal([](RobotChange& robot) { robot.rename_joint(front, ""); }), "");
}

TEST_F(RobotTest, EachKindOfSensorCanBeAddedOnEachSide) {
  for (const SensorKind kind : {SensorKind::touch, SensorKind::laser, SensorKind::servo_current,
                                SensorKind::inclinometer, SensorKind::accelerometer}) {
    for (std::size_t place = 0; place < sensor_places().size(); ++place) {
      change_sensors([&](SensorChange& sensors) { sensors.add(kind, 1, static_cast<SensorPlace>(place)); });
    }
  }
  const RobotContents now = robot();
  ASSERT_EQ(now.sensors.size(), 5 * sensor_places().size());
  // The middle link is a box of 20 x 200 x 40 mm around (0, 0.1, 0).
  const AttachedSensor& ahead = now.sensors[0].sensor;
  EXPECT_LT((ahead.pose.position - Eigen::Vector3d(0, 0.2, 0)).norm(), 1e-9);
  EXPECT_EQ(ahead.extents, Eigen::Vector3d(0.01, 0.004, 0.02));
  const AttachedSensor& below = now.sensors[5].sensor;
  EXPECT_LT((below.pose.position - Eigen::Vector3d(0, 0.1, -0.02)).norm(), 1e-9);
  const AttachedSensor& eye_to_the_left = now.sensors[8].sensor;
  EXPECT_LT((eye_to_the_left.pose.orientation * Eigen::Vector3d::UnitX() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-6)
      << "angle 0 of a laser is its x axis";
  EXPECT_EQ(now.sensors[12].part, "J1");
}

TEST_F(RobotTest, SensorsAreMovedRenamedSetAndRemoved) {
  change_sensors([](SensorChange& sensors) { sensors.add(SensorKind::laser, 0, SensorPlace::front); });
  const std::string added = text();
  change_sensors([](SensorChange& sensors) {
    sensors.place(0, {{0, 0.5, 0}, Eigen::Quaterniond::Identity()});
    sensors.set_property(0, "maxrange", "2.5");
    sensors.set_part(0, 2);
    sensors.rename(0, "look out");
  });
  const SensorContents now = robot().sensors.at(0);
  EXPECT_EQ(now.sensor.name, "look out");
  EXPECT_EQ(now.part, "TailEnd");
  EXPECT_EQ(now.sensor.scan.range, 2.5);
  EXPECT_EQ(now.sensor.pose.position, Eigen::Vector3d(0, 0.5, 0));
  ASSERT_TRUE(draft_.undo());
  EXPECT_EQ(text(), added) << "one change";
  change_sensors([](SensorChange& sensors) { sensors.remove(0); });
  EXPECT_EQ(text(), original_);
}

}  // namespace
}  // namespace proleg::sim
