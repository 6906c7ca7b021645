// Oracle: the network of Hopf oscillators in double precision, from its equations (Righetti and Ijspeert 2008), stepped
// as the header says: exact rotation, relaxation, coupling.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <vector>

#include "robot.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

using std::numbers::pi;

struct Model {
  double frequency = 1;
  double phase_difference = 55 * pi / 180;
  double attraction = 10;
  double coupling = 4;
  double dt = 0.01;
  std::vector<std::complex<double>> z;

  void step() {
    const std::vector<std::complex<double>> old = z;
    for (std::size_t i = 0; i < z.size(); ++i) {
      z[i] = old[i] * std::polar(1.0, 2 * pi * frequency * dt);
      z[i] += dt * attraction * (1 - std::norm(z[i])) * z[i];
      if (i > 0) {
        z[i] += dt * coupling * (old[i - 1] * std::polar(1.0, phase_difference) - old[i]);
      }
      if (i + 1 < z.size()) {
        z[i] += dt * coupling * (old[i + 1] * std::polar(1.0, -phase_difference) - old[i]);
      }
    }
  }
};

class Hopf : public testing::Test {
 protected:
  void SetUp() override { configure(10'000, 1); }

  void configure(std::uint32_t tick_us, std::uint64_t seed) {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::hopf), robot_joints, tick_us, seed), 0),
              Status::ok);
  }

  [[nodiscard]] double ratio_of(unsigned joint, std::string_view name) const {
    return test::value(kernel, 0, joint, name) / 268435456.0;
  }

  [[nodiscard]] std::vector<std::complex<double>> states() const {
    std::vector<std::complex<double>> result;
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      result.emplace_back(ratio_of(joint, "x"), ratio_of(joint, "y"));
    }
    return result;
  }

  KernelOf<robot_joints> kernel;
};

TEST_F(Hopf, SettlesOnACircleAtItsFrequencyAndPhaseDifference) {
  for (const double lag : {55.0, -100.0}) {
    test::set_all(kernel, 0, "phase_difference", test::phase(lag));
    kernel.reset();
    test::run(kernel, 1500);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      EXPECT_NEAR(ratio_of(joint, "radius"), 1, 1e-4);
      EXPECT_NEAR(test::value(kernel, 0, joint, "measured_frequency") / 16777216.0, 1, 1e-3);
      EXPECT_NEAR(in_degrees(test::value(kernel, 0, joint, "measured_phase_difference")),
                  joint + 1 < robot_joints ? lag : 0, 0.05);
    }
  }
}

TEST_F(Hopf, FollowsItsEquationsInDoublePrecisionFromANoisyStart) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    configure(10'000, seed);
    kernel.advance();  // the frames of state 0 do not hold the noise yet
    kernel.advance();
    Model model;
    model.z = states();
    double largest = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      kernel.advance();
      model.step();
      const auto found = states();
      for (std::size_t joint = 0; joint < robot_joints; ++joint) {
        largest = std::max(largest, std::abs(found[joint] - model.z[joint]));
      }
    }
    std::cout << "seed " << seed << ": within " << largest << " over 1000 ticks\n";
    // The radius travels in 16 bits, steps of 2.4e-4.
    EXPECT_LE(largest, 1e-3);
  }
}

// Without coupling: r' = alpha (1 - r^2) r has the solution r = 1 / sqrt(1 + (1 / r0^2 - 1) exp(-2 alpha t)).
TEST_F(Hopf, ReturnsToItsCircleAsTheSolutionOfItsRadius) {
  test::set_all(kernel, 0, "coupling", 0);
  test::set_all(kernel, 0, "attraction", test::per_second(1));
  test::set_all(kernel, 0, "noise", 0);
  kernel.reset();
  ASSERT_EQ(test::distort(kernel, 0, 2, test::value_index(kernel, 0, "x"), test::ratio(0.1)), Status::ok);
  for (int tick = 1; tick < 600; ++tick) {
    kernel.advance();
    const double expected = 1 / std::sqrt(1 + (1 / 0.01 - 1) * std::exp(-2 * tick * 0.01));
    ASSERT_NEAR(ratio_of(2, "radius"), expected, 5e-3) << "tick " << tick;  // Euler steps of 0.01
  }
}

TEST_F(Hopf, GivesTheJointItsAmplitudeAroundItsOffset) {
  test::set_all(kernel, 0, "amplitude", test::degrees(35));
  test::set_all(kernel, 0, "offset", test::degrees(-10));
  kernel.reset();
  test::run(kernel, 1500);
  for (const test::WaveMeter& meter : test::meter(kernel, 500, -10)) {
    EXPECT_NEAR(meter.highest(), 25, 0.1);
    EXPECT_NEAR(meter.lowest(), -45, 0.1);
    EXPECT_NEAR(meter.period(), 100, 0.01);
  }
}

// omega is omega_falling where y > 0 and omega_rising elsewhere: half turns of d and 1 - d of the period.
TEST_F(Hopf, FallsForItsFractionOfThePeriod) {
  for (const double fraction : {0.25, 0.5, 0.75}) {
    test::set_all(kernel, 0, "falling_fraction", test::ratio(fraction));
    kernel.reset();
    test::run(kernel, 2000);
    int falling = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      kernel.advance();
      falling += kernel.setpoint(2) < kernel.previous_setpoint(2) ? 1 : 0;
    }
    EXPECT_NEAR(falling / 1000.0, fraction, 0.02) << fraction;
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
    EXPECT_NEAR(meters[2].period(), 100, 2) << fraction;
    EXPECT_NEAR(meters[3].lead_over(meters[2]), 55, 2) << fraction;
  }
}

TEST_F(Hopf, StaysStableAtTheStrongestCouplingAndAttractionWhateverTheTick) {
  for (const std::uint32_t tick_us : {1'000U, 10'000U, 31'000U, 100'000U}) {
    configure(tick_us, 9);
    test::set_all(kernel, 0, "coupling", test::per_second(25));
    test::set_all(kernel, 0, "attraction", test::per_second(50));
    kernel.reset();
    test::run(kernel, 3000);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      EXPECT_NEAR(ratio_of(joint, "radius"), 1, 0.01) << "tick " << tick_us << " us";
    }
  }
}

}  // namespace
}  // namespace proleg
