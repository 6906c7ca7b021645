#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "robot.hpp"

namespace proleg {
namespace {

using test::robot_joints;
using test::robot_links;
using Links = std::array<bool, robot_links>;  // whether each link touches, head first

Links links_of(unsigned pattern) {
  Links links{};
  for (unsigned link = 0; link < robot_links; ++link) {
    links[link] = ((pattern >> link) & 1U) != 0;
  }
  return links;
}

void touch(Kernel& kernel, const Links& links) {
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    const unsigned bits = (links[joint + 1] ? 1U : 0U) | (joint == 0 && links[0] ? 8U : 0U);
    kernel.set_contacts(joint, static_cast<std::uint8_t>(bits));
  }
}

std::string constant(unsigned number) { return "constant_" + std::to_string(number); }

void configure(Kernel& kernel, std::uint32_t tick_us = 10'000) {
  ASSERT_EQ(kernel.configure(test::one_slot(test::algorithm(test::adaptive_touch), robot_joints, tick_us), 0),
            Status::ok);
}

double offset(const Kernel& kernel, unsigned joint) {
  return test::in_degrees(test::value(kernel, 0, joint, "offset"));
}

/// The direction in which a stuck joint bends, by the text of the documentation: 1 is up. `gait` decides if there is no
/// difference.
int direction(const Links& links, unsigned joint, double gait) {
  const int inner = int{links[joint]} + int{links[joint + 1]};
  const bool has_first = joint > 0;
  const bool has_last = joint + 2 < robot_links;
  const int first = has_first ? int{links[joint - 1]} : int{links[joint + 2]};
  const int last = has_last ? int{links[joint + 2]} : int{links[joint - 1]};
  if (first + last != inner) {
    return first + last > inner ? 1 : -1;
  }
  return gait < 0 ? -1 : 1;
}

/// Number of the constant for a joint, 1 to 8.
unsigned constant_of(const Links& links, unsigned joint, int direction) {
  const unsigned touch_state = (links[joint] ? 2U : 0U) + (links[joint + 1] ? 1U : 0U);
  return touch_state + (direction > 0 ? 1 : 5);
}

/// The algorithm of one joint in double precision.
struct Model {
  unsigned joint;
  double threshold_ms, recovering, max_offset, give_up_ms, tick_ms;
  std::array<double, 9> constants;
  double angle = 0;
  std::array<bool, 4> before{};
  int still = 0;

  void step(const Links& links, double gait) {
    std::array<bool, 4> around{};
    for (unsigned place = 0; place < 4; ++place) {
      const int link = static_cast<int>(joint + place) - 1;
      around[place] = link >= 0 && link < static_cast<int>(robot_links) && links[static_cast<unsigned>(link)];
    }
    still = around == before ? still + 1 : 0;
    before = around;
    const bool touches = std::ranges::count(links, true) > 0;
    const bool stuck =
        touches && still >= std::lround(threshold_ms / tick_ms) && still < std::lround(give_up_ms / tick_ms);
    double target = 0;
    double most = recovering;
    if (stuck) {
      const int side = direction(links, joint, gait);
      target = side * max_offset;
      most = constants[constant_of(links, joint, side)];
    }
    most *= tick_ms / 10;
    angle += std::clamp(target - angle, -most, most);
  }
};

TEST(GlobalAdaptiveTouch, FollowsItsDescriptionInDoublePrecision) {
  constexpr unsigned seed = 414;
  std::mt19937 random(seed);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int run = 0; run < 60; ++run) {
    const std::uint32_t tick_us = 1'000 * (1 + static_cast<unsigned>(random() % 20));
    std::array<Model, robot_joints> models;
    KernelOf<robot_joints> kernel;
    configure(kernel, tick_us);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      Model& model = models[joint];
      model.joint = joint;
      model.tick_ms = tick_us * 1e-3;
      // The time is whole ticks: the documentation does not define the rounding.
      model.threshold_ms = std::ceil(any(1, 30)) * model.tick_ms;
      model.give_up_ms = std::ceil(any(50, 300)) * model.tick_ms;
      model.recovering = any(0, 2);
      model.max_offset = any(0, 80);
      test::set(kernel, 0, joint, "stuck_threshold", static_cast<std::int32_t>(std::lround(model.threshold_ms)));
      test::set(kernel, 0, joint, "give_up", static_cast<std::int32_t>(std::lround(model.give_up_ms)));
      test::set(kernel, 0, joint, "recovering", test::degrees(model.recovering));
      test::set(kernel, 0, joint, "max_offset", test::degrees(model.max_offset));
      for (unsigned number = 1; number <= 8; ++number) {
        model.constants[number] = any(0, 2);
        test::set(kernel, 0, joint, constant(number), test::degrees(model.constants[number]));
      }
    }
    kernel.reset();
    Links touched{};
    Links seen{};
    for (int tick = 0; tick < 2'000; ++tick) {
      if (random() % (tick % 700 < 100 ? 3 : 60) == 0) {
        touched = links_of(static_cast<unsigned>(random() % (1U << robot_links)));
      }
      touch(kernel, touched);
      kernel.advance();
      for (unsigned joint = 0; joint < robot_joints; ++joint) {
        models[joint].step(seen, 0);
        ASSERT_NEAR(offset(kernel, joint), models[joint].angle, 2e-4)
            << "seed " << seed << " run " << run << " tick " << tick << " joint " << joint;
      }
      seen = touched;
    }
  }
}

TEST(GlobalAdaptiveTouch, BendsEachStuckJointByTheConstantOfItsTouchInEachOfAllPatterns) {
  for (unsigned pattern = 1; pattern < 1U << robot_links; ++pattern) {
    const Links links = links_of(pattern);
    KernelOf<robot_joints> kernel;
    configure(kernel);
    for (unsigned number = 1; number <= 8; ++number) {
      test::set_all(kernel, 0, constant(number), test::degrees(0.1 * number));
    }
    kernel.reset();
    touch(kernel, links);
    test::run(kernel, 100);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      const double before = offset(kernel, joint);
      kernel.advance();
      const int side = direction(links, joint, 0);
      const double expected = side * 0.1 * constant_of(links, joint, side);
      if (std::abs(before + expected) <= 45) {
        ASSERT_NEAR(offset(kernel, joint) - before, expected, 1e-5) << "links " << pattern << " joint " << joint;
      } else {
        ASSERT_NEAR(offset(kernel, joint), side * 45, 1e-5) << "links " << pattern << " joint " << joint;
      }
      kernel.reset();
      touch(kernel, links);
      test::run(kernel, 100);
    }
  }
}

TEST(GlobalAdaptiveTouch, BendsFurtherToTheSideOfTheGaitWhereTheTouchIsTheSameEverywhere) {
  for (const double angle : {-20.0, 20.0}) {
    KernelConfiguration configuration = test::one_slot(test::algorithm(test::adaptive_touch), robot_joints);
    configuration.slots[1] = {&test::algorithm(test::direct), JointMask::first(robot_joints)};
    KernelOf<robot_joints> kernel;
    ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
    test::set_all(kernel, 1, "angle", test::degrees(angle));
    kernel.reset();
    touch(kernel, links_of(0b111111));
    test::run(kernel, 200);
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      EXPECT_NEAR(offset(kernel, joint), angle > 0 ? 45 : -45, 1e-5) << "joint " << joint;
    }
  }
}

TEST(GlobalAdaptiveTouch, WithoutConstantsLeavesTheGaitAsItIs) {
  constexpr unsigned seed = 9;
  std::mt19937 random(seed);
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::sinusoidal), robot_joints);
  KernelOf<robot_joints> plain;
  ASSERT_EQ(plain.configure(configuration, 0), Status::ok);
  configuration.slots[1] = {&test::algorithm(test::adaptive_touch), JointMask::first(robot_joints)};
  KernelOf<robot_joints> kernel;
  ASSERT_EQ(kernel.configure(configuration, 0), Status::ok);
  for (unsigned number = 1; number <= 8; ++number) {
    test::set_all(kernel, 1, constant(number), 0);
  }
  kernel.reset();
  for (int tick = 0; tick < 5'000; ++tick) {
    if (random() % 50 == 0) {
      touch(kernel, links_of(static_cast<unsigned>(random() % (1U << robot_links))));
    }
    plain.advance();
    kernel.advance();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(kernel.setpoint(joint), plain.setpoint(joint)) << "seed " << seed << " tick " << tick;
    }
  }
}

TEST(GlobalAdaptiveTouch, LeavesTheGaitAsItIsWhileTheTouchAroundEachJointChangesOftenEnough) {
  KernelOf<robot_joints> kernel;
  configure(kernel);
  for (int tick = 0; tick < 3'000; ++tick) {
    // A wave of touch: every joint has a change in 140 ms.
    touch(kernel, links_of((tick / 14) % 2 == 0 ? 0b001001 : 0b010010));
    kernel.advance();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(kernel.setpoint(joint), 0) << "tick " << tick;
    }
  }
}

TEST(GlobalAdaptiveTouch, IsTheMirrorImageOnARobotThatIsTurnedRound) {
  constexpr unsigned seed = 31;
  std::mt19937 random(seed);
  KernelOf<robot_joints> one;
  KernelOf<robot_joints> other;
  configure(one);
  configure(other);
  constexpr std::array<unsigned, 9> turned{0, 1, 3, 2, 4, 5, 7, 6, 8};
  for (unsigned number = 1; number <= 8; ++number) {
    test::set_all(one, 0, constant(number), test::degrees(0.05 * number));
    test::set_all(other, 0, constant(turned[number]), test::degrees(0.05 * number));
  }
  one.reset();
  other.reset();
  for (int tick = 0; tick < 5'000; ++tick) {
    if (random() % 40 == 0) {
      Links links = links_of(static_cast<unsigned>(random() % (1U << robot_links)));
      touch(one, links);
      std::ranges::reverse(links);
      touch(other, links);
    }
    one.advance();
    other.advance();
    for (unsigned joint = 0; joint < robot_joints; ++joint) {
      ASSERT_EQ(one.setpoint(joint), other.setpoint(robot_joints - 1 - joint)) << "seed " << seed << " tick " << tick;
    }
  }
}

TEST(GlobalAdaptiveTouch, HoldsItsGreatestOffsetWhileTheSensorsAreFrozenAndGivesUpAfterTheTimeOfItsParameter) {
  KernelOf<robot_joints> kernel;
  configure(kernel);
  touch(kernel, links_of(0b000100));
  test::run(kernel, 900);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_NEAR(std::abs(offset(kernel, joint)), 45, 1e-5) << "joint " << joint;
  }
  test::run(kernel, 103 + 150);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(kernel.setpoint(joint), 0) << "45 degrees at 0.3 degrees in 10 ms take 150 ticks; joint " << joint;
  }
}

TEST(GlobalAdaptiveTouch, DoesNothingWhereNothingTouches) {
  KernelOf<robot_joints> kernel;
  configure(kernel);
  test::run(kernel, 3'000);
  for (unsigned joint = 0; joint < robot_joints; ++joint) {
    EXPECT_EQ(kernel.setpoint(joint), 0);
  }
}

}  // namespace
}  // namespace proleg
