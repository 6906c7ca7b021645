// The numbers of the paper could not be obtained. The oracle is the plain network of Matsuoka oscillators: their
// equations in double precision, and lags of one-way chains that were integrated independently of this project's code.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>

#include "matsuoka_model.hpp"
#include "robot.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

using test::in_degrees;
using test::robot_joints;

class Mtran : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::mtran), robot_joints), 0), Status::ok);
    const test::MatsuokaModel model;
    set("frequency", test::hertz(model.omega() / (2 * std::numbers::pi)));
    set("time_ratio", test::ratio(model.t / model.tau));
    set("fatigue", test::ratio(model.beta));
    set("inhibition", test::ratio(model.w));
    set("noise", 0);
  }

  void set(std::string_view name, std::int32_t value) { test::set_all(kernel, 0, name, value); }

  KernelOf<robot_joints> kernel;
};

// Weights of the joint ahead and the lags of the first two pairs of joints, in degrees; tau = 0.25, T = 0.5.
struct ChainRow {
  double same;
  double opposite;
  std::array<double, 2> lags;
};
constexpr std::array<ChainRow, 4> lags_of_chains = {
    {{0.2, 0, {25.4, 23.3}}, {0, -0.2, {30.7, 30.6}}, {-0.2, 0, {210.7, 210.7}}, {0, 0.2, {205.3, 205.3}}}};

TEST_F(Mtran, HasTheLagsOfOneWayChains) {
  for (const ChainRow& row : lags_of_chains) {
    set("ahead_same", test::ratio(row.same));
    set("ahead_opposite", test::ratio(row.opposite));
    kernel.reset();
    test::run(kernel, 10'000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 5000);
    for (unsigned pair = 0; pair < 2; ++pair) {
      const double lag = -meters[pair + 1].lead_over(meters[pair]);
      EXPECT_NEAR(std::remainder(lag - row.lags[pair], 360), 0, 3)
          << "weights " << row.same << ", " << row.opposite << ", pair " << pair;
    }
  }
}

/// A neuron's output in its byte of a state frame: 128ths, rounded half up.
double as_sent(double y) { return std::min(std::floor(y * 128 + 0.5), 255.0) / 128; }

TEST_F(Mtran, FollowsItsEquationsInDoublePrecision) {
  set("ahead_same", test::ratio(0.1));
  set("ahead_opposite", test::ratio(-0.15));
  set("behind_same", test::ratio(-0.05));
  set("behind_opposite", test::ratio(0.02));
  set("feedback", test::ratio(0.3));
  set("drive", test::ratio(1.2));
  kernel.reset();
  std::array<test::MatsuokaModel, robot_joints> models;
  double largest = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    std::array<double, robot_joints> y1{};
    std::array<double, robot_joints> y2{};
    for (unsigned i = 0; i < robot_joints; ++i) {
      // The first frame says 0: the outputs are computed in a tick.
      y1[i] = tick == 0 ? 0 : as_sent(models[i].y1());
      y2[i] = tick == 0 ? 0 : as_sent(models[i].y2());
    }
    for (unsigned i = 0; i < robot_joints; ++i) {
      const double felt = 0.3 * in_degrees(kernel.setpoint(i)) / 90;
      double input1 = 1.2 + felt;
      double input2 = 1.2 - felt;
      if (i > 0) {
        input1 += 0.1 * y1[i - 1] - 0.15 * y2[i - 1];
        input2 += 0.1 * y2[i - 1] - 0.15 * y1[i - 1];
      }
      if (i + 1 < robot_joints) {
        input1 += -0.05 * y1[i + 1] + 0.02 * y2[i + 1];
        input2 += -0.05 * y2[i + 1] + 0.02 * y1[i + 1];
      }
      for (int step = 0; step < 4; ++step) {
        models[i].step(0.0025, input1, input2);
      }
    }
    kernel.advance();
    for (unsigned i = 0; i < robot_joints; ++i) {
      largest = std::max(largest, std::abs(test::value(kernel, 0, i, "u1") / 268435456.0 - models[i].u1));
    }
  }
  std::cout << "within " << largest << " over 1000 ticks\n";
  EXPECT_LE(largest, 1e-2) << "a step of the frames or two, where a rounding goes the other way";
}

TEST_F(Mtran, AmplifiesInProportionToItsDrive) {
  set("ahead_opposite", 0);
  std::array<double, 2> highest{};
  for (unsigned i = 0; i < 2; ++i) {
    set("drive", test::ratio(i == 0 ? 0.5 : 1.0));
    kernel.reset();
    test::run(kernel, 2000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
    highest[i] = meters[0].highest();
    EXPECT_NEAR(meters[0].period() * 0.01, 2.23, 0.03);
  }
  EXPECT_NEAR(highest[1], 2 * highest[0], 0.01 * highest[1]);
  EXPECT_NEAR(highest[1], 80 * 0.480, 0.02 * 80 * 0.480);
}

TEST_F(Mtran, BendsEachWayByTheGainOfOneNeuron) {
  set("ahead_opposite", 0);
  set("extensor_gain", test::degrees(40));
  set("flexor_gain", test::degrees(80));
  kernel.reset();
  test::run(kernel, 2000);
  const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
  EXPECT_NEAR(meters[0].highest(), 80 * 0.480, 1);
  EXPECT_NEAR(meters[0].lowest(), -40 * 0.480, 1);
}

// A joint that feels its angle is pulled back by it: smaller and faster swings.
TEST_F(Mtran, SwingsLessTheMoreItFeelsItsJoint) {
  set("ahead_opposite", 0);
  double before = 1000;
  for (const double feedback : {0.0, 0.3, 0.6}) {
    set("feedback", test::ratio(feedback));
    kernel.reset();
    test::run(kernel, 2000);
    const std::vector<test::WaveMeter> meters = test::meter(kernel, 1000);
    EXPECT_LT(meters[0].highest(), before) << "feedback " << feedback;
    before = meters[0].highest();
  }
}

}  // namespace
}  // namespace proleg
