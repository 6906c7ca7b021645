#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

using test::ModuleChain;

/// A robot with random size, slots, groups and tick.
KernelConfiguration random_configuration(std::mt19937& random) {
  constexpr std::uint32_t periods[] = {1'000, 10'000, 31'000, 100'000};
  KernelConfiguration configuration;
  configuration.joint_count = static_cast<std::uint8_t>(1 + random() % 8);
  configuration.tick_period_us = periods[random() % std::size(periods)];
  configuration.seed = random();
  const std::uint64_t all = JointMask::first(configuration.joint_count).bits();
  unsigned broadcasting = 0;
  for (Slot& slot : configuration.slots) {
    const ActuationModule& algorithm = algorithm_at(random() % algorithm_count());
    const bool sends = !algorithm.declaration().frame.empty();
    if (random() % 4 != 0 && (!sends || broadcasting < max_channels)) {
      slot = {&algorithm, JointMask(random() % 3 == 0 ? random() & all : all)};
      broadcasting += sends ? 1 : 0;
    }
  }
  return configuration;
}

std::int32_t random_value(const Parameter& parameter, std::mt19937& random) {
  const auto span = static_cast<std::uint64_t>(std::int64_t{parameter.maximum} - parameter.minimum) + 1;
  return static_cast<std::int32_t>(parameter.minimum + static_cast<std::int64_t>(random() % span));
}

/// Visits a random value for every parameter of every slot and joint.
template <typename Visit>
void for_random_parameters(const KernelConfiguration& configuration, std::mt19937& random, Visit visit) {
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    if (configuration.slots[slot].algorithm == nullptr) {
      continue;
    }
    const std::span<const Parameter> parameters = configuration.slots[slot].algorithm->declaration().parameters;
    for (unsigned joint = 0; joint < configuration.joint_count; ++joint) {
      for (unsigned p = 0; p < parameters.size() && configuration.slots[slot].group.contains(joint); ++p) {
        visit(slot, joint, p, random_value(parameters[p], random));
      }
    }
  }
}

void expect_identical(const Kernel& whole, ModuleChain& chain) {
  for (unsigned joint = 0; joint < chain.size(); ++joint) {
    ASSERT_EQ(chain[joint].setpoint(joint), whole.setpoint(joint)) << "joint " << joint << " tick " << whole.tick();
    for (unsigned channel = 0; channel < whole.channel_count(joint); ++channel) {
      ASSERT_EQ(chain[joint].frame(joint, channel), whole.frame(joint, channel)) << "joint " << joint;
    }
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      if (whole.drives(slot, joint)) {
        const Declaration& about = whole.configuration().slots[slot].algorithm->declaration();
        for (unsigned v = 0; v < about.internal_values.size(); ++v) {
          ASSERT_EQ(chain[joint].internal_value(slot, joint, v), whole.internal_value(slot, joint, v))
              << about.internal_values[v].name << " of joint " << joint << " at tick " << whole.tick();
        }
      }
    }
  }
}

// There are commits, contacts and distortions on the way; frames and modules have another order in every tick.
TEST(FrameExchange, MakesModulesEqualOneKernelForAllJointsToTheLastBit) {
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const KernelConfiguration configuration = random_configuration(random);
    std::vector<JointMemory> memory(configuration.joint_count);
    Kernel whole(memory);
    ASSERT_EQ(whole.configure(configuration, 0), Status::ok);
    ModuleChain chain(configuration);
    for_random_parameters(configuration, random, [&](unsigned slot, unsigned joint, unsigned p, std::int32_t value) {
      ASSERT_EQ(whole.set_parameter(slot, joint, p, value), Status::ok);
      ASSERT_EQ(chain[joint].set_parameter(slot, joint, p, value), Status::ok);
    });
    whole.reset();
    chain.reset();
    for (int tick = 0; tick < 150; ++tick) {
      if (tick == 50) {
        for_random_parameters(configuration, random,
                              [&](unsigned slot, unsigned joint, unsigned p, std::int32_t value) {
                                ASSERT_EQ(whole.stage(9, slot, joint, p, value), Status::ok);
                                ASSERT_EQ(chain[joint].stage(9, slot, joint, p, value), Status::ok);
                              });
        static_cast<void>(whole.commit(9, 70));  // a robot without parameters has nothing to commit
        for (unsigned joint = 0; joint < chain.size(); ++joint) {
          static_cast<void>(chain[joint].commit(9, 70));
        }
      }
      const auto joint = static_cast<unsigned>(random() % chain.size());
      if (whole.drives(0, joint) && !configuration.slots[0].algorithm->declaration().internal_values.empty() &&
          random() % 20 == 0) {
        const auto distorted = static_cast<std::int32_t>(random());
        ASSERT_EQ(test::distort(whole, 0, joint, 0, distorted), Status::ok);
        ASSERT_EQ(test::distort(chain[joint], 0, joint, 0, distorted), Status::ok);
      }
      const auto contacts = static_cast<std::uint8_t>(random() % 16);
      whole.set_contacts(joint, contacts);
      chain[joint].set_contacts(joint, contacts);
      chain.shuffle(random);
      chain.exchange();
      whole.advance();
      chain.advance();
      expect_identical(whole, chain);
      if (HasFatalFailure()) {
        return;
      }
    }
    for (unsigned joint = 0; joint < chain.size(); ++joint) {
      EXPECT_EQ(chain[joint].missed_frames(), 0U);
    }
  }
}

class Receive : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(sender.configure(test::one_slot(test::algorithm(test::coupled), 5), 2), Status::ok);
    ASSERT_EQ(receiver.configure(test::one_slot(test::algorithm(test::coupled), 5), 1), Status::ok);
  }

  KernelOf<1> sender;
  KernelOf<1> receiver;
};

TEST_F(Receive, TakesAFrameLabelledWithTheComingTick) {
  EXPECT_TRUE(receiver.receive(2, 0, sender.frame(2, 0)));
  sender.advance();
  receiver.advance();
  EXPECT_TRUE(receiver.receive(2, 0, sender.frame(2, 0)));
}

TEST_F(Receive, RefusesAFrameThatComesATickLate) {
  const StateFrame late = sender.frame(2, 0);
  sender.advance();
  receiver.advance();
  EXPECT_FALSE(receiver.receive(2, 0, late));
}

TEST_F(Receive, RefusesAFrameThatComesATickEarly) {
  sender.advance();
  EXPECT_FALSE(receiver.receive(2, 0, sender.frame(2, 0)));
}

TEST_F(Receive, ComparesTheTickModulo256) {
  test::run(sender, 256);
  EXPECT_EQ(sender.frame(2, 0).label(), 0);
  EXPECT_TRUE(receiver.receive(2, 0, sender.frame(2, 0))) << "a tick is 8 bits on the wire";
}

TEST_F(Receive, RefusesAFrameThatHoldsNoState) {
  StateFrame frame = sender.frame(2, 0);
  frame.bytes[6] = 0;
  EXPECT_FALSE(receiver.receive(2, 0, frame));
}

TEST_F(Receive, RefusesItsOwnJointAndJointsAndChannelsThatDoNotExist) {
  const StateFrame frame = sender.frame(2, 0);
  EXPECT_FALSE(receiver.receive(1, 0, frame));
  EXPECT_FALSE(receiver.receive(5, 0, frame));
  EXPECT_FALSE(receiver.receive(64, 0, frame));
  EXPECT_FALSE(receiver.receive(2, max_channels, frame));
}

TEST_F(Receive, CountsTheFramesThatWereMissing) {
  EXPECT_TRUE(receiver.receive(2, 0, sender.frame(2, 0)));
  receiver.advance();
  EXPECT_EQ(receiver.missed_frames(), 1U) << "joint 0; nothing depends on joints 3 and 4";
  receiver.advance();
  EXPECT_EQ(receiver.missed_frames(), 3U) << "joints 0 and 2";
  receiver.reset();
  EXPECT_EQ(receiver.missed_frames(), 0U);
}

// A frame a tick late must change what the coupled gait does.
TEST(LateFrames, ChangeTheCoupledGait) {
  const KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), 5);
  ModuleChain late(configuration);
  ModuleChain punctual(configuration);
  bool differs = false;
  StateFrame delayed;
  for (int tick = 0; tick < 60; ++tick) {
    late.exchange([&](unsigned sender, unsigned receiver) { return tick == 10 && sender == 1 && receiver == 2; });
    if (tick == 10) {
      delayed = late[1].frame(1, 0);
    }
    if (tick == 11) {
      EXPECT_FALSE(late[2].receive(1, 0, delayed));
    }
    late.advance();
    punctual.tick();
    for (unsigned joint = 0; joint < 5; ++joint) {
      differs = differs || late[joint].setpoint(joint) != punctual[joint].setpoint(joint);
    }
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace proleg
