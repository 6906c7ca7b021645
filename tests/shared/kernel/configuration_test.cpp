#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string_view>

#include "robot.hpp"
#include "shared/fixed/random.hpp"

namespace proleg {
namespace {

KernelConfiguration valid() { return test::one_slot(test::algorithm(test::sinusoidal), 5); }

TEST(Configuration, NeedsOneTo64Joints) {
  KernelOf<1> kernel;
  KernelConfiguration configuration;
  configuration.joint_count = 0;
  EXPECT_EQ(kernel.configure(configuration, 0), Status::bad_joint_count);
  configuration.joint_count = 65;
  EXPECT_EQ(kernel.configure(configuration, 0), Status::bad_joint_count);
  configuration.joint_count = 64;
  EXPECT_EQ(kernel.configure(configuration, 63), Status::ok);
  configuration.joint_count = 1;
  EXPECT_EQ(kernel.configure(configuration, 0), Status::ok);
}

TEST(Configuration, NeedsLocalJointsThatAreJointsOfTheRobot) {
  KernelOf<2> kernel;
  EXPECT_EQ(kernel.configure(valid(), 3), Status::ok);
  EXPECT_EQ(kernel.configure(valid(), 4), Status::bad_local_joints);
  EXPECT_EQ(kernel.configure(valid(), std::numeric_limits<unsigned>::max()), Status::bad_local_joints);
  EXPECT_EQ(kernel.configure(valid(), std::numeric_limits<unsigned>::max() - 1), Status::bad_local_joints);
  KernelOf<6> too_large;
  EXPECT_EQ(too_large.configure(valid(), 0), Status::bad_local_joints);
  Kernel without_memory{std::span<JointMemory>{}};
  EXPECT_EQ(without_memory.configure(valid(), 0), Status::bad_local_joints);
}

TEST(Configuration, NeedsATickOfOneTo100Milliseconds) {
  KernelOf<5> kernel;
  for (const std::uint32_t tick_us : {1'000U, 31'000U, 100'000U}) {
    KernelConfiguration configuration = valid();
    configuration.tick_period_us = tick_us;
    EXPECT_EQ(kernel.configure(configuration, 0), Status::ok) << tick_us;
  }
  for (const std::uint32_t tick_us : {0U, 999U, 100'001U, 0xFFFFFFFFU}) {
    KernelConfiguration configuration = valid();
    configuration.tick_period_us = tick_us;
    EXPECT_EQ(kernel.configure(configuration, 0), Status::bad_tick_period) << tick_us;
  }
}

TEST(Configuration, RefusesAGroupWithJointsThatTheRobotDoesNotHave) {
  KernelOf<5> kernel;
  KernelConfiguration configuration = valid();
  configuration.slots[2] = {&test::algorithm(test::direct), JointMask(0b100000)};
  EXPECT_EQ(kernel.configure(configuration, 0), Status::bad_group);
}

TEST(Configuration, RefusesAThirdBroadcastOnAJoint) {
  KernelOf<5> kernel;
  KernelConfiguration configuration = valid();
  configuration.slots[1] = {&test::algorithm(test::coupled), JointMask(0b00110)};
  configuration.slots[2] = {&test::algorithm(test::direct), JointMask(0b11111)};
  EXPECT_EQ(kernel.configure(configuration, 0), Status::ok) << "direct angles broadcast nothing";
  configuration.slots[3] = {&test::algorithm(test::coupled), JointMask(0b11000)};
  EXPECT_EQ(kernel.configure(configuration, 0), Status::ok) << "no joint has three";
  configuration.slots[3].group = JointMask(0b10100);
  EXPECT_EQ(kernel.configure(configuration, 0), Status::too_many_broadcasts);
}

TEST(Configuration, RefusedLeavesTheKernelAsItWas) {
  KernelOf<5> kernel;
  KernelOf<5> reference;
  ASSERT_EQ(kernel.configure(valid(), 0), Status::ok);
  ASSERT_EQ(reference.configure(valid(), 0), Status::ok);
  test::run(kernel, 7);
  test::run(reference, 7);
  KernelConfiguration bad = valid();
  bad.slots[1] = {&test::algorithm(test::coupled), JointMask(0b11111)};
  bad.slots[2] = {&test::algorithm(test::coupled), JointMask(0b11111)};
  ASSERT_EQ(kernel.configure(bad, 0), Status::too_many_broadcasts);
  EXPECT_EQ(kernel.tick(), 7U);
  for (int tick = 0; tick < 20; ++tick) {
    kernel.advance();
    reference.advance();
    ASSERT_EQ(kernel.setpoint(3), reference.setpoint(3));
    ASSERT_EQ(kernel.frame(3, 0), reference.frame(3, 0));
  }
}

TEST(Configuration, SetsParametersAndLimitsToTheirDefaultsAgain) {
  KernelOf<5> kernel;
  ASSERT_EQ(kernel.configure(valid(), 0), Status::ok);
  test::set_all(kernel, 0, "amplitude", test::degrees(3));
  ASSERT_EQ(kernel.set_limits(0, 0, 0), Status::ok);
  test::run(kernel, 3);
  ASSERT_EQ(kernel.configure(valid(), 0), Status::ok);
  EXPECT_EQ(kernel.tick(), 0U);
  const std::span<const Parameter> parameters = kernel.configuration().slots[0].algorithm->declaration().parameters;
  for (unsigned p = 0; p < parameters.size(); ++p) {
    EXPECT_EQ(kernel.parameter(0, 0, p), parameters[p].default_value) << parameters[p].name;
  }
  test::run(kernel, 25);
  EXPECT_NEAR(test::in_degrees(kernel.setpoint(0)), 40, 1e-3);
}

TEST(Channels, AreTheFirstAndTheSecondBroadcastingSlotOfAJoint) {
  KernelConfiguration configuration = valid();
  configuration.slots[0] = {&test::algorithm(test::direct), JointMask(0b11111)};
  configuration.slots[1] = {&test::algorithm(test::sinusoidal), JointMask(0b00011)};
  configuration.slots[3] = {&test::algorithm(test::coupled), JointMask(0b00110)};
  KernelOf<5> kernel;
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  test::run(kernel, 3);
  EXPECT_EQ(kernel.channel_count(0), 1U);
  EXPECT_EQ(kernel.channel_count(1), 2U);
  EXPECT_EQ(kernel.channel_count(2), 1U);
  EXPECT_EQ(kernel.channel_count(4), 1U);
  const Declaration& sine = test::algorithm(test::sinusoidal).declaration();
  const Declaration& oscillator = test::algorithm(test::coupled).declaration();
  EXPECT_EQ(unpack(sine, 0, kernel.frame(0, 0)), test::value(kernel, 1, 0, "current_phase"));
  EXPECT_EQ(unpack(sine, 0, kernel.frame(1, 0)), test::value(kernel, 1, 1, "current_phase"));
  EXPECT_EQ(unpack(oscillator, 0, kernel.frame(1, 1)), test::value(kernel, 3, 1, "current_phase"));
  EXPECT_EQ(unpack(oscillator, 0, kernel.frame(2, 0)), test::value(kernel, 3, 2, "current_phase"));
  for (unsigned channel = 0; channel < 2; ++channel) {
    EXPECT_EQ(kernel.frame(1, channel).label(), 3);
    EXPECT_EQ(kernel.frame(1, channel).flags(), StateFrame::valid);
  }
}

TEST(Channels, OfNeighboursMayDifferWithoutConfusingTheSlots) {
  KernelConfiguration configuration = valid();
  configuration.slots[0] = {&test::algorithm(test::sinusoidal), JointMask(0b00010)};
  configuration.slots[1] = {&test::algorithm(test::coupled), JointMask(0b11111)};
  KernelOf<5> kernel;
  KernelOf<5> alone;
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  configuration.slots[0].group = JointMask();
  ASSERT_EQ(alone.configure(configuration, 0), Status::ok);
  test::run(kernel, 200);
  test::run(alone, 200);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(test::value(kernel, 1, joint, "current_phase"), test::value(alone, 1, joint, "current_phase"))
        << "joint " << joint;
  }
}

KernelConfiguration random_configuration(Pcg32& random, unsigned joints) {
  KernelConfiguration configuration;
  configuration.joint_count = static_cast<std::uint8_t>(joints);
  for (Slot& slot : configuration.slots) {
    if (random.next() % 4 != 0) {
      slot.algorithm = &algorithm_at(random.next() % algorithm_count());
    }
    // Sparse groups, of which three rarely meet.
    slot.group = JointMask((std::uint64_t{random.next()} << 32U | random.next()) &
                           (std::uint64_t{random.next()} << 32U | random.next())) &
                 JointMask::first(joints);
  }
  return configuration;
}

TEST(Channels, ConfigurationAndKernelAgreeWhoSendsTwoFrames) {
  constexpr std::uint32_t seed = 77;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Pcg32 random(seed, 0);
  const auto kernel = std::make_unique<KernelOf<1>>();
  unsigned accepted = 0;
  for (int run = 0; run < 3'000; ++run) {
    const unsigned joints = 1 + random.next() % max_joints;
    const KernelConfiguration configuration = random_configuration(random, joints);
    if (kernel->configure(configuration, 0) != Status::ok) {
      continue;
    }
    ++accepted;
    const JointMask senders = configuration.second_channel_senders();
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ(senders.contains(joint), kernel->channel_count(joint) == 2) << "run " << run << ", joint " << joint;
    }
  }
  EXPECT_GT(accepted, 300U);
}

TEST(Status, HasADifferentPhraseForEveryAnswer) {
  std::set<std::string_view> phrases;
  constexpr auto last = static_cast<unsigned>(Status::commit_in_the_past);
  for (unsigned i = 0; i <= last; ++i) {
    const std::string_view phrase = describe(static_cast<Status>(i));
    EXPECT_FALSE(phrase.empty());
    EXPECT_NE(phrase, "unknown status");
    EXPECT_TRUE(phrases.insert(phrase).second) << phrase;
  }
}

}  // namespace
}  // namespace proleg
