// The record of the last tick is the joint's kernel, and there is one only while the kernel has computed a tick.

#include <random>

#include "test_robot.hpp"

namespace proleg {
namespace {

using firmware::TickRecord;

constexpr unsigned gait_joints = 6;

/// Up to four algorithms on groups of joints; at most two of a joint broadcast.
KernelConfiguration random_gait(std::mt19937& random) {
  KernelConfiguration configuration;
  configuration.joint_count = gait_joints;
  configuration.seed = random();
  for (Slot& slot : configuration.slots) {
    const ActuationModule& algorithm = algorithm_at(random() % algorithm_count());
    const JointMask group(random() % (1U << gait_joints));
    if (random() % 4 == 0 || group.bits() == 0) {
      continue;
    }
    slot = {&algorithm, group};
    KernelOf<gait_joints> kernel;
    if (kernel.configure(configuration, 0) != Status::ok) {
      slot = {};
    }
  }
  return configuration;
}

/// Whether the kernel has just computed this tick, and has a state.
bool kernel_has_computed(const Kernel& kernel, unsigned joint, std::uint32_t tick) {
  return kernel.is_local(joint) && kernel.tick() == tick + 1 &&
         (kernel.frame(joint, 0).flags() & StateFrame::valid) != 0;
}

void expect_the_kernel(const TickRecord& record, const Kernel& kernel, unsigned joint) {
  for (std::uint32_t back = 0; back < 4; ++back) {
    const std::uint32_t tick = kernel.tick() + 1 - back;
    if (tick != TickRecord::none) {
      ASSERT_EQ(record.tick == tick && record.joint == joint, kernel_has_computed(kernel, joint, tick))
          << "joint " << joint << " tick " << tick;
    }
  }
  if (record.tick == TickRecord::none) {
    return;
  }
  ASSERT_EQ(record.setpoint, kernel.setpoint(joint));
  ASSERT_EQ(record.flags, kernel.frame(joint, 0).flags());
  std::vector<std::int32_t> values;
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    for (unsigned number = 0;
         kernel.drives(slot, joint) &&
         number < kernel.configuration().slots[slot].algorithm->declaration().internal_values.size();
         ++number) {
      values.push_back(kernel.internal_value(slot, joint, number));
    }
  }
  ASSERT_EQ(std::vector(record.internal_values.begin(), record.internal_values.begin() + record.value_count), values);
}

TEST(TickRecords, AreTheKernelsForAnyGait) {
  constexpr std::uint32_t seed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::size_t max_values = 0;
  for (int run = 0; run < 40; ++run) {
    test::TestRobot robot(random_gait(random));
    for (unsigned joint = 0; joint < gait_joints; ++joint) {
      EXPECT_EQ(robot.module(joint).last_tick().tick, TickRecord::none);
    }
    robot.drive();
    for (int i = 0; i < 30; ++i) {
      for (unsigned joint = 0; joint < gait_joints; ++joint) {
        robot.at(joint).sensors = static_cast<std::uint8_t>(random());
      }
      robot.run_syncs(1);
      for (unsigned joint = 0; joint < gait_joints; ++joint) {
        const TickRecord& record = robot.module(joint).last_tick();
        ASSERT_NO_FATAL_FAILURE(expect_the_kernel(record, robot.kernel(joint), joint));
        ASSERT_EQ(record.tick + 1, robot.kernel(joint).tick());
        max_values = std::max<std::size_t>(max_values, record.value_count);
      }
    }
  }
  EXPECT_GT(max_values, 12U) << "more than one algorithm on a joint";
}

TEST(TickRecords, FollowTheKernelThroughStopsLossesAndRestarts) {
  constexpr std::uint32_t seed = 4;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  test::TestModule robot;
  const auto check = [&] { expect_the_kernel(robot.module().last_tick(), robot.kernel(), 0); };
  robot.set_up_and_start();
  std::uint32_t next = 0;
  unsigned recorded = 0;
  for (int i = 0; i < 2'000; ++i) {
    switch (random() % 16) {
      case 0:
        robot.tick(next = 0);
        break;
      case 1:
        robot.tick(next);
        break;
      case 2:
        next += static_cast<std::uint32_t>(random() % 12);  // SYNCs that are not received
        break;
      case 3:
        robot.command(canopen::NmtCommand::enter_pre_operational);
        EXPECT_EQ(robot.module().last_tick().tick, TickRecord::none);
        break;
      case 4:
        robot.command(canopen::NmtCommand::start);
        break;
      default:
        robot.sync(next++);
        break;
    }
    ASSERT_NO_FATAL_FAILURE(check());
    recorded += robot.module().last_tick().tick != TickRecord::none ? 1U : 0U;
  }
  EXPECT_GT(recorded, 100U);
}

TEST(TickRecords, HaveTheCurrentThatWasReadAfterTheSyncBefore) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.run(9);
  robot.it().meters.readings.current_ma = 777;
  robot.sync(10);
  EXPECT_NE(robot.module().last_tick().current_ma, 777U) << "it is read after the tick was computed";
  robot.sync(11);
  EXPECT_EQ(robot.module().last_tick().current_ma, 777U);
}

TEST(TickRecords, EndWithAReset) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.run(20);
  ASSERT_EQ(robot.module().last_tick().tick, 20U);
  robot.command(canopen::NmtCommand::reset_node);
  EXPECT_EQ(robot.module().last_tick().tick, TickRecord::none);
}

}  // namespace
}  // namespace proleg
