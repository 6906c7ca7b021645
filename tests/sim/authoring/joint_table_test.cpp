#include "sim/authoring/joint_table.hpp"

#include <gtest/gtest.h>

#include <string>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/authoring/chain_change.hpp"
#include "sim/authoring/robot_contents.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

class JointTableTest : public testing::Test {
 protected:
  void set(const std::vector<JointRow>& rows) {
    draft_.change("table", {}, [&](DraftChange& edit) { set_joint_table(edit, rows); });
  }
  [[nodiscard]] std::string refusal(const std::vector<JointRow>& rows) {
    const std::string before = draft_.text("robot.xml");
    std::string message = message_of<InputError>([&] { set(rows); });
    EXPECT_EQ(draft_.text("robot.xml"), before) << "what is refused changes nothing";
    return message;
  }
  [[nodiscard]] JointContents joint(std::size_t number) const { return read_robot_contents(draft_).joints.at(number); }

  MemoryFiles files_ = small_scenario();
  const std::string original_ = files_.texts.at("robot.xml");
  Draft draft_{files_.scenario(), files_};
};

// Kernel order: the head's joint J2 is joint 0.
JointRow row_of(unsigned joint) {
  JointRow row;
  row.joint = joint;
  return row;
}

TEST_F(JointTableTest, SetsAllValuesOfSeveralJointsAsOneChange) {
  JointRow head = row_of(0);
  head.name = "neck";
  head.axis = Eigen::Vector3d(1, 0, 0);
  head.limits = {-30.0, 45.0};
  JointRow tail = row_of(1);
  tail.torque = 0.25;
  tail.speed = 6.0;
  set({head, tail});
  EXPECT_EQ(joint(0).name, "neck");
  EXPECT_EQ(joint(0).axis, Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(joint(0).lower_deg, -30.0, 1e-6);
  EXPECT_NEAR(joint(0).upper_deg, 45.0, 1e-6);
  EXPECT_EQ(joint(0).max_torque, 0.3) << "what is missing stays";
  EXPECT_EQ(joint(1).name, "J1");
  EXPECT_EQ(joint(1).max_torque, 0.25);
  EXPECT_EQ(joint(1).max_speed, 6.0);
  EXPECT_TRUE(draft_.undo());
  EXPECT_EQ(draft_.text("robot.xml"), original_);
  EXPECT_FALSE(draft_.undo()) << "it was one change";
}

TEST_F(JointTableTest, JointsCanExchangeTheirNamesAndTheirGaitGoesAlong) {
  JointRow head = row_of(0);
  head.name = "J1";
  JointRow tail = row_of(1);
  tail.name = "J2";
  set({head, tail});
  EXPECT_EQ(joint(0).name, "J1");
  EXPECT_EQ(joint(1).name, "J2");
  EXPECT_NE(draft_.text("actuation.xml").find(R"(value="10" unit="deg" joint="J2")"), std::string::npos);
}

TEST_F(JointTableTest, NamesTheJointAndTheValueThatTheReaderRefuses) {
  JointRow good = row_of(0);
  good.torque = 0.5;
  JointRow bad = row_of(1);
  bad.torque = -1.0;
  EXPECT_EQ(refusal({good, bad}).find("torque of J1: found '-1'"), 0U) << refusal({good, bad});
  bad.torque = 1.0;
  bad.limits = {10.0, 90.0};
  EXPECT_EQ(refusal({good, bad}).find("limits of J1: found"), 0U) << refusal({good, bad});
  bad.limits.reset();
  bad.axis = Eigen::Vector3d::Zero();
  EXPECT_EQ(refusal({good, bad}).find("axis of J1: found"), 0U) << refusal({good, bad});
  bad.axis.reset();
  bad.name = "J2";
  EXPECT_NE(refusal({bad}).find("a second joint 'J2'"), std::string::npos) << refusal({bad});
  bad.name = "";
  EXPECT_NE(refusal({bad}).find("1 to 60 characters"), std::string::npos);
}

TEST_F(JointTableTest, RefusesAJointThatIsNotThereOrIsThereTwice) {
  EXPECT_NE(refusal({row_of(2)}).find("a number below 2"), std::string::npos);
  EXPECT_NE(refusal({row_of(1), row_of(1)}).find("each joint once"), std::string::npos);
}

TEST_F(JointTableTest, AnEmptyTableChangesNothing) {
  set({});
  EXPECT_EQ(draft_.text("robot.xml"), original_);
}

TEST_F(JointTableTest, NewJointsAreMadeBeforeTheirValuesInTheSameChange) {
  JointRow head = row_of(0);
  head.torque = 0.7;
  draft_.change("table", {}, [&](DraftChange& edit) {
    ChainChange(edit).set_joint_count(3);
    set_joint_table(edit, {head});
  });
  ASSERT_EQ(read_robot_contents(draft_).joints.size(), 3U);
  EXPECT_EQ(joint(0).max_torque, 0.7);
  EXPECT_TRUE(draft_.undo());
  EXPECT_EQ(draft_.text("robot.xml"), original_);
}

}  // namespace
}  // namespace proleg::sim
