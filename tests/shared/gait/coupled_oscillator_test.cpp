#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <set>

#include "oscillator_model.hpp"
#include "robot.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::in_radians;
using test::robot_joints;

class CoupledOscillator : public testing::Test {
 protected:
  void SetUp() override { configure(10'000, 1); }

  void configure(std::uint32_t tick_us, std::uint64_t seed) {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::coupled), robot_joints, tick_us, seed), 0),
              Status::ok);
  }

  [[nodiscard]] std::int32_t value(unsigned joint, std::string_view name) const {
    return test::value(kernel, 0, joint, name);
  }

  /// The model with default parameters, in the kernel's present state.
  [[nodiscard]] test::OscillatorModel model() const {
    test::OscillatorModel result;
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      result.theta.push_back(in_radians(value(joint, "current_phase")));
      result.r.push_back({in_degrees(value(joint, "current_amplitude")), 0});
      result.x.push_back({in_degrees(value(joint, "current_offset")), 0});
    }
    return result;
  }

  /// Largest deviation of a phase difference between neighbours from `wanted`, in degrees.
  [[nodiscard]] double lag_error(double wanted) const {
    double largest = 0;
    for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
      const std::uint32_t error = static_cast<std::uint32_t>(value(joint + 1, "current_phase")) -
                                  static_cast<std::uint32_t>(value(joint, "current_phase")) -
                                  static_cast<std::uint32_t>(test::phase(wanted));
      largest = std::max(largest, std::abs(in_degrees(static_cast<std::int32_t>(error))));
    }
    return largest;
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(CoupledOscillator, SettlesOnTheClosedForm) {
  test::set_all(kernel, 0, "amplitude", test::degrees(35));
  test::set_all(kernel, 0, "offset", test::degrees(10));
  test::set_all(kernel, 0, "phase_difference", test::phase(70));
  kernel.reset();
  test::run(kernel, 1000);
  EXPECT_LE(lag_error(70), 0.02);
  const double start = in_degrees(value(0, "current_phase"));
  for (int tick = 0; tick < 1000; ++tick) {
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const double argument = start + 360 * tick * 0.01 + joint * 70.0;
      ASSERT_NEAR(in_degrees(kernel.setpoint(joint)), 10 + 35 * std::cos(argument * std::numbers::pi / 180), 0.02)
          << "tick " << tick << ", joint " << joint;
    }
    kernel.advance();
  }
}

// Coupling through states of one age: stale neighbours would slow the chain to 0.86 Hz.
TEST_F(CoupledOscillator, RunsAtItsFrequencyAtEveryStableCoupling) {
  for (const double coupling : {4.0, 10.0, 20.0, 50.0}) {
    test::set_all(kernel, 0, "coupling", test::per_second(coupling));
    kernel.reset();
    test::run(kernel, 1000);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      EXPECT_NEAR(value(joint, "measured_frequency") / 16777216.0, 1.0, 1e-5) << "coupling " << coupling;
      EXPECT_NEAR(in_degrees(value(joint, "measured_phase_difference")), joint + 1 < robot_joints ? 55 : 0, 0.02)
          << "coupling " << coupling;
    }
  }
}

TEST_F(CoupledOscillator, FollowsItsEquationsInDoublePrecisionFromANoisyStart) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    configure(10'000, seed);
    test::OscillatorModel reference = model();
    double largest_phase_error = 0;
    double largest_output_error = 0;
    for (int tick = 0; tick <= 1000; ++tick) {
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        const double error = in_radians(value(joint, "current_phase")) - reference.theta[joint];
        largest_phase_error = std::max(largest_phase_error,
                                       std::abs(std::remainder(error, 2 * std::numbers::pi)) * 180 / std::numbers::pi);
        largest_output_error =
            std::max(largest_output_error, std::abs(in_degrees(kernel.setpoint(joint)) - reference.output(joint)));
      }
      kernel.advance();
      reference.step();
    }
    std::cout << "seed " << seed << ": phase within " << largest_phase_error << ", output within "
              << largest_output_error << " degrees over 1000 ticks\n";
    EXPECT_LE(largest_phase_error, 2e-4);
    EXPECT_LE(largest_output_error, 2e-4);
  }
}

// Known times until a chain of five is within 0.02 rad, for a start about half a radian away; they follow from its
// slowest mode, w 2 (1 - cos(pi / 5)). Here the joints start in phase and 30 degrees are wanted.
TEST_F(CoupledOscillator, SettlesInTheTimesOfItsSlowestMode) {
  const std::array<std::array<double, 2>, 4> expected = {{{2, 4.5}, {4, 2.3}, {10, 0.92}, {20, 0.46}}};
  for (const auto& [coupling, seconds] : expected) {
    test::set_all(kernel, 0, "noise", 0);
    test::set_all(kernel, 0, "phase_difference", test::phase(30));
    test::set_all(kernel, 0, "coupling", test::per_second(coupling));
    kernel.reset();
    test::OscillatorModel reference = model();
    reference.coupling = coupling;
    reference.phase_difference = 30 * std::numbers::pi / 180;
    int ticks = 0;
    int reference_ticks = 0;
    for (int tick = 1; tick < 1000; ++tick) {
      kernel.advance();
      reference.step();
      if (lag_error(30) > 0.02 * 180 / std::numbers::pi) {
        ticks = tick;
      }
      for (unsigned joint = 0; joint + 1 < robot_joints; ++joint) {
        const double lag = reference.theta[joint + 1] - reference.theta[joint];
        if (std::abs(lag - reference.phase_difference) > 0.02) {
          reference_ticks = tick;
        }
      }
    }
    std::cout << "coupling " << coupling << ": settled after " << ticks * 0.01 << " s\n";
    EXPECT_EQ(ticks, reference_ticks) << "coupling " << coupling;
    EXPECT_NEAR(ticks * 0.01, seconds, 0.15 * seconds) << "coupling " << coupling;
  }
}

TEST_F(CoupledOscillator, StaysStableAtTheStrongestCouplingWhateverTheTick) {
  for (const std::uint32_t tick_us : {1'000U, 10'000U, 31'000U, 100'000U}) {
    configure(tick_us, 9);
    test::set_all(kernel, 0, "coupling", test::per_second(50));
    kernel.reset();
    test::run(kernel, 3000);
    EXPECT_LE(lag_error(55), 0.02) << "tick " << tick_us << " us";
  }
}

TEST_F(CoupledOscillator, StartsTheSameFromTheSameSeedAndDifferentlyFromAnother) {
  std::array<std::int32_t, robot_joints> first{};
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    first[joint] = value(joint, "current_phase");
  }
  EXPECT_EQ(std::set<std::int32_t>(first.begin(), first.end()).size(), robot_joints)
      << "every joint has noise of its own";
  test::run(kernel, 10);
  kernel.reset();
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(value(joint, "current_phase"), first[joint]);
  }
  configure(10'000, 2);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_NE(value(joint, "current_phase"), first[joint]);
  }
}

TEST_F(CoupledOscillator, StartsFromNoiseOfTheDeclaredDeviation) {
  const Declaration& about = test::algorithm(test::coupled).declaration();
  for (const double level : {0.5, 1.0}) {
    for (std::size_t i = 0; i < about.internal_values.size(); ++i) {
      double sum = 0;
      double squares = 0;
      int count = 0;
      for (std::uint64_t seed = 0; seed < 400; ++seed) {
        configure(10'000, seed);
        test::set_all(kernel, 0, "noise", test::ratio(level));
        kernel.reset();
        for (unsigned joint = 0; joint < robot_joints; ++joint) {
          const double sample = in_degrees(kernel.internal_value(0, joint, static_cast<unsigned>(i)));
          sum += sample;
          squares += sample * sample;
          ++count;
        }
      }
      const double deviation = level * in_degrees(about.internal_values[i].noise_scale);
      // 2000 samples: the mean is known to 1/45, the deviation to 1/63 of a deviation; four times that.
      EXPECT_NEAR(sum / count, 0, deviation * 0.09) << about.internal_values[i].name;
      EXPECT_NEAR(std::sqrt(squares / count), deviation, deviation * 0.065) << about.internal_values[i].name;
    }
  }
}

// A phase is a place on a circle: noise beyond half a turn goes round and does not pile up there.
TEST_F(CoupledOscillator, WrapsNoiseOfThePhaseBeyondHalfATurn) {
  int at_half_a_turn = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    configure(10'000, seed);
    test::set_all(kernel, 0, "noise", test::ratio(4));
    kernel.reset();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      at_half_a_turn += std::abs(in_degrees(value(joint, "current_phase"))) > 179.99 ? 1 : 0;
    }
  }
  EXPECT_LE(at_half_a_turn, 2);
}

TEST_F(CoupledOscillator, CouplesAcrossJointsThatTheGroupLeavesOut) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), robot_joints);
  configuration.slots[0].group = JointMask(0b11001);
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  test::run(kernel, 1500);
  EXPECT_NEAR(in_degrees(value(0, "measured_phase_difference")), 165, 0.02) << "three joints further on";
  EXPECT_NEAR(in_degrees(value(3, "measured_phase_difference")), 55, 0.02);
  EXPECT_EQ(value(4, "measured_phase_difference"), 0);
  EXPECT_EQ(kernel.setpoint(1), 0);
}

// The coupling does not contain the neighbours' amplitude, so a joint at rest still passes the wave on.
TEST_F(CoupledOscillator, HandsTheWaveOnThroughAJointAtRest) {
  test::set(kernel, 0, 2, "amplitude", 0);
  kernel.reset();
  test::run(kernel, 1000);
  EXPECT_LE(lag_error(55), 0.02);
  EXPECT_EQ(kernel.setpoint(2), 0);
}

}  // namespace
}  // namespace proleg
