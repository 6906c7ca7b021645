// The effect of losses and distortions on gaits.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::ModuleChain;
using test::robot_joints;

KernelConfiguration configuration_of(std::string_view algorithm) {
  return test::one_slot(test::algorithm(algorithm), robot_joints);
}

double lag_error(ModuleChain& chain) {
  double largest = 0;
  for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
    const std::uint32_t error =
        static_cast<std::uint32_t>(test::value(chain[joint + 1], 0, joint + 1, "current_phase")) -
        static_cast<std::uint32_t>(test::value(chain[joint], 0, joint, "current_phase")) -
        static_cast<std::uint32_t>(test::phase(55));
    largest = std::max(largest, std::abs(in_degrees(static_cast<std::int32_t>(error))));
  }
  return largest;
}

// A distortion, thesis listing A.2, setDistortion.
TEST(Distortion, OfAPhaseIsOvercomeByTheCoupledGait) {
  ModuleChain chain(configuration_of(test::coupled));
  for (int tick = 0; tick < 1000; ++tick) {
    chain.tick();
  }
  const unsigned phase = test::value_index(chain[2], 0, "current_phase");
  const std::int32_t before = chain[2].internal_value(0, 2, phase);
  ASSERT_EQ(test::distort(chain[2], 0, 2, phase, before + test::degrees(60)), Status::ok);
  chain.tick();
  EXPECT_GT(lag_error(chain), 30);
  for (int tick = 0; tick < 500; ++tick) {
    chain.tick();
  }
  EXPECT_LE(lag_error(chain), 0.02);
}

TEST(Distortion, ReachesTheNeighboursOneTickLater) {
  ModuleChain chain(configuration_of(test::coupled));
  ModuleChain undisturbed(configuration_of(test::coupled));
  const unsigned phase = test::value_index(chain[2], 0, "current_phase");
  ASSERT_EQ(test::distort(chain[2], 0, 2, phase, test::phase(123)), Status::ok);
  const auto same = [&](unsigned joint) {
    return chain[joint].internal_value(0, joint, phase) == undisturbed[joint].internal_value(0, joint, phase);
  };
  chain.tick();
  undisturbed.tick();
  EXPECT_FALSE(same(2));
  EXPECT_TRUE(same(1));
  EXPECT_TRUE(same(3));
  chain.tick();
  undisturbed.tick();
  EXPECT_FALSE(same(1));
  EXPECT_FALSE(same(3));
  EXPECT_TRUE(same(0));
  EXPECT_TRUE(same(4));
}

TEST(Distortion, OfThePlainSineIsGoneAfterATick) {
  KernelOf<1> kernel;
  KernelOf<1> undisturbed;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), 1), 0), Status::ok);
  ASSERT_EQ(undisturbed.configure(kernel.configuration(), 0), Status::ok);
  ASSERT_EQ(test::distort(kernel, 0, 0, test::value_index(kernel, 0, "current_phase"), test::phase(90)), Status::ok);
  test::run(kernel, 2);
  test::run(undisturbed, 2);
  EXPECT_EQ(kernel.setpoint(0), undisturbed.setpoint(0));
  EXPECT_EQ(test::value(kernel, 0, 0, "measured_frequency"), test::value(undisturbed, 0, 0, "measured_frequency"));
}

TEST(Distortion, IsRefusedForWhatDoesNotExist) {
  KernelOf<5> kernel;
  ASSERT_EQ(kernel.configure(configuration_of(test::coupled), 0), Status::ok);
  EXPECT_EQ(test::distort(kernel, 1, 0, 0, 1), Status::unknown_slot);
  EXPECT_EQ(test::distort(kernel, max_slots, 0, 0, 1), Status::unknown_slot);
  EXPECT_EQ(test::distort(kernel, 0, 5, 0, 1), Status::unknown_joint);
  EXPECT_EQ(test::distort(kernel, 0, 0, 7, 1), Status::unknown_internal_value);
}

// protocol.md: the receiver extrapolates the phase by its own increment and holds the rest.
TEST(LostFrame, IsReplacedByTheLastOneWithThePhaseAdvancedByTheOwnIncrement) {
  ModuleChain losing(configuration_of(test::coupled));
  ModuleChain supplied(configuration_of(test::coupled));
  for (int tick = 0; tick < 20; ++tick) {
    losing.tick();
    supplied.tick();
  }
  // There is one tick in which both joints receive all frames. The frame of joint 1 is kept as joint 2 received it.
  const StateFrame last = losing[1].frame(1, 0);
  losing.tick();
  supplied.tick();
  const auto to_joint_2 = [](unsigned sender, unsigned receiver) { return sender == 1 && receiver == 2; };
  losing.exchange(to_joint_2);
  supplied.exchange(to_joint_2);
  StateFrame expected = last;
  const Declaration& declaration = test::algorithm(test::coupled).declaration();
  const auto advanced =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(unpack(declaration, 0, last)) + 42'949'673U);
  repack(declaration, 0, advanced, expected);
  expected.bytes[7] = static_cast<std::uint8_t>(supplied[2].tick());
  ASSERT_NE(expected, supplied[1].frame(1, 0)) << "while the chain settles, the true frame is another one";
  ASSERT_TRUE(supplied[2].receive(1, 0, expected));
  losing.advance();
  supplied.advance();
  for (unsigned value = 0; value < declaration.internal_values.size(); ++value) {
    EXPECT_EQ(losing[2].internal_value(0, 2, value), supplied[2].internal_value(0, 2, value));
  }
  EXPECT_EQ(losing[2].missed_frames(), 1U);
  EXPECT_EQ(supplied[2].missed_frames(), 0U);
}

TEST(LostFrame, ChangesTheCoupledGaitWhileItSettles) {
  ModuleChain losing(configuration_of(test::coupled));
  ModuleChain complete(configuration_of(test::coupled));
  bool differs = false;
  for (int tick = 0; tick < 100; ++tick) {
    losing.exchange([&](unsigned sender, unsigned receiver) { return tick == 20 && sender == 1 && receiver == 2; });
    losing.advance();
    complete.tick();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      differs = differs || losing[joint].setpoint(joint) != complete[joint].setpoint(joint);
    }
  }
  EXPECT_TRUE(differs);
}

// A harmonic's phase runs at a multiple of the frequency, and so it is extrapolated.
TEST(LostFrame, IsExtrapolatedExactlyForAHarmonic) {
  ModuleChain chain(configuration_of(test::extended));
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    test::set(chain[joint], 0, joint, "harmonic", 3);
  }
  chain.reset();
  for (int tick = 0; tick < 400; ++tick) {
    chain.tick();
  }
  for (int tick = 0; tick < 10; ++tick) {
    chain.exchange([](unsigned, unsigned) { return true; });
    chain.advance();
    EXPECT_EQ(test::value(chain[0], 0, 0, "measured_phase_difference"), test::phase(55)) << "tick " << tick;
  }
}

TEST(Losses, LeaveTheCoupledGaitAtItsFrequencyAndWithin1DegreeOfItsLagOnceTheyEnd) {
  ModuleChain chain(configuration_of(test::coupled));
  std::mt19937 random(20);
  for (int tick = 0; tick < 1000; ++tick) {
    chain.exchange([&](unsigned, unsigned) { return random() % 10 < 3; });
    chain.advance();
  }
  EXPECT_GT(chain[2].missed_frames(), 100U);
  for (int tick = 0; tick < 300; ++tick) {
    chain.tick();
  }
  EXPECT_LE(lag_error(chain), 1.0);
  EXPECT_NEAR(test::value(chain[2], 0, 2, "measured_frequency") / 16777216.0, 1.0, 1e-3);
}

// The remedy of the reference sheet: extrapolation restores 1.0000 Hz and 55.0 degrees exactly.
TEST(Losses, OfEverythingLeaveASettledGaitAlone) {
  ModuleChain chain(configuration_of(test::coupled));
  for (int tick = 0; tick < 2000; ++tick) {
    chain.tick();
  }
  for (int tick = 0; tick < 500; ++tick) {
    chain.exchange([](unsigned, unsigned) { return true; });
    chain.advance();
  }
  EXPECT_LE(lag_error(chain), 0.02);
  EXPECT_NEAR(test::value(chain[0], 0, 0, "measured_frequency") / 16777216.0, 1.0, 1e-5);
}

TEST(Losses, FromTheStartLeaveEveryOscillatorToItself) {
  ModuleChain chain(configuration_of(test::coupled));
  const std::int32_t start = test::value(chain[2], 0, 2, "current_phase");
  for (int tick = 0; tick < 100; ++tick) {
    chain.exchange([](unsigned, unsigned) { return true; });
    chain.advance();
  }
  EXPECT_EQ(static_cast<std::uint32_t>(test::value(chain[2], 0, 2, "current_phase")),
            static_cast<std::uint32_t>(start) + 100U * 42'949'673U);
}

}  // namespace
}  // namespace proleg
