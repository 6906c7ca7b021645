// State frames of the neighbours: the nodes that send them, and the frames that are rejected.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::Emergency;
using canopen::EmergencyCode;
using test::node;
constexpr std::uint8_t neighbour = 1;  ///< the node of joint 1
constexpr std::uint16_t neighbour_frame = canopen::identifier::state_frame + neighbour;

class StateFrames : public testing::Test {
 protected:
  StateFrames() {
    robot.set_up_and_start();
    robot.run(20);
  }
  void receive(std::uint16_t identifier, std::uint8_t label, std::uint8_t length = 8) {
    robot.bus.deliver({identifier, length, {1, 2, 3, 4, 5, 6, StateFrame::valid, label}});
    robot.bus.run_for(500);
  }
  [[nodiscard]] const StateFrame& frame_of(unsigned joint, unsigned channel = 0) {
    return robot.kernel().frame(joint, channel);
  }
  static bool holds(const StateFrame& frame) { return frame.bytes[0] == 1 && frame.bytes[5] == 6; }

  static KernelConfiguration configuration() {
    KernelConfiguration made = test::one_slot(test::algorithm(test::sinusoidal), 5);
    made.slots[1] = {&test::algorithm(test::extended), JointMask(0b00011)};
    made.slots[2] = {&test::algorithm(test::reflex), JointMask(0b00001)};  // depends on the contacts of all joints
    return made;
  }

  test::TestModule robot{configuration()};
};

TEST_F(StateFrames, AreReceivedFromTheNodeOfTheJoint) {
  receive(neighbour_frame, 21);
  EXPECT_TRUE(holds(frame_of(1)));
  EXPECT_FALSE(holds(frame_of(1, 1)));
  receive(canopen::identifier::second_state + neighbour, 21);
  EXPECT_TRUE(holds(frame_of(1, 1)));
  receive(canopen::identifier::state_frame + 12, 21);
  EXPECT_TRUE(holds(frame_of(4)));
}

TEST_F(StateFrames, OfAnUnknownNodeAreIgnored) {
  receive(canopen::identifier::state_frame + 100, 21);
  receive(canopen::identifier::state_frame + 100, 21, 3);
  receive(canopen::identifier::second_state + 9, 21);  // joint 2 has one channel
  for (unsigned joint = 1; joint < 5; ++joint) {
    EXPECT_FALSE(holds(frame_of(joint)));
  }
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(StateFrames, OfANeighbouringTickAreNotUsed) {
  receive(neighbour_frame, 20);
  receive(neighbour_frame, 22);
  EXPECT_FALSE(holds(frame_of(1)));
  EXPECT_TRUE(robot.emergencies().empty()) << "a module may be just before or just behind";
  EXPECT_EQ(robot.module().unknown_labels(), 0U);
}

TEST_F(StateFrames, WithALabelThatFitsNoTickAreCountedAndReportedOnceAJoint) {
  for (const unsigned label : {23U, 19U, 100U, 255U, 23U}) {
    receive(neighbour_frame, static_cast<std::uint8_t>(label));
  }
  receive(canopen::identifier::state_frame + 9, 0);
  EXPECT_FALSE(holds(frame_of(1)));
  EXPECT_EQ(robot.module().unknown_labels(), 6U);
  const auto emergencies = robot.emergencies();
  ASSERT_EQ(emergencies.size(), 2U);
  EXPECT_EQ(emergencies[0], (Emergency{node, EmergencyCode::unknown_label, 0, 1}));
  EXPECT_EQ(emergencies[1], (Emergency{node, EmergencyCode::unknown_label, 0, 2}));
}

TEST_F(StateFrames, WithUnknownLabelsAreNoFaultWhileTheModuleKnowsNoTick) {
  robot.sync(100);
  robot.bus.run_for(500);
  const std::size_t before = robot.emergencies().size();
  receive(neighbour_frame, 101);
  EXPECT_EQ(robot.emergencies().size(), before);
}

TEST_F(StateFrames, OfWrongLengthAreReportedOnceAJoint) {
  for (const std::uint8_t length : std::to_array<std::uint8_t>({0, 3, 7})) {
    receive(neighbour_frame, 21, length);
    receive(canopen::identifier::second_state + neighbour, 21, length);
    receive(canopen::identifier::state_frame + 3, 21, length);
  }
  EXPECT_FALSE(holds(frame_of(1)));
  const auto emergencies = robot.emergencies();
  ASSERT_EQ(emergencies.size(), 2U);
  EXPECT_EQ(emergencies[0], (Emergency{node, EmergencyCode::wrong_length, 0, 1}));
  EXPECT_EQ(emergencies[1], (Emergency{node, EmergencyCode::wrong_length, 0, 3}));
}

TEST_F(StateFrames, AreReportedAgainAfterANewStart) {
  receive(neighbour_frame, 21, 3);
  receive(neighbour_frame, 99);
  robot.command(canopen::NmtCommand::enter_pre_operational);
  robot.start();
  EXPECT_EQ(robot.module().unknown_labels(), 0U);
  robot.run(20);
  receive(neighbour_frame, 21, 3);
  receive(neighbour_frame, 99);
  EXPECT_EQ(robot.emergencies().size(), 4U);
}

TEST_F(StateFrames, OfTheOwnJointAreNotReceived) {
  robot.command(canopen::NmtCommand::enter_pre_operational);
  for (const std::uint32_t sender : {77U, std::uint32_t{node}}) {
    ASSERT_EQ(robot.bus.write(node, canopen::object::state_frame_identifier[0].address(0), 4,
                              canopen::identifier::state_frame + sender),
              canopen::AbortCode::none);
    ASSERT_EQ(robot.bus.write(node, canopen::object::activate, 1), canopen::AbortCode::none);
  }
  robot.start();
  robot.run(20);
  receive(canopen::identifier::state_frame + 77, 21, 3);
  EXPECT_TRUE(robot.emergencies().empty());
}

/// The identifiers that the module asks the controller to pass, with these slots.
std::vector<std::uint16_t> listened_to(const KernelConfiguration& configuration) {
  test::TestModule robot(configuration);
  robot.set_up_and_start();
  return robot.it().listened;
}

TEST(Listening, IsToTheNextJointsOfEachSlotOnTheirChannels) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), 5);
  EXPECT_EQ(listened_to(configuration), std::vector<std::uint16_t>{0x181}) << "joint 1 is node 1";
  configuration.slots[1] = {&test::algorithm(test::extended), JointMask(0b10001)};
  EXPECT_EQ(listened_to(configuration), (std::vector<std::uint16_t>{0x181, 0x28C})) << "joint 4 is node 12";
  configuration.slots[0].group = JointMask(0b11110);
  configuration.slots[1].group = JointMask(0b00100);
  EXPECT_EQ(listened_to(configuration), std::vector<std::uint16_t>{}) << "no slot drives the joint";
}

TEST(Listening, IsToAllJointsIfASlotSensesContacts) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::reflex), 5);
  configuration.slots[0].group = JointMask(0b00001);
  EXPECT_EQ(listened_to(configuration), (std::vector<std::uint16_t>{0x181, 0x189, 0x183, 0x18C}));
}

TEST(Listening, EndsWithTheConfiguration) {
  test::TestModule robot(test::one_slot(test::algorithm(test::coupled), 5));
  robot.set_up_and_start();
  EXPECT_EQ(robot.it().listened.size(), 1U);
  robot.command(canopen::NmtCommand::reset_node);
  EXPECT_TRUE(robot.it().listened.empty());
}

TEST(Listening, IgnoresOtherFramesAlsoIfTheControllerDoesNotFilter) {
  test::TestModule robot(test::one_slot(test::algorithm(test::coupled), 5));
  robot.set_up_and_start();
  robot.run(20);
  robot.bus.deliver({canopen::identifier::state_frame + 12, 3, {1, 2, 3}});
  robot.bus.deliver({canopen::identifier::state_frame + 12, 8, {1, 2, 3, 4, 5, 6, StateFrame::valid, 99}});
  EXPECT_TRUE(robot.emergencies().empty());
  EXPECT_EQ(robot.module().unknown_labels(), 0U);
}

TEST_F(StateFrames, ThatHoldNoStateAreNotUsed) {
  robot.bus.deliver({neighbour_frame, 8, {1, 2, 3, 4, 5, 6, 0, 21}});
  EXPECT_FALSE(holds(frame_of(1)));
  EXPECT_TRUE(robot.emergencies().empty());
}

TEST_F(StateFrames, AreReceivedInOperationalOnly) {
  robot.command(canopen::NmtCommand::enter_pre_operational);
  receive(neighbour_frame, 21);
  receive(neighbour_frame, 99);
  receive(neighbour_frame, 21, 2);
  EXPECT_FALSE(holds(frame_of(1)));
  EXPECT_TRUE(robot.emergencies().empty());
}

}  // namespace
}  // namespace proleg
