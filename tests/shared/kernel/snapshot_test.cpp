#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernel_snapshot.hpp"
#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

std::vector<std::uint8_t> saved(const Kernel& kernel) { return KernelSnapshot::save(kernel); }

class Snapshot : public testing::Test {
 protected:
  static constexpr unsigned joints = 5;

  static KernelConfiguration two_slots() {
    KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), joints, 10'000, 77);
    configuration.slots[2] = {&test::algorithm(test::extended), JointMask(0b01101)};
    return configuration;
  }

  void SetUp() override {
    ASSERT_EQ(kernel.configure(two_slots(), 0), Status::ok);
    test::set_all(kernel, 0, "amplitude", test::degrees(31.25));
    test::set_all(kernel, 2, "frequency", test::hertz(2.5));
    ASSERT_EQ(kernel.set_limits(3, test::degrees(-15), test::degrees(12)), Status::ok);
    kernel.reset();
    test::run(kernel, 123);
    kernel.set_contacts(4, 2);
  }

  void expect_same_future(Kernel& other, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      for (unsigned joint = 0; joint < joints; ++joint) {
        ASSERT_EQ(other.setpoint(joint), kernel.setpoint(joint)) << "tick " << tick << " joint " << joint;
        ASSERT_EQ(other.previous_setpoint(joint), kernel.previous_setpoint(joint)) << "tick " << tick;
        for (unsigned channel = 0; channel < kernel.channel_count(joint); ++channel) {
          ASSERT_EQ(other.frame(joint, channel), kernel.frame(joint, channel)) << "tick " << tick;
        }
      }
      other.advance();
      kernel.advance();
    }
    EXPECT_EQ(saved(other), saved(kernel));
  }

  KernelOf<joints> kernel;
};

TEST_F(Snapshot, ContinuesBitForBitInAFreshKernel) {
  KernelOf<joints> fresh;
  ASSERT_EQ(fresh.configure(two_slots(), 0), Status::ok);
  ASSERT_TRUE(KernelSnapshot::restore(fresh, saved(kernel)));
  EXPECT_EQ(fresh.tick(), 123U);
  expect_same_future(fresh, 300);
}

TEST_F(Snapshot, ReturnsAKernelToAnEarlierState) {
  const std::vector<std::uint8_t> before = saved(kernel);
  std::vector<std::int32_t> first;
  std::vector<std::int32_t> second;
  for (std::vector<std::int32_t>* angles : {&first, &second}) {
    ASSERT_TRUE(KernelSnapshot::restore(kernel, before));
    for (unsigned tick = 0; tick < 101; ++tick) {
      kernel.advance();
      angles->push_back(kernel.setpoint(tick % joints));
    }
  }
  EXPECT_EQ(first, second);
}

TEST_F(Snapshot, KeepsStagedValuesAndTheCommitThatWaits) {
  const unsigned amplitude = test::parameter_index(kernel, 0, "amplitude");
  ASSERT_EQ(kernel.stage(5, 0, 1, amplitude, test::degrees(3)), Status::ok);
  KernelOf<joints> staged;
  ASSERT_EQ(staged.configure(two_slots(), 0), Status::ok);
  ASSERT_TRUE(KernelSnapshot::restore(staged, saved(kernel)));
  ASSERT_EQ(kernel.commit(5, 150), Status::ok);
  ASSERT_EQ(staged.commit(5, 150), Status::ok);
  KernelOf<joints> committed;
  ASSERT_EQ(committed.configure(two_slots(), 0), Status::ok);
  ASSERT_TRUE(KernelSnapshot::restore(committed, saved(kernel)));
  expect_same_future(staged, 50);
  test::run(committed, 50);
  EXPECT_EQ(saved(committed), saved(kernel));
  EXPECT_EQ(committed.parameter(0, 1, amplitude), test::degrees(3));
}

TEST_F(Snapshot, OfAModuleKeepsTheReceivedFrames) {
  test::ModuleChain chain(two_slots());
  for (int tick = 0; tick < 50; ++tick) {
    chain.tick();
  }
  chain.exchange();
  KernelOf<1> restarted;
  ASSERT_EQ(restarted.configure(two_slots(), 2), Status::ok);
  ASSERT_TRUE(KernelSnapshot::restore(restarted, saved(chain[2])));
  chain[2].advance();
  restarted.advance();
  EXPECT_EQ(saved(restarted), saved(chain[2]));
  EXPECT_EQ(restarted.missed_frames(), 0U);
}

TEST_F(Snapshot, HasTheSameBytesForTheSameHistory) {
  const std::vector<std::uint8_t> first = saved(kernel);
  KernelOf<joints> other;
  ASSERT_EQ(other.configure(two_slots(), 0), Status::ok);
  test::set_all(other, 0, "amplitude", test::degrees(31.25));
  test::set_all(other, 2, "frequency", test::hertz(2.5));
  ASSERT_EQ(other.set_limits(3, test::degrees(-15), test::degrees(12)), Status::ok);
  other.reset();
  test::run(other, 123);
  EXPECT_NE(saved(other), first) << "the contacts differ";
  other.set_contacts(4, 2);
  EXPECT_EQ(saved(other), first);
}

// A value that was staged and took effect, and the same value set at once, are one state.
TEST_F(Snapshot, HasTheSameBytesForAParameterSetAtOnceOrCommitted) {
  KernelOf<joints> other;
  ASSERT_EQ(other.configure(two_slots(), 0), Status::ok);
  ASSERT_TRUE(KernelSnapshot::restore(other, saved(kernel)));
  test::set(other, 0, 1, "amplitude", test::degrees(3));
  const unsigned amplitude = test::parameter_index(kernel, 0, "amplitude");
  ASSERT_EQ(kernel.stage(4, 0, 2, amplitude, test::degrees(8)), Status::ok);
  ASSERT_EQ(kernel.stage(5, 0, 1, amplitude, test::degrees(3)), Status::ok);
  ASSERT_EQ(kernel.commit(5, 123), Status::ok);
  kernel.advance();
  other.advance();
  EXPECT_EQ(saved(other), saved(kernel));
}

TEST_F(Snapshot, IsRejectedInAnyOtherSize) {
  const std::vector<std::uint8_t> before = saved(kernel);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, before.size() - 1, before.size() + 1}) {
    std::vector<std::uint8_t> wrong = before;
    wrong.resize(size);
    EXPECT_FALSE(KernelSnapshot::restore(kernel, wrong)) << size;
  }
  EXPECT_EQ(saved(kernel), before);
}

TEST_F(Snapshot, IsRejectedByAKernelWithAnotherConfiguration) {
  const std::vector<std::uint8_t> snapshot = saved(kernel);
  const auto expect_rejected = [&](const KernelConfiguration& configuration) {
    KernelOf<joints> other;
    EXPECT_EQ(other.configure(configuration, 0), Status::ok);
    test::run(other, 3);
    const std::vector<std::uint8_t> before = saved(other);
    EXPECT_FALSE(KernelSnapshot::restore(other, snapshot));
    EXPECT_EQ(saved(other), before);
  };
  KernelConfiguration other = two_slots();
  other.tick_period_us = 20'000;
  expect_rejected(other);
  other = two_slots();
  other.joint_count = 6;
  expect_rejected(other);
  other = two_slots();
  std::swap(other.slots[0], other.slots[2]);
  expect_rejected(other);
  other = two_slots();
  other.slots[2].group = JointMask(0b10101);
  expect_rejected(other);
  other = two_slots();
  other.slots[2].algorithm = &test::algorithm(test::sinusoidal);
  expect_rejected(other);
}

TEST_F(Snapshot, OfOneModuleIsRejectedByAnother) {
  test::ModuleChain chain(test::one_slot(test::algorithm(test::coupled), joints));
  EXPECT_FALSE(KernelSnapshot::restore(chain[1], saved(chain[2])));
}

TEST_F(Snapshot, IsRejectedWithAParameterOutOfRange) {
  std::vector<std::uint8_t> snapshot = saved(kernel);
  const auto amplitude = static_cast<std::uint32_t>(test::degrees(31.25));
  const std::array<std::uint8_t, 4> bytes = {
      static_cast<std::uint8_t>(amplitude), static_cast<std::uint8_t>(amplitude >> 8U),
      static_cast<std::uint8_t>(amplitude >> 16U), static_cast<std::uint8_t>(amplitude >> 24U)};
  const auto found = std::search(snapshot.begin(), snapshot.end(), bytes.begin(), bytes.end());
  ASSERT_NE(found, snapshot.end());
  found[3] = 0x80;  // negative now
  const std::vector<std::uint8_t> before = saved(kernel);
  EXPECT_FALSE(KernelSnapshot::restore(kernel, snapshot));
  EXPECT_EQ(saved(kernel), before);
}

// Any bytes are rejected, and the kernel stays as it was, or accepted, and the kernel continues.
TEST_F(Snapshot, WithAnyCorruptedByteIsRejectedOrLeavesAKernelThatRuns) {
  const std::vector<std::uint8_t> good = saved(kernel);
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const std::uint8_t flip : {std::uint8_t{0x01}, std::uint8_t{0x80}, std::uint8_t{0xFF}}) {
      std::vector<std::uint8_t> bad = good;
      bad[i] = static_cast<std::uint8_t>(bad[i] ^ flip);
      ASSERT_TRUE(KernelSnapshot::restore(kernel, good));
      if (!KernelSnapshot::restore(kernel, bad)) {
        ASSERT_EQ(saved(kernel), good) << "byte " << i;
        continue;
      }
      test::run(kernel, 2);
      ASSERT_TRUE(KernelSnapshot::restore(kernel, saved(kernel))) << "byte " << i;
    }
  }
}

TEST_F(Snapshot, StartsWithItsFormatInTheDocumentedByteOrder) {
  const std::vector<std::uint8_t> bytes = saved(kernel);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "PSK2");
  const std::vector<std::uint8_t> configuration(bytes.begin() + 4, bytes.begin() + 11);
  EXPECT_EQ(configuration, (std::vector<std::uint8_t>{joints, 0x10, 0x27, 0, 0, 0, joints}))
      << "joint count, tick in microseconds, first and number of local joints";
}

}  // namespace
}  // namespace proleg
