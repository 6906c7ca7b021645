#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>

#include "robot.hpp"

namespace proleg {
namespace {

using test::robot_joints;
using test::robot_links;

/// Contacts of all links, head first, two bits for each: rear sensor, front sensor.
template <std::size_t JointCount>
void touch(KernelOf<JointCount>& kernel, std::uint64_t sensors) {
  for (unsigned joint = 0; joint < JointCount; ++joint) {
    const std::uint64_t behind = (sensors >> (2 * (joint + 1))) & 3U;
    kernel.set_contacts(joint, static_cast<std::uint8_t>(behind | (joint == 0 ? (sensors & 3U) << 2U : 0U)));
  }
}

/// Turns one bit for each link, head first, into the bits of sensors: either sensor in turn, so that each counts.
std::uint64_t by_alternating_sensors(unsigned touched) {
  std::uint64_t sensors = 0;
  for (unsigned link = 0; link < robot_links; ++link) {
    sensors |= std::uint64_t{(touched >> link) & 1U} << (2 * link + link % 2);
  }
  return sensors;
}

/// The condition by the text of the declaration: a pair of touched links at most `reach` places apart.
bool is_uneven(unsigned touched, unsigned reach) {
  for (unsigned a = 0; a < robot_links; ++a) {
    for (unsigned b = a + 1; b < robot_links; ++b) {
      if (((touched >> a) & (touched >> b) & 1U) != 0 && b - a <= reach) {
        return true;
      }
    }
  }
  return false;
}

void configure(Kernel& kernel, std::uint32_t tick_us = 10'000) {
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::reflex), robot_joints, tick_us), 0), Status::ok);
}

double offset(const Kernel& kernel, unsigned joint = 2) {
  return test::in_degrees(test::value(kernel, 0, joint, "offset"));
}

/// Number of ticks until contacts have an effect: they are a tick old, and must last for two.
constexpr unsigned until_it_acts = 3;

constexpr unsigned flat = 0b100001;    // head and tail
constexpr unsigned uneven = 0b000101;  // head, and the second link behind it

TEST(UnevenGroundReflex, ActsOnExactlyThosePatternsOfTouchedLinksInWhichTwoAreWithinReach) {
  for (unsigned reach = 0; reach <= robot_links; ++reach) {
    for (unsigned touched = 0; touched < 1U << robot_links; ++touched) {
      KernelOf<robot_joints> kernel;
      configure(kernel);
      test::set_all(kernel, 0, "reach", static_cast<std::int32_t>(reach));
      touch(kernel, by_alternating_sensors(touched));
      test::run(kernel, until_it_acts);
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        ASSERT_EQ(kernel.setpoint(joint) > 0, is_uneven(touched, reach)) << "reach " << reach << " links " << touched;
      }
    }
  }
}

TEST(UnevenGroundReflex, TakesALinkAsTouchedByEitherOfItsSensors) {
  for (unsigned sensors = 0; sensors < 1U << (2 * robot_links); ++sensors) {
    unsigned touched = 0;
    for (unsigned link = 0; link < robot_links; ++link) {
      touched |= ((sensors >> (2 * link)) & 3U) != 0 ? 1U << link : 0U;
    }
    KernelOf<robot_joints> kernel;
    configure(kernel);
    touch(kernel, sensors);
    test::run(kernel, until_it_acts);
    ASSERT_EQ(kernel.setpoint(0) > 0, is_uneven(touched, 2)) << "sensors " << sensors;
  }
}

TEST(UnevenGroundReflex, HeedsEveryLinkOfTheLongestRobot) {
  const auto kernel = std::make_unique<KernelOf<max_joints>>();
  ASSERT_EQ(kernel->configure(test::one_slot(test::algorithm(test::reflex), max_joints), 0), Status::ok);
  const auto touch_pair = [&](unsigned front, unsigned back) {
    for (unsigned joint = 0; joint < max_joints; ++joint) {
      const bool behind = joint + 1 == front || joint + 1 == back;
      kernel->set_contacts(joint, static_cast<std::uint8_t>((behind ? 1 : 0) | (joint == 0 && front == 0 ? 4 : 0)));
    }
  };
  for (unsigned link = 0; link < max_joints; ++link) {
    for (const unsigned apart : {1U, 2U, 3U, 5U}) {
      if (link + apart <= max_joints) {
        kernel->reset();
        touch_pair(link, link + apart);
        test::run(*kernel, until_it_acts);
        EXPECT_EQ(kernel->setpoint(7) > 0, apart <= 2) << "links " << link << " and " << link + apart;
      }
    }
  }
}

TEST(UnevenGroundReflex, WaitsUntilTheSignHasLastedForTheTicksOfConfirm) {
  for (int confirm = 1; confirm <= 6; ++confirm) {
    for (unsigned lasts = 1; lasts <= 8; ++lasts) {
      KernelOf<robot_joints> kernel;
      configure(kernel);
      test::set_all(kernel, 0, "confirm", confirm);
      kernel.reset();
      // Three times, so that ticks that are not in a row would add up.
      for (int time = 0; time < 3; ++time) {
        touch(kernel, by_alternating_sensors(uneven));
        test::run(kernel, lasts);
        touch(kernel, by_alternating_sensors(flat));
        test::run(kernel, 2);
      }
      EXPECT_EQ(kernel.setpoint(2) > 0, static_cast<int>(lasts) >= confirm) << "confirm " << confirm << " of " << lasts;
    }
  }
}

/// The reflex in double precision, written from its help texts.
struct Model {
  double raise;      // degrees
  double rise_rate;  // degrees in a second
  double fall_rate;
  double dt;  // s
  int confirm;
  int hold;
  int in_a_row = 0;
  int since = std::numeric_limits<int>::max() / 2;  // ticks since the last sign
  double angle = 0;

  void step(bool sign) {
    in_a_row = sign ? in_a_row + 1 : 0;
    since = in_a_row >= confirm ? 0 : since + 1;
    const bool acts = since <= hold;
    const double most = (acts ? rise_rate : fall_rate) * dt;
    angle += std::clamp((acts ? raise : 0) - angle, -most, most);
  }
};

TEST(UnevenGroundReflex, FollowsItsDescriptionInDoublePrecision) {
  constexpr unsigned seed = 77;
  std::mt19937 random(seed);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int run = 0; run < 60; ++run) {
    const auto tick_us = static_cast<std::uint32_t>(1'000 + random() % 30'000);
    Model model{.raise = any(-90, 90),
                .rise_rate = any(1, 90),
                .fall_rate = any(1, 90),
                .dt = tick_us * 1e-6,
                .confirm = static_cast<int>(1 + random() % 4),
                .hold = static_cast<int>(random() % 200)};
    KernelOf<robot_joints> kernel;
    configure(kernel, tick_us);
    test::set_all(kernel, 0, "raise", test::degrees(model.raise));
    test::set_all(kernel, 0, "rise_rate", test::degrees(model.rise_rate));
    test::set_all(kernel, 0, "fall_rate", test::degrees(model.fall_rate));
    test::set_all(kernel, 0, "confirm", model.confirm);
    test::set_all(kernel, 0, "hold", model.hold);
    kernel.reset();
    unsigned touched = flat;
    unsigned seen = 0;
    for (int tick = 0; tick < 2000; ++tick) {
      // Long rests, and sequences that change at almost every tick.
      if (random() % (tick % 400 < 100 ? 2 : 150) == 0) {
        touched = random() % 2 == 0 ? static_cast<unsigned>(random() % (1U << robot_links)) : flat;
      }
      touch(kernel, by_alternating_sensors(touched));
      kernel.advance();
      model.step(is_uneven(seen, 2));
      seen = touched;
      // Each tick's step is rounded once, so the error grows by half a step of 8e-8 degrees.
      ASSERT_NEAR(offset(kernel), model.angle, 2e-4) << "seed " << seed << " run " << run << " tick " << tick;
    }
  }
}

TEST(UnevenGroundReflex, WithoutRaiseOrReachItsAngleIsAlwaysZero) {
  constexpr unsigned seed = 5;
  std::mt19937 random(seed);
  for (const char* constant : {"raise", "reach"}) {
    KernelOf<robot_joints> kernel;
    configure(kernel);
    test::set_all(kernel, 0, constant, 0);
    kernel.reset();
    for (int tick = 0; tick < 3000; ++tick) {
      touch(kernel, random() % (1U << (2 * robot_links)));
      kernel.advance();
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        ASSERT_EQ(kernel.setpoint(joint), 0) << constant << ", seed " << seed << " tick " << tick;
      }
    }
  }
}

TEST(UnevenGroundReflex, StopsAtItsAngleAndStaysThereWhileTheSensorsAreFrozen) {
  for (const double raise : {-90.0, -10.0, 10.0, 90.0}) {
    KernelOf<robot_joints> kernel;
    configure(kernel, 100'000);
    test::set_all(kernel, 0, "raise", test::degrees(raise));
    test::set_all(kernel, 0, "rise_rate", quarter_turn);
    kernel.reset();
    touch(kernel, (1U << (2 * robot_links)) - 1);
    std::int32_t before = 0;
    for (int tick = 0; tick < 10'000; ++tick) {
      kernel.advance();
      const std::int32_t now = kernel.setpoint(2);
      ASSERT_GE(std::abs(now), std::abs(before)) << "tick " << tick;
      ASSERT_LE(std::abs(now), std::abs(test::degrees(raise))) << "tick " << tick;
      before = now;
    }
    EXPECT_EQ(before, test::degrees(raise));
  }
}

TEST(UnevenGroundReflex, ReturnsToExactlyZeroOnceTheSensorsAreReleased) {
  for (const unsigned released : {0U, flat}) {
    KernelOf<robot_joints> kernel;
    configure(kernel);
    touch(kernel, by_alternating_sensors(uneven));
    test::run(kernel, 300);
    EXPECT_EQ(kernel.setpoint(2), test::degrees(10));
    touch(kernel, by_alternating_sensors(released));
    test::run(kernel, 1 + 100);
    EXPECT_EQ(kernel.setpoint(2), test::degrees(10)) << "held for the ticks of `hold`";
    test::run(kernel, 50);
    EXPECT_NEAR(offset(kernel), 0, 1e-4) << "10 degrees at 20 degrees in a second";
    test::run(kernel, 1);
    for (int tick = 0; tick < 1000; ++tick) {
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        ASSERT_EQ(kernel.setpoint(joint), 0);
      }
      kernel.advance();
    }
  }
}

TEST(UnevenGroundReflex, RaisesEachJointToItsOwnAngle) {
  KernelOf<robot_joints> kernel;
  configure(kernel);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    test::set(kernel, 0, joint, "raise", test::degrees(5.0 * joint - 10));
  }
  kernel.reset();
  touch(kernel, by_alternating_sensors(uneven));
  test::run(kernel, 100);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(kernel.setpoint(joint), test::degrees(5.0 * joint - 10));
  }
}

TEST(UnevenGroundReflex, FollowsConstantsThatChangeInFlight) {
  KernelOf<robot_joints> kernel;
  configure(kernel);
  touch(kernel, by_alternating_sensors(uneven));
  test::run(kernel, 100);
  test::commit_all(kernel, 0, "raise", test::degrees(4), 110);
  test::run(kernel, 60);
  EXPECT_EQ(kernel.setpoint(2), test::degrees(4)) << "a smaller angle is approached from above";
  touch(kernel, by_alternating_sensors(flat));
  test::commit_all(kernel, 0, "hold", 3, 170);
  test::run(kernel, 13);
  EXPECT_EQ(kernel.setpoint(2), test::degrees(4));
  test::run(kernel, 2);
  EXPECT_LT(kernel.setpoint(2), test::degrees(4)) << "a shorter hold shortens the one that runs";
}

TEST(UnevenGroundReflex, RecoversFromCountersThatCannotBe) {
  struct Counter {
    const char* name;
    std::int32_t most;
  };
  for (const Counter& counter : {Counter{"sign_ticks", 2}, Counter{"hold_ticks", 100}}) {
    for (const std::int32_t extreme :
         {std::numeric_limits<std::int32_t>::min(), -1, counter.most + 1, std::numeric_limits<std::int32_t>::max()}) {
      for (const unsigned touched : {flat, uneven}) {
        KernelOf<robot_joints> kernel;
        configure(kernel);
        touch(kernel, by_alternating_sensors(touched));
        test::run(kernel, 5);
        ASSERT_EQ(test::distort(kernel, 0, 2, test::value_index(kernel, 0, counter.name), extreme), Status::ok);
        test::run(kernel, 1);
        EXPECT_GE(test::value(kernel, 0, 2, counter.name), 0) << counter.name << " = " << extreme;
        EXPECT_LE(test::value(kernel, 0, 2, counter.name), counter.most) << counter.name << " = " << extreme;
        test::run(kernel, 200);
        EXPECT_EQ(kernel.setpoint(2), touched == uneven ? test::degrees(10) : 0) << counter.name << " = " << extreme;
      }
    }
  }
}

TEST(UnevenGroundReflex, LeavesTheGaitOfAnotherSlotAsItIsWhileTheGroundIsFlat) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::sinusoidal), robot_joints);
  KernelOf<robot_joints> plain;
  ASSERT_EQ(plain.configure(configuration, 0), Status::ok);
  configuration.slots[1] = {&test::algorithm(test::reflex), JointMask::first(robot_joints)};
  KernelOf<robot_joints> kernel;
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  for (unsigned tick = 0; tick < 500; ++tick) {
    if (tick == 300) {
      touch(kernel, by_alternating_sensors(uneven));
    }
    plain.advance();
    kernel.advance();
    const double raised = std::clamp((static_cast<int>(tick) - 301) * 0.6, 0.0, 10.0);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_NEAR(test::in_degrees(kernel.setpoint(joint) - plain.setpoint(joint)), raised, tick < 302 ? 0.0 : 1e-5)
          << "tick " << tick;
      ASSERT_EQ(kernel.channel_count(joint), 1U) << "it has nothing to say to its neighbours";
      ASSERT_EQ(unpack(test::algorithm(test::sinusoidal).declaration(), 0, kernel.frame(joint, 0)),
                unpack(test::algorithm(test::sinusoidal).declaration(), 0, plain.frame(joint, 0)));
    }
  }
}

}  // namespace
}  // namespace proleg
