// A module that restarts in mid-gait takes its place again.

#include <gtest/gtest.h>

#include <cstdlib>

#include "module_chain.hpp"

namespace proleg {
namespace {

/// Runs a chain and a second one in which a module restarts at `lost` and joins at `joined`.
class Join : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr unsigned joints = 5;
  static constexpr std::uint32_t lost = 300;
  static constexpr std::uint32_t joined = 340;

  void restart(const KernelConfiguration& configuration) {
    chain.emplace(configuration);
    undisturbed.emplace(configuration);
    for (std::uint32_t tick = 0; tick < lost; ++tick) {
      chain->tick();
      undisturbed->tick();
    }
    for (std::uint32_t tick = lost; tick < joined; ++tick) {
      exchange_without_restarted();
      for (unsigned joint = 0; joint < joints; ++joint) {
        if (joint != restarted()) {
          (*chain)[joint].advance();
        }
      }
      undisturbed->tick();
    }
    Kernel& module = (*chain)[restarted()];
    ASSERT_EQ(module.configure(configuration, restarted()), Status::ok);
    module.join(joined);
  }

  void exchange_without_restarted() {
    for (unsigned receiver = 0; receiver < joints; ++receiver) {
      for (unsigned sender = 0; sender < joints; ++sender) {
        if (sender != receiver && sender != restarted() &&
            (receiver != restarted() || (*chain)[receiver].tick() == (*chain)[sender].tick())) {
          ASSERT_TRUE((*chain)[receiver].receive(sender, 0, (*chain)[sender].frame(sender, 0)));
        }
      }
    }
  }

  /// Runs the first tick of the joined module, in which it knows its neighbours and they do not know it yet.
  void first_tick() {
    exchange_without_restarted();
    chain->advance();
    undisturbed->tick();
  }

  static unsigned restarted() { return GetParam(); }

  std::optional<test::ModuleChain> chain;
  std::optional<test::ModuleChain> undisturbed;
};

TEST_P(Join, PutsThePlainSineBackExactlyAtOnce) {
  restart(test::one_slot(test::algorithm(test::sinusoidal), joints));
  first_tick();
  for (int tick = 0; tick < 200; ++tick) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      ASSERT_EQ((*chain)[joint].setpoint(joint), (*undisturbed)[joint].setpoint(joint)) << joint;
      ASSERT_EQ((*chain)[joint].previous_setpoint(joint), (*undisturbed)[joint].previous_setpoint(joint)) << joint;
    }
    chain->tick();
    undisturbed->tick();
  }
}

TEST_P(Join, BringsTheExtendedSineWithinAStepOfThePhase) {
  restart(test::one_slot(test::algorithm(test::extended), joints));
  first_tick();
  for (int tick = 0; tick < 200; ++tick) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      const std::int64_t difference =
          std::int64_t{(*chain)[joint].setpoint(joint)} - (*undisturbed)[joint].setpoint(joint);
      ASSERT_LE(std::llabs(difference), 64) << joint;  // 5 millionths of a degree
    }
    chain->tick();
    undisturbed->tick();
  }
}

// The module starts beside its neighbours, so that no joint is pulled far away.
TEST_P(Join, LeavesCoupledOscillatorsWithinADegreeOfPhase) {
  restart(test::one_slot(test::algorithm(test::coupled), joints));
  first_tick();
  const unsigned phase = 0;
  for (int tick = 0; tick < 400; ++tick) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      const auto difference =
          static_cast<std::int32_t>(static_cast<std::uint32_t>((*chain)[joint].internal_value(0, joint, phase)) -
                                    static_cast<std::uint32_t>((*undisturbed)[joint].internal_value(0, joint, phase)));
      ASSERT_LT(std::abs(difference * (180.0 / 2147483648.0)), 1.0) << "joint " << joint << " tick " << tick;
    }
    chain->tick();
    undisturbed->tick();
  }
}

TEST_P(Join, IsFlaggedInTheFirstFrameOnly) {
  restart(test::one_slot(test::algorithm(test::coupled), joints));
  first_tick();
  EXPECT_NE((*chain)[restarted()].frame(restarted(), 0).flags() & StateFrame::holdover, 0);
  chain->tick();
  EXPECT_EQ((*chain)[restarted()].frame(restarted(), 0).flags() & StateFrame::holdover, 0);
}

INSTANTIATE_TEST_SUITE_P(EveryPlace, Join, testing::Values(0U, 2U, 4U));

// Commits for ticks that passed meanwhile give the parameters that all other modules have, in the order of ticks.
TEST(JoinAfterCommits, CatchesUpWithTheParameters) {
  KernelOf<1> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::coupled), 1), 0), Status::ok);
  const unsigned amplitude = test::parameter_index(kernel, 0, "amplitude");
  const unsigned offset = test::parameter_index(kernel, 0, "offset");
  ASSERT_EQ(kernel.stage(2, 0, 0, amplitude, test::degrees(22)), Status::ok);
  ASSERT_EQ(kernel.commit(2, 90), Status::ok);
  ASSERT_EQ(kernel.stage(1, 0, 0, amplitude, test::degrees(11)), Status::ok);
  ASSERT_EQ(kernel.stage_internal(1, 0, 0, 0, test::phase(170)), Status::ok);
  ASSERT_EQ(kernel.commit(1, 80), Status::ok);
  ASSERT_EQ(kernel.stage(3, 0, 0, offset, test::degrees(3)), Status::ok);
  ASSERT_EQ(kernel.commit(3, 105), Status::ok);
  kernel.join(100);
  EXPECT_EQ(kernel.tick(), 100U);
  kernel.advance();
  EXPECT_EQ(kernel.parameter(0, 0, amplitude), test::degrees(22));
  EXPECT_EQ(test::value(kernel, 0, 0, "current_amplitude"), test::degrees(22)) << "from where the neighbours are";
  EXPECT_EQ(kernel.parameter(0, 0, offset), 0);
  test::run(kernel, 5);
  EXPECT_EQ(kernel.parameter(0, 0, offset), test::degrees(3));
}

TEST(FrameFlags, HoldFaultAndHoldoverUntilTheyAreCleared) {
  KernelOf<1> kernel;
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::sinusoidal), 1), 0), Status::ok);
  kernel.set_flags(0xFF);
  kernel.advance();
  EXPECT_EQ(kernel.frame(0, 0).flags(), StateFrame::valid | StateFrame::fault | StateFrame::holdover);
  kernel.set_flags(0);
  kernel.advance();
  EXPECT_EQ(kernel.frame(0, 0).flags(), StateFrame::valid);
}

}  // namespace
}  // namespace proleg
