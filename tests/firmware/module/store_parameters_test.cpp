// Objects 0x1010 and 0x1011 (CiA 301, sections 7.5.2.13 and 7.5.2.14), and the settings of the board behind them.

#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::NmtCommand;
using firmware::BoardRecord;
using test::node;
constexpr std::uint32_t save = 0x65766173;  // 's' in the lowest byte, 'a', 'v', 'e'
constexpr std::uint32_t load = 0x64616F6C;

class StoreParameters : public testing::Test {
 protected:
  StoreParameters() { robot.boot(); }

  AbortCode write(const canopen::Object& entry, std::uint32_t value) { return robot.bus.write(node, entry, value); }
  std::uint32_t value(const canopen::Object& entry) { return robot.bus.value(node, entry); }
  void restart() {
    robot.it().pending.clear();
    robot.boot();
  }
  [[nodiscard]] std::optional<BoardRecord> in_flash() {
    return firmware::newest(robot.it().flash.sectors[0], robot.it().flash.sectors[1]);
  }
  void write_all() {
    EXPECT_EQ(write(object::gateway_role, 1), AbortCode::none);
    EXPECT_EQ(write(object::has_feedback, 1), AbortCode::none);
    EXPECT_EQ(write(object::feedback_at_minus_90, 3000), AbortCode::none);
    EXPECT_EQ(write(object::feedback_at_plus_90, 1000), AbortCode::none);
    EXPECT_EQ(write(object::lowest_position, static_cast<std::uint32_t>(-(1 << 29))), AbortCode::none);
    EXPECT_EQ(write(object::highest_position, 1 << 28), AbortCode::none);
    EXPECT_EQ(write(object::current_limit, 1234), AbortCode::none);
    EXPECT_EQ(write(object::current_limit_time, 56), AbortCode::none);
  }
  static constexpr BoardRecord all{node, true, 3000, 1000, true, -(1 << 29), 1 << 28, 1234, 56};

  test::TestModule robot;
};

TEST_F(StoreParameters, ReadAsWhatTheyCanDo) {
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x1010, 0}), 1U);
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x1010, 1}), 1U) << "saves on command, not by itself";
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x1011, 0}), 1U);
  EXPECT_EQ(robot.bus.value(node, canopen::Address{0x1011, 1}), 1U) << "can restore";
}

TEST_F(StoreParameters, SaveKeepsAllSettingsOverARestart) {
  write_all();
  ASSERT_EQ(robot.bus.write(node, {0x1010, 1}, 4, save), AbortCode::none);
  EXPECT_EQ(in_flash(), all);
  restart();
  EXPECT_EQ(value(object::gateway_role), 1U);
  EXPECT_EQ(value(object::has_feedback), 1U);
  EXPECT_EQ(value(object::feedback_at_minus_90), 3000U);
  EXPECT_EQ(value(object::feedback_at_plus_90), 1000U);
  EXPECT_EQ(value(object::lowest_position), static_cast<std::uint32_t>(-(1 << 29)));
  EXPECT_EQ(value(object::highest_position), 1U << 28U);
  EXPECT_EQ(value(object::current_limit), 1234U);
  EXPECT_EQ(value(object::current_limit_time), 56U);
  EXPECT_EQ(value(object::capabilities) & canopen::measures_angle, 1U);
}

TEST_F(StoreParameters, SaveIsTheExampleOfTheProtocol) {
  // docs/protocol.md has the exchange for node 3.
  test::TestBus bus;
  firmware::ModuleIdentity identity;
  identity.node = 3;
  bus.add(identity).power_on(0);
  bus.run_until(20'000);
  bus.deliver({0x603, 8, {0x23, 0x10, 0x10, 0x01, 0x73, 0x61, 0x76, 0x65}});
  bus.run_for(1'000);
  EXPECT_EQ(bus.log.back().frame, (CanFrame{0x583, 8, {0x60, 0x10, 0x10, 0x01}}));
}

TEST_F(StoreParameters, WithoutSaveARestartHasTheOldValues) {
  write_all();
  restart();
  EXPECT_EQ(value(object::gateway_role), 0U);
  EXPECT_EQ(value(object::highest_position), 1U << 30U);
  EXPECT_EQ(value(object::current_limit), 2000U);
}

TEST_F(StoreParameters, LoadRestoresAllButTheNodeIdAtTheNextReset) {
  write_all();
  ASSERT_EQ(write(object::store_parameters, save), AbortCode::none);
  restart();
  ASSERT_EQ(robot.bus.write(node, {0x1011, 1}, 4, load), AbortCode::none);
  EXPECT_EQ(value(object::current_limit), 1234U) << "not before the reset";
  EXPECT_EQ(in_flash(), (BoardRecord{node, false, 0, 0}));
  robot.command(NmtCommand::reset_communication);
  robot.bus.run_for(20'000);
  EXPECT_EQ(value(object::current_limit), 1234U) << "the application is as it was";
  EXPECT_EQ(value(object::capabilities) & canopen::measures_angle, 1U);
  robot.command(NmtCommand::reset_node);
  robot.bus.run_for(20'000);
  EXPECT_EQ(value(object::current_limit), 2000U);
  EXPECT_EQ(value(object::current_limit_time), 500U);
  EXPECT_EQ(value(object::gateway_role), 0U);
  EXPECT_EQ(value(object::lowest_position), static_cast<std::uint32_t>(-(1 << 30)));
  EXPECT_EQ(value(object::capabilities) & canopen::measures_angle, 0U);
}

TEST_F(StoreParameters, AWrongSignatureIsRefusedAndNothingIsWritten) {
  write_all();
  const int operations = robot.it().flash.operations;
  for (const std::uint32_t signature : {0U, 1U, load, 0x73617665U, save ^ 0x20U, ~0U}) {
    EXPECT_EQ(write(object::store_parameters, signature), static_cast<AbortCode>(0x08000020)) << signature;
  }
  EXPECT_EQ(write(object::restore_parameters, save), static_cast<AbortCode>(0x08000020));
  EXPECT_EQ(robot.it().flash.operations, operations);
}

TEST_F(StoreParameters, SettingsThatDoNotFitTogetherAreRefused) {
  EXPECT_EQ(write(object::has_feedback, 1), AbortCode::none);
  EXPECT_EQ(write(object::feedback_at_plus_90, 0), AbortCode::none);
  EXPECT_EQ(write(object::store_parameters, save), AbortCode::general_incompatibility) << "two equal readings";
  EXPECT_EQ(write(object::lowest_position, 1), AbortCode::above_maximum) << "0, the safe pose, is allowed";
}

TEST_F(StoreParameters, AFlashThatFailsIsReported) {
  EXPECT_EQ(write(object::current_limit, 1), AbortCode::none);
  robot.it().flash.refused_at = robot.it().flash.operations + 2;
  EXPECT_EQ(write(object::store_parameters, save), static_cast<AbortCode>(0x06060000));
  EXPECT_EQ(in_flash()->current_limit_ma, 2000U);
}

TEST_F(StoreParameters, WhatIsSavedAlreadyIsNotWrittenAgain) {
  write_all();
  ASSERT_EQ(write(object::store_parameters, save), AbortCode::none);
  const int operations = robot.it().flash.operations;
  EXPECT_EQ(write(object::store_parameters, save), AbortCode::none);
  EXPECT_EQ(robot.it().flash.operations, operations);
}

TEST_F(StoreParameters, AreRefusedInOperationalAndWhileTheDriveHasPower) {
  const AbortCode refused = static_cast<AbortCode>(0x08000022);
  robot.configure(0);
  robot.start();
  const int operations = robot.it().flash.operations;
  EXPECT_EQ(write(object::store_parameters, save), refused) << "Operational, without power";
  robot.produce_sync();
  robot.enable(0);
  EXPECT_EQ(write(object::store_parameters, save), refused);
  EXPECT_EQ(write(object::restore_parameters, load), refused);
  robot.command(NmtCommand::enter_pre_operational);
  robot.enable(0);
  EXPECT_EQ(write(object::store_parameters, save), refused) << "the drive is enabled";
  EXPECT_EQ(write(object::restore_parameters, load), refused);
  EXPECT_EQ(write(object::controlword, 7), AbortCode::none);
  EXPECT_EQ(write(object::store_parameters, save), refused) << "switched on";
  EXPECT_EQ(robot.it().flash.operations, operations);
  EXPECT_EQ(write(object::controlword, 0), AbortCode::none);
  EXPECT_EQ(write(object::current_limit, 77), AbortCode::none);
  EXPECT_EQ(write(object::store_parameters, save), AbortCode::none);
  EXPECT_GT(robot.it().flash.operations, operations);
}

TEST_F(StoreParameters, TheLimitsOfTheMechanicsBoundThoseOfTheJoint) {
  EXPECT_EQ(write(object::lowest_position, static_cast<std::uint32_t>(-1000)), AbortCode::none);
  EXPECT_EQ(write(object::highest_position, 2000), AbortCode::none);
  for (const AbortCode code :
       {write(object::slot_algorithm.first, 2), write(object::slot_group_low.first, 1), write(object::activate, 1)}) {
    ASSERT_EQ(code, AbortCode::none);
  }
  EXPECT_EQ(value(object::lower_limit), static_cast<std::uint32_t>(-1000)) << "without a limit of the robot";
  EXPECT_EQ(value(object::upper_limit), 2000U);
  EXPECT_EQ(write(object::lower_limit, static_cast<std::uint32_t>(-1001)), AbortCode::below_minimum);
  EXPECT_EQ(write(object::upper_limit, 2001), AbortCode::above_maximum);
  EXPECT_EQ(write(object::upper_limit, 1999), AbortCode::none);
  EXPECT_EQ(write(object::highest_position, 1), AbortCode::refused_by_state) << "the joint uses them";
}

TEST_F(StoreParameters, ALostPowerAtAnyInstantLeavesTheOldSettingsOrTheNew) {
  // It saves another value each time, until both sectors were erased.
  constexpr unsigned saves = 10;
  const auto limit_of = [](unsigned number) { return 100 + number; };
  const auto save_number = [&](unsigned number) {
    robot.it().receive(robot.bus.now(),
                       {0x600 + node, 8, {0x2B, 0x0A, 0x20, 1, static_cast<std::uint8_t>(100 + number)}});
    robot.it().receive(robot.bus.now(), {0x600 + node, 8, {0x23, 0x10, 0x10, 1, 's', 'a', 'v', 'e'}});
    robot.bus.run_for(1'000);
  };
  const test::FlashMemory fresh = robot.it().flash;
  for (unsigned i = 0; i < saves; ++i) {
    save_number(i);
  }
  const int operations = robot.it().flash.operations - fresh.operations;
  ASSERT_GT(operations, 80) << "eight words a record, and the erases";
  int cuts = 0;
  for (int cut = 0; cut < operations; ++cut) {
    robot.it().flash = fresh;
    robot.it().flash.cut_at = fresh.operations + cut;
    robot.it().flash.noise.seed(static_cast<unsigned>(cut));
    restart();
    std::uint32_t before = 2000;
    for (unsigned i = 0; i < saves; ++i) {
      try {
        save_number(i);
      } catch (const test::PowerCut&) {
        restart();
        const std::uint32_t found = value(object::current_limit);
        ASSERT_TRUE(found == before || found == limit_of(i)) << "cut " << cut << ", save " << i << ": " << found;
        ++cuts;
        save_number(i);
      }
      before = limit_of(i);
    }
    restart();
    ASSERT_EQ(value(object::current_limit), limit_of(saves - 1)) << "cut " << cut;
  }
  EXPECT_EQ(cuts, operations);
}

}  // namespace
}  // namespace proleg
