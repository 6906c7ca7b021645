#include "shared/computer/master/setup_list.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "device_memory.hpp"
#include "robot.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/sdo_server.hpp"
#include "shared/fixed/random.hpp"
#include "tests/support/number_transfer.hpp"

namespace proleg::canopen {
namespace {

/// A setup with the memory for its spans.
struct Robot {
  explicit Robot(unsigned joints, std::uint8_t first_node = 10) : limits(joints, AngleLimits{-(1 << 30), 1 << 30}) {
    for (unsigned i = 0; i < joints; ++i) {
      nodes.push_back(static_cast<std::uint8_t>(first_node + joints - i));
    }
    setup.kernel.joint_count = static_cast<std::uint8_t>(joints);
  }

  [[nodiscard]] const RobotSetup& with_spans() {
    setup.nodes = nodes;
    setup.limits = limits;
    setup.start_values = start_values;
    return setup;
  }
  [[nodiscard]] std::vector<SdoRequest> writes(unsigned joint) {
    const SetupList list(with_spans(), joint);
    std::vector<SdoRequest> result;
    for (std::size_t i = 0; i < list.size(); ++i) {
      result.push_back(list.at(i));
    }
    return result;
  }

  RobotSetup setup;
  std::vector<std::uint8_t> nodes;
  std::vector<AngleLimits> limits;
  std::vector<Setting> start_values;
};

KernelConfiguration random_configuration(Pcg32& random, unsigned joints) {
  KernelConfiguration configuration;
  configuration.joint_count = static_cast<std::uint8_t>(joints);
  configuration.tick_period_us = 1'000 + random.next() % 99'001;
  configuration.seed = std::uint64_t{random.next()} << 32U | random.next();
  for (Slot& slot : configuration.slots) {
    if (random.next() % 4 != 0) {
      slot.algorithm = &algorithm_at(random.next() % algorithm_count());
    }
    slot.group = JointMask((std::uint64_t{random.next()} << 32U | random.next()) & JointMask::first(joints).bits());
  }
  return configuration;
}

TEST(SetupList, WritesInTheOrderOfTheProtocol) {
  Robot robot(3);
  robot.nodes = {21, 22, 23};
  robot.setup.robot_id = 9;
  robot.setup.servo_period_us = 3'000;
  robot.setup.command_speed = 300;
  robot.setup.kernel.tick_period_us = 5'000;
  robot.setup.kernel.seed = 0x1122334455667788;
  robot.setup.kernel.slots[0] = {&test::algorithm(test::coupled), JointMask(0b111)};
  robot.setup.kernel.slots[2] = {&test::algorithm(test::sinusoidal), JointMask(0b110)};  // second frames of 1 and 2
  robot.limits[1] = {-5, 6};
  robot.start_values = {{2, 1, 0, false, 77}, {0, 1, 3, false, -8}, {0, 0, 0, false, 5}};
  const std::vector<SdoRequest> expected{
      {{0x1016, 1}, 4, 127U << 16U | 450U},
      {{0x1017, 0}, 2, 100},
      {{0x1006, 0}, 4, 5'000},
      {{0x1019, 0}, 1, 128},
      {{0x2001, 1}, 1, 1},
      {{0x2001, 2}, 1, 3},
      {{0x2001, 3}, 1, 21},
      {{0x2001, 4}, 1, 23},
      {{0x2001, 5}, 2, 9},
      {{0x2005, 1}, 4, 0x55667788},
      {{0x2005, 2}, 4, 0x11223344},
      {{0x2005, 3}, 4, 3'000},
      {{0x6080, 0}, 4, 300},
      {{0x2006, 1}, 1, 4},
      {{0x2007, 1}, 4, 0b111},
      {{0x2008, 1}, 4, 0},
      {{0x2006, 2}, 1, 0},
      {{0x2007, 2}, 4, 0},
      {{0x2008, 2}, 4, 0},
      {{0x2006, 3}, 1, 2},
      {{0x2007, 3}, 4, 0b110},
      {{0x2008, 3}, 4, 0},
      {{0x2006, 4}, 1, 0},
      {{0x2007, 4}, 4, 0},
      {{0x2008, 4}, 4, 0},
      {{0x1410, 1}, 4, 0x180 + 21},
      {{0x1412, 1}, 4, 0x180 + 23},
      {{0x1452, 1}, 4, 0x280 + 23},
      {{0x2005, 6}, 1, 1},
      {{0x2005, 4}, 4, static_cast<std::uint32_t>(-5)},
      {{0x2005, 5}, 4, 6},
      {{0x3083, 1}, 4, static_cast<std::uint32_t>(-8)},
      {{0x3040, 3}, 4, 77},
  };
  const std::vector<SdoRequest> writes = robot.writes(1);
  ASSERT_EQ(writes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(writes[i], expected[i]) << "write " << i << ": " << std::hex << writes[i].address.index << ":"
                                      << unsigned{writes[i].address.sub} << " = " << writes[i].value;
  }
}

TEST(SetupList, TheEndsOfTheRobotHaveOneNeighbour) {
  Robot robot(2);
  robot.nodes = {4, 5};
  const auto value = [&](unsigned joint, Address address) {
    for (const SdoRequest& write : robot.writes(joint)) {
      if (write.address == address) {
        return static_cast<int>(write.value);
      }
    }
    return -1;
  };
  EXPECT_EQ(value(0, {0x2001, 3}), 0);
  EXPECT_EQ(value(0, {0x2001, 4}), 5);
  EXPECT_EQ(value(1, {0x2001, 3}), 4);
  EXPECT_EQ(value(1, {0x2001, 4}), 0);
  EXPECT_EQ(value(0, {0x1410, 1}), -1) << "its own frame";
  EXPECT_EQ(value(1, {0x1411, 1}), -1);
}

TEST(SetupList, SendsTheLastOfRepeatedStartValuesAndNoDefaults) {
  Robot robot(2);
  robot.setup.kernel.slots[0] = {&test::algorithm(test::coupled), JointMask(0b01)};
  const std::int32_t usual = test::algorithm(test::coupled).declaration().parameters[0].default_value;
  const std::size_t without = robot.writes(0).size();
  robot.start_values = {{0, 0, 0, false, 1}, {0, 0, 1, false, 2}, {0, 0, 0, false, 3}};
  EXPECT_EQ(robot.writes(0).size(), without + 2);
  EXPECT_EQ(robot.writes(0)[without], (SdoRequest{{0x3080, 1}, 4, 3}));
  EXPECT_EQ(robot.writes(0)[without + 1], (SdoRequest{{0x3081, 1}, 4, 2}));
  robot.start_values = {{0, 0, 0, false, 1}, {0, 0, 0, false, usual}};
  EXPECT_EQ(robot.writes(0).size(), without);
}

TEST(SetupList, LeavesOutStartValuesWithoutAParameter) {
  Robot robot(2);
  robot.setup.kernel.slots[0] = {&test::algorithm(test::coupled), JointMask(0b01)};
  const std::size_t without = robot.writes(0).size();
  robot.start_values = {
      {0, 1, 0, false, 1},    // a joint that the slot does not drive
      {1, 0, 0, false, 1},    // an empty slot
      {4, 0, 0, false, 1},    // no slot
      {255, 0, 0, false, 1},  //
      {0, 0, 7, false, 1},    // no parameter
      {0, 0, 255, false, 1},  //
      {0, 64, 0, false, 1},   // no joint
  };
  EXPECT_EQ(robot.writes(0).size(), without);
  EXPECT_EQ(robot.writes(1).size(), without);
}

TEST(SetupList, IsEmptyWithoutJointNodesOrLimits) {
  Robot robot(3);
  EXPECT_FALSE(robot.writes(2).empty());
  EXPECT_TRUE(robot.writes(3).empty());
  robot.nodes.pop_back();
  EXPECT_TRUE(robot.writes(0).empty());
  robot = Robot(3);
  robot.limits.pop_back();
  EXPECT_TRUE(robot.writes(0).empty());
  robot = Robot(65);
  EXPECT_TRUE(robot.writes(0).empty());
}

/// The configuration as it is in the objects of a module.
RobotConfiguration read_back(const test::DeviceMemory& device, std::uint8_t own_node,
                             std::vector<std::uint8_t>& nodes) {
  RobotConfiguration setup;
  const auto value = [&](Address address) { return device.value(address); };
  setup.kernel.joint_count = static_cast<std::uint8_t>(value(object::joint_count.address));
  setup.kernel.tick_period_us = value(object::tick_period.address);
  setup.kernel.seed = std::uint64_t{value(object::seed_high.address)} << 32U | value(object::seed_low.address);
  setup.robot_id = static_cast<std::uint16_t>(value(object::robot_id.address));
  setup.servo_period_us = value(object::servo_period.address);
  for (unsigned i = 0; i < max_slots; ++i) {
    setup.kernel.slots[i] = {find_algorithm(static_cast<std::uint8_t>(value(object::slot_algorithm.address(i)))),
                             JointMask(std::uint64_t{value(object::slot_group_high.address(i))} << 32U |
                                       value(object::slot_group_low.address(i)))};
  }
  for (unsigned joint = 0; joint < setup.kernel.joint_count; ++joint) {
    nodes.push_back(joint == value(object::joint_index.address)
                        ? own_node
                        : static_cast<std::uint8_t>(value(object::state_frame_identifier[0].address(joint)) - 0x180));
  }
  setup.nodes = nodes;
  return setup;
}

TEST(SetupList, GivesAModuleTheWholeConfiguration) {
  constexpr std::uint32_t seed = 8;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Pcg32 random(seed, 0);
  for (int run = 0; run < 60; ++run) {
    const unsigned joints = 1 + random.next() % max_joints;
    Robot robot(joints, static_cast<std::uint8_t>(random.next() % (126 - joints)));
    robot.setup.kernel = random_configuration(random, joints);
    robot.setup.robot_id = static_cast<std::uint16_t>(random.next());
    robot.setup.servo_period_us = 100 + random.next() % 99'901;
    for (AngleLimits& limit : robot.limits) {
      limit = {-static_cast<std::int32_t>(random.next() % (1U << 30U)),
               static_cast<std::int32_t>(random.next() % (1U << 30U))};
    }
    for (int i = 0; i < 200; ++i) {
      const auto slot = static_cast<std::uint8_t>(random.next() % max_slots);
      const ActuationModule* algorithm = robot.setup.kernel.slots[slot].algorithm;
      if (algorithm != nullptr) {
        const auto number = static_cast<std::uint8_t>(random.next() % algorithm->declaration().parameters.size());
        const Parameter& parameter = algorithm->declaration().parameters[number];
        robot.start_values.push_back({slot, static_cast<std::uint8_t>(random.next() % joints), number, false,
                                      random.next() % 2 == 0 ? parameter.minimum : parameter.maximum});
      }
    }
    const unsigned joint = random.next() % joints;
    test::DeviceMemory device;
    test::NumberTransfer client;
    for (const SdoRequest& write : robot.writes(joint)) {
      const std::uint8_t node = robot.nodes[joint];
      const std::optional<CanFrame> answer =
          SdoServer(node, device).receive(0, client.write(0, node, write.address, write.size, write.value));
      ASSERT_TRUE(answer && client.receive(*answer));
      ASSERT_EQ(client.state(), test::NumberTransfer::State::done)
          << describe(client.abort_code()) << " at " << std::hex << write.address.index << ":"
          << unsigned{write.address.sub};
    }
    std::vector<std::uint8_t> nodes;
    EXPECT_EQ(configuration_crc(read_back(device, robot.nodes[joint], nodes)), configuration_crc(robot.with_spans()));
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      const Slot& configured = robot.setup.kernel.slots[slot];
      if (configured.algorithm == nullptr || !configured.group.contains(joint)) {
        continue;
      }
      const Declaration& declaration = configured.algorithm->declaration();
      for (std::uint8_t number = 0; number < declaration.parameters.size(); ++number) {
        std::int32_t wanted = declaration.parameters[number].default_value;
        for (const Setting& start : robot.start_values) {
          if (start.slot == slot && start.joint == joint && start.number == number) {
            wanted = start.value;
          }
        }
        const Address address =
            address_of({ValueKind::parameter, declaration.id, number, static_cast<std::uint8_t>(slot)});
        EXPECT_EQ(static_cast<std::int32_t>(device.value(address)), wanted);
      }
    }
    EXPECT_EQ(static_cast<std::int32_t>(device.value(object::lower_limit.address)), robot.limits[joint].lower);
    EXPECT_EQ(static_cast<std::int32_t>(device.value(object::upper_limit.address)), robot.limits[joint].upper);
  }
}

}  // namespace
}  // namespace proleg::canopen
