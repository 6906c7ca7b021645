// A module without a node id, and how LSS (CiA 305) gives it one or another.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

constexpr std::uint16_t lss_answer = 0x7E4;

CanFrame lss(const std::array<std::uint8_t, 8>& data) { return {0x7E5, 8, data}; }
const CanFrame select_all = lss({0x04, 1});
const CanFrame release_all = lss({0x04, 0});
const CanFrame store = lss({0x17});
CanFrame configure(std::uint8_t node_id) { return lss({0x11, node_id}); }

firmware::ModuleIdentity identity_of(std::uint8_t node_id) {
  firmware::ModuleIdentity identity;
  identity.node = node_id;
  identity.unique_id = {1, 2, 3};
  return identity;
}

class LssModule : public testing::Test {
 protected:
  /// node_id: in the board record; 0: none.
  void power_on(std::uint8_t node_id) {
    it = &bus.add(identity_of(node_id));
    if (node_id == 0) {
      it->flash = {};
    }
    it->power_on(bus.now());
    bus.run_for(50'000);
  }
  void restart() {
    it->pending.clear();
    it->power_on(bus.now());
    bus.run_for(50'000);
  }
  /// The first three bytes of the answer.
  std::vector<unsigned> ask(const CanFrame& request) {
    const std::size_t from = bus.log.size();
    bus.deliver(request);
    bus.run_for(1'000);
    const auto answers = bus.sent(lss_answer, from);
    EXPECT_LE(answers.size(), 1U);
    if (answers.empty()) {
      return {};
    }
    return {answers[0].frame.data[0], answers[0].frame.data[1], answers[0].frame.data[2]};
  }
  [[nodiscard]] std::vector<std::uint16_t> identifiers(std::size_t from = 0) const {
    std::vector<std::uint16_t> found;
    for (std::size_t i = from; i < bus.log.size(); ++i) {
      if (bus.log[i].sender != test::TestBus::host) {
        found.push_back(bus.log[i].frame.identifier);
      }
    }
    return found;
  }

  test::TestBus bus;
  test::ModuleNode* it = nullptr;
};

TEST_F(LssModule, WithoutANodeIdSendsNothingWhateverItReceivesAndItsServoIsOff) {
  power_on(0);
  EXPECT_EQ(it->module.node(), 0);
  for (std::uint16_t identifier = 0; identifier <= CanFrame::max_identifier; ++identifier) {
    if (identifier != 0x7E5) {
      bus.deliver({identifier, 8, {1, 0, 0x10, 1}});
      bus.deliver({identifier, 1, {1}});
      bus.deliver({identifier, 2, {0x01, 0x00}});
    }
  }
  bus.run_for(10'000'000);
  EXPECT_TRUE(identifiers().empty());
  EXPECT_EQ(it->pulse_count(), 0U);
  EXPECT_EQ(it->module.state(), NmtState::boot_up);
}

TEST_F(LssModule, WithoutANodeIdComesBackFromBusOffInSilence) {
  power_on(0);
  it->bus_off(bus.now());
  bus.run_for(100'000);
  EXPECT_FALSE(it->recoveries.empty());
  it->bus_back(bus.now());
  bus.run_for(20'000'000);
  EXPECT_TRUE(identifiers().empty());
  EXPECT_EQ(ask(lss({0x4C})), (std::vector<unsigned>{0x50, 0, 0}));
}

TEST_F(LssModule, BootsWithTheConfiguredNodeIdWhenItIsReleased) {
  power_on(0);
  EXPECT_EQ(ask(lss({0x4C})), (std::vector<unsigned>{0x50, 0, 0})) << "identify non-configured remote slave";
  EXPECT_TRUE(ask(select_all).empty());
  EXPECT_EQ(ask(lss({0x5E})), (std::vector<unsigned>{0x5E, 0xFF, 0})) << "inquire node id";
  EXPECT_EQ(ask(configure(42)), (std::vector<unsigned>{0x11, 0, 0}));
  bus.run_for(1'000'000);
  EXPECT_EQ(it->module.node(), 0) << "not before it is released";
  const std::size_t from = bus.log.size();
  bus.deliver(release_all);
  bus.run_for(50'000);
  EXPECT_EQ(identifiers(from), std::vector<std::uint16_t>{0x700 + 42});
  EXPECT_EQ(it->module.node(), 42);
  EXPECT_EQ(it->module.state(), NmtState::pre_operational);
  EXPECT_EQ(bus.value(42, canopen::Address{0x1014, 0}), 0x80U + 42U)
      << "SDO is served, and identifiers follow the node id";
  EXPECT_TRUE(ask(lss({0x4C})).empty());
  // The node id was not stored.
  restart();
  EXPECT_EQ(it->module.node(), 0);
}

TEST_F(LssModule, StoreConfigurationKeepsTheNodeId) {
  power_on(0);
  ask(select_all);
  ask(configure(42));
  EXPECT_EQ(ask(store), (std::vector<unsigned>{0x17, 0, 0}));
  const std::size_t from = bus.log.size();
  restart();
  EXPECT_EQ(identifiers(from), std::vector<std::uint16_t>{0x700 + 42});
}

TEST_F(LssModule, StoreConfigurationKeepsTheOtherSettings) {
  power_on(9);
  firmware::BoardRecord board{9, true, 100, 200, true, -5, 6, 700, 800};
  ASSERT_EQ(firmware::append(it->flash, board), firmware::AppendResult::ok);
  restart();
  ask(select_all);
  ask(configure(10));
  EXPECT_EQ(ask(store), (std::vector<unsigned>{0x17, 0, 0}));
  board.node = 10;
  EXPECT_EQ(firmware::newest(it->flash.sectors[0], it->flash.sectors[1]), board);
}

TEST_F(LssModule, AConfiguredModuleTakesAnotherNodeIdAtAResetByNmt) {
  for (const NmtCommand reset : {NmtCommand::reset_communication, NmtCommand::reset_node}) {
    bus.nodes.clear();
    power_on(9);
    ask(select_all);
    EXPECT_EQ(ask(configure(10)), (std::vector<unsigned>{0x11, 0, 0}));
    ask(release_all);
    bus.run_for(1'000'000);
    EXPECT_EQ(it->module.node(), 9);
    EXPECT_EQ(bus.value(9, canopen::Address{0x1014, 0}), 0x80U + 9U);
    const std::size_t from = bus.log.size();
    bus.deliver(encode(canopen::NmtRequest{reset, 9}));
    bus.run_for(50'000);
    EXPECT_EQ(identifiers(from), std::vector<std::uint16_t>{0x700 + 10});
    EXPECT_EQ(bus.value(10, canopen::Address{0x1014, 0}), 0x80U + 10U);
  }
}

TEST_F(LssModule, NodeId255TakesTheNodeIdFromAModule) {
  power_on(9);
  ask(select_all);
  EXPECT_EQ(ask(configure(255)), (std::vector<unsigned>{0x11, 0, 0}));
  EXPECT_EQ(ask(store), (std::vector<unsigned>{0x17, 0, 0}));
  const std::size_t from = bus.log.size();
  bus.deliver(encode(canopen::NmtRequest{NmtCommand::reset_node, 9}));
  bus.run_for(1'000'000);
  EXPECT_TRUE(identifiers(from).empty());
  EXPECT_EQ(ask(lss({0x4C})), (std::vector<unsigned>{0x50, 0, 0}));
  restart();
  EXPECT_EQ(it->module.node(), 0);
}

TEST_F(LssModule, IdentifiesItselfAsObject1018Does) {
  power_on(9);
  ask(select_all);
  for (std::uint8_t i = 0; i < 4; ++i) {
    const std::size_t from = bus.log.size();
    ask(lss({static_cast<std::uint8_t>(0x5A + i)}));
    const auto answers = bus.sent(lss_answer, from);
    ASSERT_EQ(answers.size(), 1U);
    std::uint32_t number = 0;
    for (unsigned byte = 4; byte > 0; --byte) {
      number = number << 8U | answers[0].frame.data.at(byte);
    }
    EXPECT_EQ(number, bus.value(9, canopen::Address{0x1018, static_cast<std::uint8_t>(i + 1)}));
  }
}

TEST(LssRobot, AModuleThatMovesDoesNotStoreANodeId) {
  test::TestModule robot;
  robot.drive();
  robot.enable(0);
  const int operations = robot.it().flash.operations;
  robot.bus.deliver(select_all);
  robot.bus.deliver(configure(42));
  robot.bus.run_for(1'000);
  const auto store_error = [&] {
    const std::size_t from = robot.bus.log.size();
    robot.bus.deliver(store);
    robot.bus.run_for(1'000);
    const auto answers = robot.bus.sent(lss_answer, from);
    EXPECT_EQ(answers.size(), 1U);
    return answers.empty() ? 0U : unsigned{answers[0].frame.data[1]};
  };
  EXPECT_EQ(store_error(), 255U);
  EXPECT_EQ(robot.it().flash.operations, operations);
  // The drive loses its power with Operational, and the host can enable it in Pre-operational.
  robot.command(NmtCommand::enter_pre_operational);
  robot.enable(0);
  EXPECT_EQ(store_error(), 255U);
  EXPECT_EQ(robot.it().flash.operations, operations);
  robot.command(NmtCommand::stop);
  EXPECT_EQ(store_error(), 0U) << "in Stopped";
  EXPECT_GT(robot.it().flash.operations, operations);
}

TEST(LssRobot, ALostPowerWhileANodeIdIsStoredLeavesTheOldOneOrTheNew) {
  for (int cut = 0; cut < 12; ++cut) {
    for (unsigned before = 0; before < 4; ++before) {  // the last one is at the last place of the sector
      test::TestBus bus;
      test::ModuleNode& it = bus.add(identity_of(9));
      for (unsigned i = 0; i < before; ++i) {
        ASSERT_EQ(firmware::append(it.flash, {static_cast<std::uint8_t>(i % 2 == 0 ? 8 : 9), false, 0, 0}),
                  firmware::AppendResult::ok);
      }
      const unsigned old = before % 2 == 0 ? 9 : 8;
      it.power_on(0);
      it.poll(20'000);
      it.receive(20'000, select_all);
      it.receive(20'000, configure(42));
      it.flash.cut_at = it.flash.operations + cut;
      bool was_cut = false;
      try {
        it.receive(20'000, store);
      } catch (const test::PowerCut&) {
        was_cut = true;
      }
      it.flash.cut_at = -1;
      it.power_on(40'000);
      if (was_cut) {
        EXPECT_TRUE(it.module.node() == old || it.module.node() == 42) << "cut " << cut << ", place " << before;
      } else {
        EXPECT_EQ(it.module.node(), 42);
      }
    }
  }
}

}  // namespace
}  // namespace proleg
