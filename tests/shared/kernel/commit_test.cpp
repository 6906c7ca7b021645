#include <gtest/gtest.h>

#include <cstdint>

#include "robot.hpp"

namespace proleg {
namespace {

constexpr unsigned joints = 3;

class Commit : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), joints), 0), Status::ok);
    ASSERT_EQ(reference.configure(kernel.configuration(), 0), Status::ok);
    amplitude = test::parameter_index(kernel, 0, "amplitude");
    offset = test::parameter_index(kernel, 0, "offset");
  }

  KernelOf<joints> kernel;
  KernelOf<joints> reference;
  unsigned amplitude = 0;
  unsigned offset = 0;
};

using Staging = Commit;

TEST_F(Commit, TakesEffectAtItsTickAndNotBefore) {
  constexpr std::uint32_t at = 37;
  ASSERT_EQ(kernel.stage(1, 0, 1, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, at), Status::ok);
  for (std::uint32_t tick = 0; tick < at; ++tick) {
    ASSERT_EQ(kernel.setpoint(1), reference.setpoint(1)) << "tick " << tick;
    ASSERT_EQ(kernel.parameter(0, 1, amplitude), test::degrees(40)) << "tick " << tick;
    kernel.advance();
    reference.advance();
  }
  // SYNC 37 computes state 38, the first one with the new value.
  ASSERT_EQ(kernel.setpoint(1), reference.setpoint(1));
  test::set(reference, 0, 1, "amplitude", test::degrees(20));
  for (int tick = 0; tick < 100; ++tick) {
    kernel.advance();
    reference.advance();
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(kernel.setpoint(joint), reference.setpoint(joint)) << "tick " << tick << " joint " << joint;
    }
  }
  EXPECT_EQ(kernel.parameter(0, 1, amplitude), test::degrees(20));
}

TEST_F(Commit, MayNameTheComingTick) {
  test::run(kernel, 5);
  ASSERT_EQ(kernel.stage(1, 0, 0, offset, test::degrees(9)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 5), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, offset), test::degrees(9));
}

TEST_F(Commit, ChangesAllValuesOfItsTransactionTogether) {
  for (unsigned joint = 0; joint < joints; ++joint) {
    ASSERT_EQ(kernel.stage(7, 0, joint, amplitude, test::degrees(10 + joint)), Status::ok);
    ASSERT_EQ(kernel.stage(7, 0, joint, offset, test::degrees(joint)), Status::ok);
  }
  ASSERT_EQ(kernel.commit(7, 2), Status::ok);
  test::run(kernel, 3);
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(kernel.parameter(0, joint, amplitude), test::degrees(10 + joint));
    EXPECT_EQ(kernel.parameter(0, joint, offset), test::degrees(joint));
  }
}

// A commit is broadcast three times.
TEST_F(Commit, MayBeRepeated) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  EXPECT_EQ(kernel.commit(1, 10), Status::ok);
  EXPECT_EQ(kernel.commit(1, 10), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.commit(1, 10), Status::ok);
  EXPECT_EQ(kernel.commit(1, 11), Status::staging_closed);
  EXPECT_EQ(kernel.commit(2, 10), Status::staging_closed);
}

TEST_F(Commit, IsRefusedForATickThatIsOver) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  test::run(kernel, 10);
  EXPECT_EQ(kernel.commit(1, 9), Status::commit_in_the_past);
  test::run(kernel, 10);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(40)) << "old values stay";
  EXPECT_EQ(kernel.commit(1, 25), Status::ok) << "what was staged is still there";
}

TEST_F(Commit, IsRefusedForATransactionThatWasNotStaged) {
  EXPECT_EQ(kernel.commit(1, 10), Status::nothing_staged);
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  EXPECT_EQ(kernel.commit(2, 10), Status::nothing_staged);
}

TEST_F(Commit, IsOverOnceItTookEffect) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 0), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.commit(1, 5), Status::nothing_staged);
  EXPECT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(30)), Status::ok) << "and the next one may be staged";
  EXPECT_EQ(kernel.commit(1, 5), Status::ok);
}

TEST_F(Staging, IsClosedWhileATransactionWaitsForItsTick) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 3), Status::ok);
  EXPECT_EQ(kernel.stage(1, 0, 0, offset, 0), Status::staging_closed);
  EXPECT_EQ(kernel.stage(2, 0, 0, offset, 0), Status::staging_closed);
  test::run(kernel, 4);
  EXPECT_EQ(kernel.stage(2, 0, 0, offset, 0), Status::ok);
}

TEST_F(Staging, UnderANewNumberDropsWhatWasStagedUnderTheOld) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.stage(1, 0, 1, amplitude, test::degrees(21)), Status::ok);
  ASSERT_EQ(kernel.stage(2, 0, 0, offset, test::degrees(5)), Status::ok);
  EXPECT_EQ(kernel.commit(1, 0), Status::nothing_staged);
  ASSERT_EQ(kernel.commit(2, 0), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, offset), test::degrees(5));
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(40));
  EXPECT_EQ(kernel.parameter(0, 1, amplitude), test::degrees(40));
}

TEST_F(Staging, OfTheSameParameterTwiceKeepsTheLastValue) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(25)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 0), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(25));
}

TEST_F(Staging, RefusesWhatSettingRefusesAndChangesNothing) {
  EXPECT_EQ(kernel.stage(1, 1, 0, 0, 0), Status::unknown_slot);
  EXPECT_EQ(kernel.stage(1, 0, joints, 0, 0), Status::unknown_joint);
  EXPECT_EQ(kernel.stage(1, 0, 0, 99, 0), Status::unknown_parameter);
  EXPECT_EQ(kernel.stage(1, 0, 0, amplitude, -1), Status::out_of_range);
  EXPECT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(90) + 1), Status::out_of_range);
  EXPECT_EQ(kernel.commit(1, 0), Status::nothing_staged);
  for (int tick = 0; tick < 20; ++tick) {
    kernel.advance();
    reference.advance();
    ASSERT_EQ(kernel.setpoint(0), reference.setpoint(0));
  }
}

// A refused value does not drop the transaction that it came with or before.
TEST_F(Staging, KeepsTheOtherValuesWhenOneIsRefused) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.stage(2, 0, 0, amplitude, -1), Status::out_of_range);
  ASSERT_EQ(kernel.commit(1, 0), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(20));
}

TEST_F(Staging, IsDroppedByAReset) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 5), Status::ok);
  kernel.reset();
  test::run(kernel, 10);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(40));
  EXPECT_EQ(kernel.commit(1, 20), Status::nothing_staged);
}

}  // namespace
}  // namespace proleg
