#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "robot.hpp"

namespace proleg {
namespace {

class Slots : public testing::Test {
 protected:
  static constexpr unsigned joints = 4;

  /// Slots of direct angles on the given groups.
  void direct_access_on(std::initializer_list<std::uint64_t> groups) {
    KernelConfiguration configuration;
    configuration.joint_count = joints;
    std::size_t slot = 0;
    for (const std::uint64_t group : groups) {
      configuration.slots[slot++] = {&test::algorithm(test::direct), JointMask(group)};
    }
    ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  }

  void set_angle(unsigned slot, unsigned joint, double angle) {
    test::set(kernel, slot, joint, "angle", test::degrees(angle));
  }

  [[nodiscard]] bool limited(unsigned joint) const {
    return (kernel.frame(joint, 0).flags() & StateFrame::limited) != 0;
  }

  KernelOf<joints> kernel;
};

TEST_F(Slots, AddTheirAnglesJointByJointWhereTheirGroupsOverlap) {
  direct_access_on({0b0011, 0b0110});
  set_angle(0, 0, 10);
  set_angle(0, 1, 20);
  set_angle(1, 1, 5);
  set_angle(1, 2, -7);
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(0), test::degrees(10));
  EXPECT_EQ(kernel.setpoint(1), test::degrees(20) + test::degrees(5));
  EXPECT_EQ(kernel.setpoint(2), test::degrees(-7));
  EXPECT_EQ(kernel.setpoint(3), 0) << "no slot drives it";
}

TEST_F(Slots, DriveTheJointsOfTheirGroupAndNoOther) {
  direct_access_on({0b0101, 0});
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(kernel.drives(0, joint), joint == 0 || joint == 2);
    EXPECT_FALSE(kernel.drives(1, joint));
    EXPECT_FALSE(kernel.drives(2, joint)) << "an empty slot";
  }
  EXPECT_FALSE(kernel.drives(0, joints));
  EXPECT_FALSE(kernel.drives(max_slots, 0));
}

TEST_F(Slots, HoldAParameterForEachJoint) {
  direct_access_on({0b1111});
  test::set_all(kernel, 0, "angle", test::degrees(12));
  set_angle(0, 2, 34);
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(1), test::degrees(12));
  EXPECT_EQ(kernel.setpoint(2), test::degrees(34));
  EXPECT_EQ(kernel.parameter(0, 2, 0), test::degrees(34));
}

TEST_F(Slots, AreCutToNinetyDegreesByDefault) {
  direct_access_on({0b1111, 0b1111});
  set_angle(0, 0, 60);
  set_angle(1, 0, 50);
  set_angle(0, 1, -60);
  set_angle(1, 1, -50);
  set_angle(0, 2, 60);
  set_angle(1, 2, 30);
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(0), 1 << 30);
  EXPECT_EQ(kernel.setpoint(1), -(1 << 30));
  EXPECT_TRUE(limited(0));
  EXPECT_TRUE(limited(1));
  EXPECT_EQ(kernel.setpoint(2), 1 << 30);
  EXPECT_FALSE(limited(2)) << "exactly at the limit is not cut";
  EXPECT_FALSE(limited(3));
}

TEST_F(Slots, AreCutToTheLimitsOfTheJoint) {
  direct_access_on({0b1111});
  ASSERT_EQ(kernel.set_limits(1, test::degrees(-10), test::degrees(20)), Status::ok);
  test::set_all(kernel, 0, "angle", test::degrees(45));
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(0), test::degrees(45));
  EXPECT_EQ(kernel.setpoint(1), test::degrees(20));
  EXPECT_TRUE(limited(1));
  test::set_all(kernel, 0, "angle", test::degrees(-45));
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(1), test::degrees(-10));
  test::set_all(kernel, 0, "angle", 0);
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(1), 0);
  EXPECT_FALSE(limited(1));
}

TEST_F(Slots, SaturateWhereTheSumDoesNotFitInsteadOfWrapping) {
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();
  direct_access_on({0b1111, 0b1111, 0b1111, 0b1111});
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    set_angle(slot, 0, 90);
    set_angle(slot, 1, -90);
  }
  ASSERT_EQ(kernel.set_limits(0, lowest, highest), Status::ok);
  ASSERT_EQ(kernel.set_limits(1, lowest, highest), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.setpoint(0), highest);
  EXPECT_EQ(kernel.setpoint(1), lowest);
}

TEST_F(Slots, RefuseLimitsThatAreNone) {
  direct_access_on({0b1111});
  EXPECT_EQ(kernel.set_limits(joints, 0, 1), Status::unknown_joint);
  EXPECT_EQ(kernel.set_limits(0, 1, 0), Status::bad_limits);
  EXPECT_EQ(kernel.set_limits(0, 5, 5), Status::ok);
}

TEST_F(Slots, RefuseAParameterThatDoesNotExistOrDoesNotFitAndKeepTheOld) {
  direct_access_on({0b0001});
  set_angle(0, 0, 30);
  EXPECT_EQ(kernel.set_parameter(1, 0, 0, 0), Status::unknown_slot);
  EXPECT_EQ(kernel.set_parameter(max_slots, 0, 0, 0), Status::unknown_slot);
  EXPECT_EQ(kernel.set_parameter(0, 1, 0, 0), Status::unknown_joint);
  EXPECT_EQ(kernel.set_parameter(0, joints, 0, 0), Status::unknown_joint);
  EXPECT_EQ(kernel.set_parameter(0, 0, 1, 0), Status::unknown_parameter);
  EXPECT_EQ(kernel.set_parameter(0, 0, 0, test::degrees(90) + 1), Status::out_of_range);
  EXPECT_EQ(kernel.set_parameter(0, 0, 0, test::degrees(-90) - 1), Status::out_of_range);
  EXPECT_EQ(kernel.parameter(0, 0, 0), test::degrees(30));
}

TEST_F(Slots, MoveTheServoFromTheOldSetPointToTheNew) {
  direct_access_on({0b1111});
  set_angle(0, 0, 10);
  kernel.advance();
  set_angle(0, 0, 20);
  kernel.advance();
  EXPECT_EQ(kernel.previous_setpoint(0), test::degrees(10));
  EXPECT_EQ(kernel.setpoint(0), test::degrees(20));
}

TEST_F(Slots, StartFromTheirParametersAfterAReset) {
  direct_access_on({0b1111});
  set_angle(0, 0, 25);
  EXPECT_EQ(kernel.setpoint(0), 0);
  kernel.advance();
  kernel.reset();
  EXPECT_EQ(kernel.tick(), 0U);
  EXPECT_EQ(kernel.setpoint(0), test::degrees(25));
  EXPECT_EQ(kernel.previous_setpoint(0), test::degrees(25));
}

}  // namespace
}  // namespace proleg
