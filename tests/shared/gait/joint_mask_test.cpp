#include "shared/gait/joint_mask.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace proleg {
namespace {

TEST(JointMask, FirstHoldsTheJointsNearestToTheHead) {
  EXPECT_EQ(JointMask::first(0).bits(), 0U);
  EXPECT_EQ(JointMask::first(5).bits(), 0b11111U);
  EXPECT_EQ(JointMask::first(64).bits(), ~std::uint64_t{0});
}

TEST(JointMask, FindsTheNearestMembersOnBothSides) {
  std::mt19937_64 random(64);
  for (int i = 0; i < 2000; ++i) {
    const JointMask mask(random() & random());
    for (unsigned joint = 0; joint < max_joints; ++joint) {
      int before = -1;
      int from = -1;
      int after = -1;
      for (int other = 0; other < static_cast<int>(max_joints); ++other) {
        if (!mask.contains(static_cast<unsigned>(other))) {
          continue;
        }
        before = other < static_cast<int>(joint) ? other : before;
        from = from < 0 && other >= static_cast<int>(joint) ? other : from;
        after = after < 0 && other > static_cast<int>(joint) ? other : after;
      }
      ASSERT_EQ(mask.before(joint), before) << std::hex << mask.bits() << " at " << std::dec << joint;
      ASSERT_EQ(mask.from(joint), from) << std::hex << mask.bits() << " at " << std::dec << joint;
      ASSERT_EQ(mask.after(joint), after) << std::hex << mask.bits() << " at " << std::dec << joint;
    }
  }
}

TEST(JointMask, HoldsNoJointBeyondTheLast) {
  const JointMask all = JointMask::first(64);
  EXPECT_TRUE(all.contains(63));
  EXPECT_FALSE(all.contains(64));
  EXPECT_EQ(all.from(64), -1);
  EXPECT_EQ(all.after(63), -1);
}

}  // namespace
}  // namespace proleg
