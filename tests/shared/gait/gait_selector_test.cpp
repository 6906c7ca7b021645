// The wave that chooses among four sets of parameters.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <numbers>
#include <random>
#include <string>

#include "module_chain.hpp"
#include "robot.hpp"

namespace proleg::gait_selector_test {
namespace {

using test::in_degrees;
using test::ModuleChain;
using test::ratio;
using test::robot_joints;
using test::robot_links;

constexpr double tick_s = 0.01;

enum Feature : std::int32_t { pitch = 1, pitch_swing, roll, touch, head_touch, touch_changes, current, tracking_error };
constexpr std::array<const char*, 8> feature_names{"pitch",      "pitch_swing",   "roll",    "touch",
                                                   "head_touch", "touch_changes", "current", "tracking_error"};

KernelConfiguration configuration(unsigned joints = robot_joints) {
  return test::one_slot(test::algorithm(test::selector), joints);
}

void set_rule(Kernel& kernel, int set, std::int32_t feature, double threshold, std::int32_t second = 0,
              double second_threshold = 0) {
  const std::string number = std::to_string(set);
  test::set_all(kernel, 0, "feature_" + number, feature);
  test::set_all(kernel, 0, "threshold_" + number, ratio(threshold));
  test::set_all(kernel, 0, "second_feature_" + number, second);
  test::set_all(kernel, 0, "second_threshold_" + number, ratio(second_threshold));
}

void set_gait(Kernel& kernel, int set, double amplitude, double frequency, double phase_difference, double offset) {
  const std::string number = std::to_string(set);
  test::set_all(kernel, 0, "amplitude_" + number, test::degrees(amplitude));
  test::set_all(kernel, 0, "frequency_" + number, test::hertz(frequency));
  test::set_all(kernel, 0, "phase_difference_" + number, test::phase(phase_difference));
  test::set_all(kernel, 0, "offset_" + number, test::degrees(offset));
}

/// A rule for each set by one feature that the tests drive: set 2 from 0.3 on, 3 from 0.5, 4 from 0.7.
void set_ladder(Kernel& kernel, std::int32_t window_ms = 1, std::int32_t dwell_ms = 0) {
  set_rule(kernel, 2, pitch, 0.3);
  set_rule(kernel, 3, pitch, 0.5);
  set_rule(kernel, 4, pitch, 0.7);
  test::set_all(kernel, 0, "window", window_ms);
  test::set_all(kernel, 0, "dwell", dwell_ms);
  set_gait(kernel, 2, 60, 1.5, 90, 5);
  set_gait(kernel, 3, 20, 0.5, -40, -10);
  set_gait(kernel, 4, 35, 2, 120, 0);
  kernel.reset();  // how long it waits for its first decision depends on the window
}

JointReadings inclined(double pitch_of_quarter_turn) {
  JointReadings readings;
  readings.present = JointReadings::inclination;
  readings.pitch = test::degrees(90 * pitch_of_quarter_turn);
  return readings;
}

std::int32_t set_of(const Kernel& kernel, unsigned joint) { return test::value(kernel, 0, joint, "set"); }

/// All joints in one kernel.
class GaitSelector : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(kernel_.configure(configuration(), 0), Status::ok); }

  void tick(const JointReadings& readings) {
    kernel_.set_readings(0, readings);
    kernel_.advance();
  }
  /// Ticks with these readings until a decision has taken effect.
  void settle(const JointReadings& readings, int ticks = 30) {
    for (int i = 0; i < ticks; ++i) {
      tick(readings);
    }
  }
  [[nodiscard]] double feature(Feature number) const {
    return test::value(kernel_, 0, 0, feature_names[static_cast<std::size_t>(number - 1)]) / std::ldexp(1.0, 28);
  }

  KernelOf<robot_joints> kernel_;
};

TEST(GaitSelectorWithoutRules, IsTheExtendedSineBitForBit) {
  std::mt19937 random(161);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const auto tick_us = static_cast<std::uint32_t>(1000 + random() % 99'001);
    KernelOf<robot_joints> own;
    KernelOf<robot_joints> sine;
    ASSERT_EQ(own.configure(test::one_slot(test::algorithm(test::selector), robot_joints, tick_us), 0), Status::ok);
    ASSERT_EQ(sine.configure(test::one_slot(test::algorithm(test::extended), robot_joints, tick_us), 0), Status::ok);
    for (const auto& [name, value] : {std::pair{std::string("amplitude"), test::degrees(90 * unit(random))},
                                      std::pair{std::string("frequency"), test::hertz(20 * unit(random))},
                                      std::pair{std::string("phase_difference"), test::phase(360 * unit(random))},
                                      std::pair{std::string("offset"), test::degrees(90 * unit(random))}}) {
      test::set_all(own, 0, name + "_1", value);
      test::set_all(sine, 0, name, value);
    }
    own.reset();
    sine.reset();
    for (int tick = 0; tick < 300; ++tick) {
      own.advance();
      sine.advance();
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        ASSERT_EQ(own.setpoint(joint), sine.setpoint(joint)) << "seed 161, trial " << trial << ", tick " << tick;
      }
    }
  }
}

// x' = (input - x) / window, one step a tick.
TEST_F(GaitSelector, FeaturesAreTheLowPassFilteredQuantitiesOfTheirEquations) {
  constexpr double window_s = 0.5;
  test::set_all(kernel_, 0, "window", 500);
  // All features are named by a rule; no rule holds.
  set_rule(kernel_, 2, pitch, 7, roll, 7);
  set_rule(kernel_, 3, pitch_swing, 7, current, 7);
  set_rule(kernel_, 4, tracking_error, 7, touch, 7);
  kernel_.reset();
  std::mt19937 random(162);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::array<double, 6> expected{};
  double largest = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    JointReadings readings;
    readings.present = JointReadings::all_sensors;
    const double pitch_now = unit(random);
    const double roll_now = unit(random);
    const double angle_now = unit(random);
    readings.pitch = test::degrees(90 * pitch_now);
    readings.roll = test::degrees(90 * roll_now) * 2;
    readings.angle = test::degrees(90 * angle_now);
    readings.current_ma = static_cast<std::int32_t>(random() % 2000);
    const double setpoint = in_degrees(kernel_.setpoint(0)) / 90;
    this->tick(readings);
    const std::array<double, 5> inputs{pitch_now, std::abs(pitch_now - expected[0]), std::abs(roll_now),
                                       readings.current_ma / 1000.0, std::abs(setpoint - angle_now)};
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      expected[i] += (inputs[i] - expected[i]) * tick_s / window_s;
    }
    const std::array<Feature, 5> features{pitch, pitch_swing, roll, current, tracking_error};
    for (std::size_t i = 0; i < features.size(); ++i) {
      largest = std::max(largest, std::abs(feature(features[i]) - expected[i]));
    }
  }
  EXPECT_LT(largest, 1e-5);
  std::cout << "seed 162: largest error of a feature " << largest << '\n';
}

// The links that touch, from the contacts of all joints' frames, a tick later.
TEST_F(GaitSelector, FeaturesOfTouchCountAllLinks) {
  constexpr double window_s = 4;
  test::set_all(kernel_, 0, "window", 4000);
  set_rule(kernel_, 2, touch, 7, head_touch, 7);
  set_rule(kernel_, 3, touch_changes, 7);
  kernel_.reset();
  std::mt19937 random(163);
  std::array<bool, robot_links> touches{};
  std::array<bool, robot_links> before{};
  std::array<double, 3> expected{};
  for (int tick = 0; tick < 1000; ++tick) {
    const double links = robot_links;
    const double count = static_cast<double>(std::ranges::count(touches, true));
    double changed = 0;
    for (unsigned link = 0; link < robot_links; ++link) {
      changed += touches[link] != before[link] ? 1 : 0;
    }
    before = touches;
    const std::array<double, 3> inputs{count / links, touches[0] ? 1.0 : 0.0, changed / links / tick_s};
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const unsigned rear = random() % 30 == 0 ? random() % 4 : 0;
      const unsigned head = random() % 30 == 0 ? random() % 4 : 0;
      kernel_.set_contacts(joint, static_cast<std::uint8_t>(rear | (joint == 0 ? head << 2U : 0U)));
      touches[joint + 1] = rear != 0;
      touches[0] = joint == 0 ? head != 0 : touches[0];
    }
    kernel_.advance();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      expected[i] += (inputs[i] - expected[i]) * tick_s / window_s;
    }
    EXPECT_NEAR(feature(touch), expected[0], 1e-5) << "seed 163, tick " << tick;
    EXPECT_NEAR(feature(head_touch), expected[1], 1e-5);
    EXPECT_NEAR(feature(touch_changes), expected[2], 1e-4);
  }
  EXPECT_GT(expected[2], 0.5) << "touches changed often enough to be a test";
}

TEST(GaitSelectorOfALongRobot, CountsChangesOfTouchOfTheFirst31Links) {
  constexpr unsigned joints = 60;
  KernelOf<joints> kernel;
  ASSERT_EQ(kernel.configure(configuration(joints), 0), Status::ok);
  test::set_all(kernel, 0, "window", 4000);
  set_rule(kernel, 2, touch_changes, 7);
  kernel.reset();
  for (int tick = 0; tick < 3000; ++tick) {
    for (unsigned joint = 0; joint < joints; ++joint) {  // each link touches for 0.5 s, then for 0.5 s not
      kernel.set_contacts(joint, tick / 50 % 2 == 0 ? 0 : 0b0101);
    }
    kernel.advance();
  }
  // The joint in front knows the first two links, all others one: each link changes twice a second.
  EXPECT_NEAR(test::value(kernel, 0, 0, "touch_changes") / std::ldexp(1.0, 28), 2.0, 0.25);
}

TEST_F(GaitSelector, AFeatureThatNoRuleNamesIsNotComputed) {
  set_rule(kernel_, 2, roll, 0.5);
  JointReadings readings = inclined(0.5);
  readings.roll = test::degrees(45);
  settle(readings);
  EXPECT_EQ(feature(pitch), 0);
  EXPECT_EQ(feature(touch), 0);
  EXPECT_GT(feature(roll), 0);
}

TEST_F(GaitSelector, AFeatureWhoseSensorFailsKeepsItsValue) {
  set_ladder(kernel_, 500);
  settle(inclined(0.4), 300);
  const double before = feature(pitch);
  EXPECT_NEAR(before, 0.4, 0.01);
  settle(JointReadings{}, 300);
  EXPECT_EQ(feature(pitch), before);
  EXPECT_EQ(set_of(kernel_, 0), 2);
}

TEST_F(GaitSelector, TheGreatestSetWhoseRuleHoldsIsPlayedByAllJoints) {
  set_ladder(kernel_);
  for (const auto& [inclination, expected] : {std::pair{0.1, 1}, std::pair{0.4, 2}, std::pair{0.9, 4},
                                              std::pair{0.6, 3}, std::pair{0.2, 1}, std::pair{-0.9, 1}}) {
    settle(inclined(inclination));
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      EXPECT_EQ(set_of(kernel_, joint), expected) << "pitch " << inclination << ", joint " << joint;
    }
  }
}

TEST_F(GaitSelector, ARuleWithTwoConditionsNeedsBothAndANegativeFeatureMeansBelow) {
  test::set_all(kernel_, 0, "window", 1);
  test::set_all(kernel_, 0, "dwell", 0);
  set_rule(kernel_, 2, -pitch, 0.1, pitch, -0.4);
  kernel_.reset();
  for (const auto& [inclination, expected] :
       {std::pair{0.3, 1}, std::pair{0.0, 2}, std::pair{-0.6, 1}, std::pair{-0.2, 2}}) {
    settle(inclined(inclination));
    EXPECT_EQ(set_of(kernel_, 0), expected) << "pitch " << inclination;
  }
}

TEST_F(GaitSelector, TheSetEndsOnlyWhenTheFeatureIsBackByTheHysteresis) {
  set_ladder(kernel_);
  test::set_all(kernel_, 0, "hysteresis", ratio(0.05));
  for (const auto& [inclination, expected] :
       {std::pair{0.29, 1}, std::pair{0.31, 2}, std::pair{0.26, 2}, std::pair{0.24, 1}, std::pair{0.29, 1}}) {
    settle(inclined(inclination));
    EXPECT_EQ(set_of(kernel_, 0), expected) << "pitch " << inclination;
  }
}

TEST_F(GaitSelector, DecisionsAreTheDwellTimeApart) {
  set_ladder(kernel_, 1, 700);
  std::mt19937 random(164);
  std::int32_t announced = 1;
  std::uint32_t last = 0;
  int changes = 0;
  for (std::uint32_t tick = 0; tick < 3000; ++tick) {
    this->tick(inclined(static_cast<double>(random() % 100) / 100));
    const std::int32_t now = test::value(kernel_, 0, 0, "announced_set");
    if (now != announced) {
      EXPECT_GE(tick - last, 70U) << "seed 164";
      last = tick;
      announced = now;
      ++changes;
    }
  }
  EXPECT_GT(changes, 20);
  std::cout << "seed 164: " << changes << " decisions in 30 s of random inputs\n";
}

// Its features begin at 0, which is not what the robot senses.
TEST_F(GaitSelector, DoesNotDecideInTheFirstThreeWindows) {
  set_ladder(kernel_, 500);
  set_rule(kernel_, 2, -pitch, 0.35);  // holds for the features at the start, not for those of the robot
  set_rule(kernel_, 3, 0, 0);
  kernel_.reset();
  for (int tick = 0; tick < 1000; ++tick) {
    this->tick(inclined(0.4));
    EXPECT_EQ(set_of(kernel_, 0), 1) << "tick " << tick;
  }
  set_rule(kernel_, 2, pitch, 0.3);
  kernel_.reset();
  int first = 0;
  while (first < 1000 && test::value(kernel_, 0, 0, "announced_set") == 1) {
    tick(inclined(0.4));
    ++first;
  }
  EXPECT_NEAR(first, 150, 2) << "three windows of 500 ms";
}

TEST_F(GaitSelector, AChangeOfTheSetIsNoJump) {
  set_ladder(kernel_);
  std::mt19937 random(165);
  double largest = 0;
  std::array<double, robot_joints> before{};
  for (int tick = 0; tick < 6000; ++tick) {
    const double inclination = 0.2 * static_cast<double>(random() % 5);
    for (int i = 0; i < 40; ++i, ++tick) {
      this->tick(inclined(inclination));
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        const double angle = in_degrees(kernel_.setpoint(joint));
        largest = std::max(largest, std::abs(angle - before[joint]));
        before[joint] = angle;
      }
    }
  }
  // The fastest joint of a steady gait moves by 60 degrees * 2 pi * 1.5 Hz * 10 ms in a tick. The filter of the phase
  // adds at most 180 degrees * (rate / 2) / e a second: half a turn with a double pole at rate / 2.
  const double steady = 60 * 2 * std::numbers::pi * 1.5 * tick_s;
  const double shifting = 60 * std::numbers::pi * 10 / std::numbers::e * tick_s;
  EXPECT_LT(largest, steady + shifting);
  std::cout << "seed 165: at most " << largest << " degrees in a tick; the steady gait has " << steady << '\n';
}

/// Plays a robot of modules; the first module gets readings.
void play(ModuleChain& chain, double inclination, const std::function<bool(unsigned, unsigned)>& loses) {
  chain.exchange(loses);
  chain[0].set_readings(0, inclined(inclination));
  chain.advance();
}
bool loses_nothing(unsigned /*sender*/, unsigned /*receiver*/) { return false; }

ModuleChain ladder_chain(unsigned joints = robot_joints) {
  ModuleChain chain(configuration(joints));
  for (unsigned joint = 0; joint < joints; ++joint) {
    set_ladder(chain[joint]);
  }
  chain.reset();
  return chain;
}

TEST(GaitSelectorModules, ChangeTheirSetInTheSameTick) {
  for (const unsigned joints : {1U, 2U, 5U, 24U, 64U}) {
    // Without a dwell time, and with a cause for another decision while one goes round.
    for (const int period : {150, 40, 1}) {
      ModuleChain chain = ladder_chain(joints);
      int changes = 0;
      std::int32_t last = 1;
      for (int tick = 0; tick < 1500; ++tick) {
        play(chain, 0.2 * (tick / period % 5), loses_nothing);
        const std::int32_t set = set_of(chain[0], 0);
        changes += set != last ? 1 : 0;
        last = set;
        for (unsigned joint = 1; joint < joints; ++joint) {
          ASSERT_EQ(set_of(chain[joint], joint), set)
              << joints << " joints, joint " << joint << ", tick " << tick << ", period " << period;
        }
      }
      EXPECT_GE(changes, 7) << joints << " joints, period " << period;
    }
  }
}

TEST(GaitSelectorModules, ChangeInTheSameTickAlthoughOneFrameInTenIsLost) {
  ModuleChain chain = ladder_chain();
  std::mt19937 random(167);
  unsigned late = 0;
  unsigned ticks = 0;
  for (int tick = 0; tick < 20'000; ++tick) {
    play(chain, 0.2 * (tick / 150 % 5), [&](unsigned, unsigned) { return random() % 10 == 0; });
    for (unsigned joint = 1; joint < robot_joints; ++joint) {
      late += set_of(chain[joint], joint) != set_of(chain[0], 0) ? 1 : 0;
      ++ticks;
    }
  }
  // A decision is 8 ticks ahead at the last joint: all of 8 frames of a joint are lost once in 10^8.
  EXPECT_EQ(late, 0U) << "of " << ticks << ", seed 167";
}

TEST(GaitSelectorModules, AJointThatReceivesNothingKeepsItsSetAndIsRightATickAfterAFrame) {
  ModuleChain cut = ladder_chain();
  ModuleChain complete = ladder_chain();
  const auto is_cut = [](int tick) { return tick >= 100 && tick < 400; };
  for (int tick = 0; tick < 900; ++tick) {
    const double inclination = tick < 150 ? 0.0 : 0.4;
    play(cut, inclination, [&](unsigned, unsigned receiver) { return is_cut(tick) && receiver == 2; });
    play(complete, inclination, loses_nothing);
    if (tick > 200 && is_cut(tick)) {
      EXPECT_EQ(set_of(cut[2], 2), 1) << tick;
      EXPECT_EQ(set_of(cut[1], 1), 2) << tick;
    }
    if (tick >= 402) {
      ASSERT_EQ(set_of(cut[2], 2), 2) << tick;
      ASSERT_EQ(test::value(cut[2], 0, 2, "current_phase"), test::value(complete[2], 0, 2, "current_phase")) << tick;
    }
  }
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(cut[joint].setpoint(joint), complete[joint].setpoint(joint)) << "5 s after it, joint " << joint;
  }
}

TEST(GaitSelectorModules, OnlyTheFirstJointOfTheGroupDecides) {
  ModuleChain chain = ladder_chain();
  for (int tick = 0; tick < 100; ++tick) {
    chain.exchange();
    for (unsigned joint = 1; joint < robot_joints; ++joint) {
      chain[joint].set_readings(joint, inclined(0.9));
    }
    chain[0].set_readings(0, inclined(0));
    chain.advance();
  }
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(set_of(chain[joint], joint), 1);
  }
}

TEST(GaitSelectorModules, AModuleThatJoinsAgainTakesTheDecisionOfTheRobotEvenTheFirst) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    ModuleChain joining = ladder_chain();
    ModuleChain complete = ladder_chain();
    for (int tick = 0; tick < 300; ++tick) {
      if (tick == 200) {
        joining[joint].join(200);
      }
      play(joining, 0.6, [&](unsigned sender, unsigned) { return tick == 200 && sender == joint; });
      play(complete, 0.6, loses_nothing);
      EXPECT_EQ(set_of(joining[joint], joint), set_of(complete[joint], joint))
          << "joint " << joint << ", tick " << tick;
    }
    for (unsigned each = 0; each < robot_joints; ++each) {
      EXPECT_EQ(joining[each].setpoint(each), complete[each].setpoint(each)) << "joint " << joint;
    }
  }
}

/// Values of all parameters of one joint, with some that differ from the defaults.
class Values {
 public:
  Values() {
    const std::span<const Parameter> parameters = about().parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      values_[i] = parameters[i].default_value;
    }
  }
  Values& rule(int set, std::int32_t feature, double threshold, std::int32_t second = 0, double second_threshold = 0) {
    const std::string number = std::to_string(set);
    put("feature_" + number, feature);
    put("threshold_" + number, ratio(threshold));
    put("second_feature_" + number, second);
    put("second_threshold_" + number, ratio(second_threshold));
    return *this;
  }
  [[nodiscard]] const std::int32_t* data() const { return values_.data(); }
  static const Declaration& about() { return test::algorithm(test::selector).declaration(); }

 private:
  void put(const std::string& name, std::int32_t value) {
    values_[static_cast<std::size_t>(find_parameter(about(), name))] = value;
  }

  std::array<std::int32_t, max_parameters> values_{};
};

std::string contradiction_in(const Values& values) {
  const auto found = Values::about().rules->contradiction(values.data());
  return found ? std::string(Values::about().parameters[found->parameter].name) + ", " +
                     std::string(Values::about().parameters[found->other].name)
               : "";
}

TEST(GaitSelectorRules, ThatContradictAreNamed) {
  EXPECT_EQ(contradiction_in(Values()), "");
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.3).rule(3, pitch, 0.5)), "");
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.3, -pitch, 0.5)), "");
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.5, -pitch, 0.3)), "threshold_2, second_threshold_2");
  EXPECT_EQ(contradiction_in(Values().rule(4, -roll, 0.5, roll, 0.5)), "threshold_4, second_threshold_4");
  // A value has to lie between the thresholds.
  constexpr double step = 1.0 / (1 << 28);
  EXPECT_EQ(contradiction_in(Values().rule(4, -roll, 0.5, roll, 0.5 - step)), "threshold_4, second_threshold_4");
  EXPECT_EQ(contradiction_in(Values().rule(4, -roll, 0.5, roll, 0.5 - 2 * step)), "");
  EXPECT_EQ(contradiction_in(Values().rule(3, 0, 0, touch, 0.5)), "feature_3, second_feature_3");
  // Set 3 comes before set 2, whose rule holds only where that of set 3 does.
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.5).rule(3, pitch, 0.3)), "threshold_2, threshold_3");
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.5, touch, 0.1).rule(4, pitch, 0.3)), "threshold_2, threshold_4");
  EXPECT_EQ(contradiction_in(Values().rule(2, touch, 0.1, pitch, 0.5).rule(4, pitch, 0.3)),
            "second_threshold_2, threshold_4");
  EXPECT_EQ(contradiction_in(Values().rule(2, pitch, 0.5).rule(4, pitch, 0.3, touch, 0.1)), "");
  EXPECT_EQ(contradiction_in(Values().rule(3, -touch, 0.2).rule(4, -touch, 0.2)), "threshold_3, threshold_4");
}

TEST(GaitSelectorRules, NeedTheSensorsOfTheirFeaturesOnly) {
  const auto required = [](const Values& values) { return Values::about().rules->required_readings(values.data()); };
  EXPECT_EQ(required(Values()), 0);
  EXPECT_EQ(required(Values().rule(2, touch, 0.3).rule(3, head_touch, 0.5, -touch_changes, 0.2)), 0);
  EXPECT_EQ(required(Values().rule(2, current, 0.3)), JointReadings::servo_current);
  EXPECT_EQ(required(Values().rule(2, -pitch_swing, 0.3)), JointReadings::inclination);
  EXPECT_EQ(required(Values().rule(4, touch, 0.3, roll, 0.5).rule(2, tracking_error, 0.1)),
            JointReadings::inclination | JointReadings::angle_of_joint);
}

}  // namespace
}  // namespace proleg::gait_selector_test
