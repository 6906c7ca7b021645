#include "sim/loop/gait.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "shared/computer/hash/sha256.hpp"
#include "shipped.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

KernelChain make_chain(const Scenario& scenario) { return {scenario.kernel, scenario.joint_limits, scenario.settings}; }

const std::vector<std::uint8_t> no_joint_contacts(5);

double phase_degrees(const KernelChain& chain, unsigned joint) {
  return chain.kernel(joint).internal_value(0, joint, 0) * (180.0 / 2147483648.0);
}

/// The largest distance between the phases of two chains, in degrees.
double max_phase_error(const KernelChain& a, const KernelChain& b) {
  double largest = 0;
  for (unsigned joint = 0; joint < a.joint_count(); ++joint) {
    largest = std::max(largest, std::abs(std::remainder(phase_degrees(a, joint) - phase_degrees(b, joint), 360.0)));
  }
  return largest;
}

TEST(KernelChain, LosesExactlyTheFramesThatTheLossesName) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  KernelChain chain = make_chain(scenario);
  const Losses losses({{3, 0, 0, 1}, {5, 4, 0, 3}, {5, 4, 0, 2}});
  chain.set_losses(&losses);
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    chain.advance(no_joint_contacts);
    const std::size_t expected = tick == 3 ? 1 : (tick == 5 ? 2 : 0);
    EXPECT_EQ(chain.lost().size(), expected) << "tick " << tick;
  }
  EXPECT_EQ(chain.kernel(1).missed_frames(), 1U);
  EXPECT_EQ(chain.kernel(2).missed_frames(), 0U) << "joint 2 does not depend on joint 4";
  EXPECT_EQ(chain.kernel(3).missed_frames(), 1U);
  EXPECT_EQ(chain.kernel(0).missed_frames(), 0U);
}

TEST(KernelChain, LossesDoNotChangeThePlainSine) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  KernelChain chain = make_chain(scenario);
  KernelChain undisturbed = make_chain(scenario);
  const Losses losses(RandomLosses{5, 1U << 30U, 0, 999});
  chain.set_losses(&losses);
  for (int tick = 0; tick < 2000; ++tick) {
    chain.advance(no_joint_contacts);
    undisturbed.advance(no_joint_contacts);
    ASSERT_TRUE(std::ranges::equal(chain.setpoints(), undisturbed.setpoints())) << "tick " << tick;
  }
}

TEST(KernelChain, CountsTheTicksInWhichLimitsCutASetPoint) {
  Scenario scenario = shipped("travelling_wave/uniform");      // 40 degrees, 1 Hz
  scenario.joint_limits[2] = {-(1 << 28), (1 << 30) / 9 * 2};  // -22.5 to 20 degrees
  KernelChain chain = make_chain(scenario);
  for (int tick = 0; tick < 1000; ++tick) {
    chain.advance(no_joint_contacts);
  }
  // A sine of 40 degrees is above 20 for a third of its period, and below -22.5 for acos(0.5625) / pi of it.
  const double expected = 1.0 / 3.0 + std::acos(0.5625) / std::numbers::pi;
  EXPECT_NEAR(chain.clipped_ticks()[2] / 1000.0, expected, 0.02);
  EXPECT_EQ(chain.clipped_ticks()[1], 0U);
}

/// The same between neighbours: what makes the wave.
double max_phase_difference_error(const KernelChain& a, const KernelChain& b) {
  double largest = 0;
  for (unsigned joint = 0; joint + 1 < a.joint_count(); ++joint) {
    const double in_a = phase_degrees(a, joint + 1) - phase_degrees(a, joint);
    const double in_b = phase_degrees(b, joint + 1) - phase_degrees(b, joint);
    largest = std::max(largest, std::abs(std::remainder(in_a - in_b, 360.0)));
  }
  return largest;
}

struct Recovery {
  std::size_t lost = 0;    ///< frames
  double phase = 0;        ///< largest error after them
  double differences = 0;  ///< largest error of a phase difference after them
};

/// Frames are lost for five seconds from tick `first` on; a second after that is left out.
Recovery recovery(std::uint64_t seed, double rate, std::uint32_t first) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  KernelChain chain = make_chain(scenario);
  KernelChain undisturbed = make_chain(scenario);
  const std::uint32_t end = first + 500;
  const Losses losses(RandomLosses{seed, static_cast<std::uint32_t>(rate * 4294967296.0), first, end - 1});
  chain.set_losses(&losses);
  Recovery result;
  for (std::uint32_t tick = 0; tick < end + 500; ++tick) {
    chain.advance(no_joint_contacts);
    undisturbed.advance(no_joint_contacts);
    result.lost += chain.lost().size();
    if (tick >= end + 100) {
      result.phase = std::max(result.phase, max_phase_error(chain, undisturbed));
      result.differences = std::max(result.differences, max_phase_difference_error(chain, undisturbed));
    }
  }
  return result;
}

// A receiver predicts its neighbour's phase correctly as long as the gait is settled.
TEST(KernelChain, CoupledOscillatorsStayWithinADegreeWhenFramesAreLostInMidGait) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Recovery result = recovery(seed, 0.05, 1000);
    EXPECT_GT(result.lost, 400U) << "seed " << seed;
    EXPECT_LT(result.phase, 1.0) << "seed " << seed;
  }
}

// The coupling restores phase differences only. If frames are lost while the phases still converge, the whole wave may
// stay a few degrees ahead or behind.
TEST(KernelChain, PhaseDifferencesReturnToWithinADegreeAfterLosses) {
  for (const double rate : {0.05, 0.25, 0.9}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      EXPECT_LT(recovery(seed, rate, 0).differences, 1.0) << "seed " << seed << " rate " << rate;
    }
  }
}

TEST(KernelChain, TheOthersReceiveOneMoreFrameOfAStoppedJointAndThenMissIt) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  KernelChain chain = make_chain(scenario);
  for (int tick = 0; tick < 10; ++tick) {
    chain.advance(no_joint_contacts);
  }
  const std::int32_t last = chain.setpoints()[2];
  chain.stop(2);
  EXPECT_FALSE(chain.is_running(2));
  chain.advance(no_joint_contacts);
  EXPECT_EQ(chain.kernel(1).missed_frames(), 0U) << "the frame of the tick in which it stops was sent before";
  chain.advance(no_joint_contacts);
  EXPECT_EQ(chain.kernel(1).missed_frames(), 1U);
  EXPECT_EQ(chain.setpoints()[2], last) << "its set-point does not change";
  EXPECT_EQ(chain.lost().size(), 0U) << "this is no loss on the bus";
}

TEST(KernelChain, AJointThatJoinsHasTheParametersOfTheChangesMeanwhile) {
  Scenario scenario = shipped("travelling_wave/uniform");
  apply_setting(scenario, "amplitude=12@15");
  apply_setting(scenario, "amplitude=13@25");
  KernelChain chain = make_chain(scenario);
  KernelChain undisturbed = make_chain(scenario);
  std::size_t next = 0;
  for (std::uint32_t tick = 0; tick < 100; ++tick) {
    if (tick == 10) {
      chain.stop(3);
    }
    if (tick == 20) {
      chain.join(3);
    }
    if (next < scenario.changes.size() && scenario.changes[next].tick == tick) {
      chain.apply(scenario.changes[next]);
      undisturbed.apply(scenario.changes[next++]);
    }
    chain.advance(no_joint_contacts);
    undisturbed.advance(no_joint_contacts);
    if (tick < 10 || tick >= 20) {
      ASSERT_TRUE(std::ranges::equal(chain.setpoints(), undisturbed.setpoints())) << "tick " << tick;
    }
  }
}

/// A change of a scenario for the coming tick, whatever tick that is.
Change change_of(const std::string& word) {
  Scenario scenario = shipped("travelling_wave/uniform");
  apply_setting(scenario, word + "@1");
  return scenario.changes.at(0);
}

TEST(KernelChain, OfTwoChangesForOneTickBothTakeEffectAndTheLaterOneCounts) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  KernelChain chain = make_chain(scenario);
  KernelChain expected = make_chain(scenario);
  chain.advance(no_joint_contacts);
  expected.advance(no_joint_contacts);
  chain.apply(change_of("amplitude=10"));
  chain.apply(change_of("phase_difference=30"));
  chain.apply(change_of("amplitude=20"));
  Change both = change_of("amplitude=20");
  for (const Setting& setting : change_of("phase_difference=30").settings) {
    both.settings.push_back(setting);
  }
  expected.apply(both);
  for (int tick = 0; tick < 200; ++tick) {
    chain.advance(no_joint_contacts);
    expected.advance(no_joint_contacts);
    ASSERT_TRUE(std::ranges::equal(chain.setpoints(), expected.setpoints())) << "tick " << tick;
  }
}

TEST(KernelChain, KeepsEachParameterOnceForJointsThatJoin) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  KernelChain chain = make_chain(scenario);
  const std::size_t at_start = chain.settings().size();
  for (int number = 1; number <= 1000; ++number) {
    chain.apply(change_of("amplitude=" + std::to_string(number % 40)));
    chain.advance(no_joint_contacts);
  }
  EXPECT_LE(chain.settings().size(), at_start + scenario.robot.joints.size()) << "one parameter of each joint";
}

}  // namespace
}  // namespace proleg::sim
