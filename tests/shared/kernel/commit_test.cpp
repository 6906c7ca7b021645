#include <gtest/gtest.h>

#include <cstdint>

#include "robot.hpp"

namespace proleg {
namespace {

class Commit : public testing::Test {
 protected:
  static constexpr unsigned joints = 3;

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
  EXPECT_EQ(kernel.commit(1, 11), Status::staging_closed) << "but not for another tick";
  test::run(kernel, 20);
  EXPECT_EQ(kernel.commit(1, 10), Status::ok) << "also late, when it took effect long ago";
  EXPECT_EQ(kernel.commit(1, 11), Status::nothing_staged);
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

TEST_F(Staging, IsClosedForACommittedTransactionAndOpenForTheNext) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 3), Status::ok);
  EXPECT_EQ(kernel.stage(1, 0, 0, offset, 0), Status::staging_closed);
  EXPECT_EQ(kernel.open(1), Status::staging_closed);
  EXPECT_EQ(kernel.stage(2, 0, 0, offset, test::degrees(2)), Status::ok);
  EXPECT_EQ(kernel.commit(2, 2), Status::ok) << "it may even come first";
  test::run(kernel, 3);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(40));
  EXPECT_EQ(kernel.parameter(0, 0, offset), test::degrees(2));
  test::run(kernel, 1);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(20));
}

// A ramp is a series of commits.
TEST_F(Commit, ManyMayWaitEachForItsOwnTick) {
  for (std::uint16_t i = 0; i < max_transactions; ++i) {
    ASSERT_EQ(kernel.stage(i, 0, 0, amplitude, test::degrees(30 + i)), Status::ok) << i;
    ASSERT_EQ(kernel.commit(i, 10U + 2U * i), Status::ok) << i;
  }
  EXPECT_EQ(kernel.open(99), Status::staging_full);
  EXPECT_EQ(kernel.stage(99, 0, 0, amplitude, 0), Status::staging_full);
  test::run(kernel, 10);
  for (unsigned i = 0; i < max_transactions; ++i) {
    kernel.advance();
    EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(30 + i)) << "tick " << kernel.tick();
    kernel.advance();
  }
  EXPECT_EQ(kernel.open(99), Status::ok);
}

TEST_F(Commit, OfTheSameTickTakeEffectInTheOrderOfTheirCommits) {
  ASSERT_EQ(kernel.stage(5, 0, 0, amplitude, test::degrees(25)), Status::ok);
  ASSERT_EQ(kernel.commit(5, 4), Status::ok);
  ASSERT_EQ(kernel.stage(3, 0, 0, amplitude, test::degrees(15)), Status::ok);
  ASSERT_EQ(kernel.commit(3, 4), Status::ok);
  test::run(kernel, 5);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(15));
}

// A robot-wide change need not touch every joint; the other modules receive the commit too.
TEST_F(Commit, MayHaveNothingForAJointOnceTheTransactionIsOpen) {
  ASSERT_EQ(kernel.open(9), Status::ok);
  EXPECT_EQ(kernel.open_transaction(), 9);
  EXPECT_EQ(kernel.staged_count(), 0U);
  EXPECT_EQ(kernel.commit(9, 3), Status::ok);
  test::run(kernel, 5);
  EXPECT_EQ(kernel.commit(9, 3), Status::ok);
}

TEST_F(Staging, GivesTheStagedValues) {
  std::int32_t value = 0;
  EXPECT_FALSE(kernel.staged_value(0, 1, amplitude, false, value));
  ASSERT_EQ(kernel.stage(1, 0, 1, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.stage_internal(1, 0, 1, 0, test::phase(45)), Status::ok);
  EXPECT_EQ(kernel.staged_count(), 2U);
  ASSERT_TRUE(kernel.staged_value(0, 1, amplitude, false, value));
  EXPECT_EQ(value, test::degrees(20));
  ASSERT_TRUE(kernel.staged_value(0, 1, 0, true, value));
  EXPECT_EQ(value, test::phase(45));
  ASSERT_EQ(kernel.commit(1, 10), Status::ok);
  EXPECT_EQ(kernel.staged_count(), 0U) << "committed is no longer staged";
  EXPECT_FALSE(kernel.staged_value(0, 1, amplitude, false, value));
}

TEST(StagingRoom, IsLimitedForEachJointAndARefusalKeepsWhatIsThere) {
  constexpr unsigned joints = 3;
  KernelOf<joints> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::coupled), joints), 0), Status::ok);
  const Declaration& about = kernel.configuration().slots[0].algorithm->declaration();
  const auto parameters = static_cast<unsigned>(about.parameters.size());
  const auto values = static_cast<unsigned>(about.internal_values.size());
  unsigned staged = 0;
  Status status = Status::ok;
  for (std::uint16_t transaction = 0; status == Status::ok; ++transaction) {
    for (unsigned i = 0; i < parameters + values && status == Status::ok; ++i) {
      status = i < parameters ? kernel.stage(transaction, 0, 1, i, about.parameters[i].minimum)
                              : kernel.stage_internal(transaction, 0, 1, i - parameters, 0);
      staged += status == Status::ok ? 1U : 0U;
    }
    if (status == Status::ok) {
      status = kernel.commit(transaction, 100);
    }
  }
  EXPECT_EQ(status, Status::staging_full);
  EXPECT_EQ(staged, max_staged_values);
  EXPECT_EQ(kernel.staged_count(), max_staged_values % (parameters + values));
  EXPECT_EQ(kernel.stage(kernel.open_transaction(), 0, 0, 0, 0), Status::ok) << "another joint has its own room";
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

// A rejected value does not drop the transaction that it belongs to, nor the one before.
TEST_F(Staging, KeepsTheOtherValuesWhenOneIsRefused) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.stage(2, 0, 0, amplitude, -1), Status::out_of_range);
  ASSERT_EQ(kernel.commit(1, 0), Status::ok);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(20));
}

// A module is set up, receives the first changes, and then starts from state 0.
TEST_F(Staging, SurvivesAResetAndNotANewConfiguration) {
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(20)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 5), Status::ok);
  kernel.reset();
  test::run(kernel, 6);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(20));
  ASSERT_EQ(kernel.stage(2, 0, 0, amplitude, test::degrees(30)), Status::ok);
  ASSERT_EQ(kernel.commit(2, 20), Status::ok);
  ASSERT_EQ(kernel.configure(reference.configuration(), 0), Status::ok);
  EXPECT_EQ(kernel.commit(2, 20), Status::nothing_staged);
  test::run(kernel, 30);
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(40));
}

}  // namespace
}  // namespace proleg
