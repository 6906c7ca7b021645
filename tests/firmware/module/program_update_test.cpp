// The program of a module receives an image while it runs, restarts to install it, and finds out whether it is good.

#include "shared/broadcast/transfer_frame.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

namespace flag = broadcast::module_flag;
using broadcast::ReceiverState;
using canopen::NmtCommand;
using test::node;

constexpr Microseconds trial = firmware::ProgramUpdate::trial_us;
constexpr Microseconds good_start = firmware::ProgramUpdate::good_start_us;

class ProgramUpdateTest : public testing::Test {
 protected:
  ProgramUpdateTest() {
    robot.boot();
    serial_ = robot.bus.value(node, canopen::object::serial);
  }

  [[nodiscard]] std::uint32_t serial() const { return serial_; }
  /// The answer to a request that has one.
  std::optional<CanFrame> ask(const CanFrame& request) {
    const std::size_t before = robot.bus.log.size();
    robot.bus.deliver(request);
    robot.bus.run_for(2'000);
    for (std::size_t i = before; i < robot.bus.log.size(); ++i) {
      if (robot.bus.log[i].frame.identifier == broadcast::module_identifier) {
        return robot.bus.log[i].frame;
      }
    }
    return std::nullopt;
  }
  broadcast::StatusAnswer status() {
    const auto answer = ask(broadcast::status_frame(serial()));
    EXPECT_TRUE(answer);
    return broadcast::decode_status(answer.value_or(CanFrame{}), broadcast::Code::status, serial())
        .value_or(broadcast::StatusAnswer{});
  }
  /// Sends an image of 14 bytes in session 9.
  void bring_image() {
    ASSERT_TRUE(ask(broadcast::select_frame(9, serial())));
    for (const CanFrame& frame :
         {broadcast::begin_frame(9, 14), broadcast::block_frame(9, 0, broadcast::BlockKind::symbols),
          broadcast::symbol_frame(0, {1, 2, 3, 4, 5, 6, 7}), broadcast::symbol_frame(1, {8, 9, 10, 11, 12, 13, 14})}) {
      robot.bus.deliver(frame);
    }
    robot.bus.run_for(1'000);
  }
  void boot_with_newer_settings() {
    std::array<std::uint8_t, firmware::BoardRecord::size> newer = encode(firmware::BoardRecord{}, 100);
    newer[4] = firmware::BoardRecord::schema + 1;
    newer[5] = node;
    newer[20] = 0x77;
    write_little_endian(newer, 28, 4, crc32(std::span(newer).first(28)));
    robot.it().flash.sectors[0].assign(robot.it().flash.sectors[0].size(), 0xFF);
    std::ranges::copy(newer, robot.it().flash.sectors[0].begin());
    robot.it().pending.clear();
    robot.boot();
  }
  [[nodiscard]] test::ProgramPlace& program() { return robot.it().program; }

  test::TestModule robot;

 private:
  std::uint32_t serial_ = 0;
};

TEST_F(ProgramUpdateTest, TheImageIsInRamWhenTheProgramRestartsToInstallIt) {
  bring_image();
  EXPECT_EQ(status().state, ReceiverState::complete);
  EXPECT_FALSE(program().installed);
  robot.bus.deliver(broadcast::install_frame(8));
  EXPECT_FALSE(program().installed) << "another session";
  robot.bus.deliver(broadcast::install_frame(9));
  EXPECT_EQ(program().installed, (test::ProgramPlace::Installed{14, 9, false}));
  for (std::size_t i = 0; i < 14; ++i) {
    EXPECT_EQ(program().ram[i], i + 1);
  }
}

TEST_F(ProgramUpdateTest, ItSaysWhoItIsAndWhichImageItRuns) {
  EXPECT_EQ(status().condition,
            (broadcast::ModuleCondition{flag::runs_program | flag::has_image | flag::has_bootloader, node}));
  program().confirmations = 1;
  EXPECT_NE(status().condition.flags & flag::is_confirmed, 0);
  program().header_bytes = {1, 2, 3, 4, 5, 6, 7, 8};
  const auto word = broadcast::decode_header_word(ask(broadcast::header_frame(serial(), 1)).value(), serial());
  EXPECT_EQ(word.value().value, 0x0807'0605U);
  EXPECT_FALSE(ask(broadcast::status_frame(serial() + 1))) << "another module";
}

TEST_F(ProgramUpdateTest, ItSaysWhichImagesItsBootloaderTakes) {
  const auto word = [this](std::uint8_t number) {
    const auto answer = broadcast::decode_header_word(ask(broadcast::header_frame(serial(), number)).value(), serial());
    return answer.value().value;
  };
  EXPECT_EQ(robot.bus.value(node, canopen::object::update_key), 0U);
  program().trusted = {0x1A2B'3C4D, 1, 2, 3};
  EXPECT_EQ(robot.bus.value(node, canopen::object::update_key), 0x1A2B'3C4DU);
  EXPECT_EQ(word(128), 0x1A2B'3C4DU);
  EXPECT_EQ(word(129), 0x0002'0001U);
  EXPECT_EQ(word(130), 3U);
}

// The bootloader takes the first key of a module only early.
TEST_F(ProgramUpdateTest, TheBootloaderLearnsHowLongTheProgramHasRun) {
  constexpr Microseconds minute = 60'000'000;
  robot.bus.run_for(minute);
  bring_image();
  robot.bus.deliver(broadcast::install_frame(9));
  robot.bus.run_for(1'000);
  ASSERT_TRUE(program().installed);
  EXPECT_GE(program().run_time, minute);
  EXPECT_LT(program().run_time, minute + minute / 10);
}

TEST_F(ProgramUpdateTest, AStoppedModuleTakesPartToo) {
  robot.bus.deliver(encode(canopen::NmtRequest{NmtCommand::stop, 0}));
  bring_image();
  robot.bus.deliver(broadcast::install_frame(9));
  EXPECT_TRUE(program().installed);
}

TEST_F(ProgramUpdateTest, AProgramIsConfirmedAfterHalfASecondInWhichItHasSentAndReceivedAndHasStartedWellAfterFive) {
  robot.bus.run_for(trial - 100'000);
  EXPECT_EQ(program().confirmations, 0U);
  robot.bus.run_for(100'000);
  EXPECT_EQ(program().confirmations, 1U) << "its boot-up was sent, and its serial number was asked for";
  EXPECT_EQ(program().good_starts, 0U);
  robot.bus.run_for(good_start - trial);
  EXPECT_EQ(program().good_starts, 1U);
  robot.bus.run_for(10'000'000);
  EXPECT_EQ(program().confirmations, 1U);
  EXPECT_EQ(program().good_starts, 1U);
}

TEST(ProgramUpdate, AProgramThatNobodyHearsOrThatHearsNobodyIsNotConfirmed) {
  test::ModuleNode alone({node, 1, {1, 2, 3}});
  alone.power_on(0);
  Microseconds now = 0;
  const auto run_for = [&](Microseconds time) {
    const Microseconds end = now + time;
    while (alone.next_deadline() <= end) {
      now = std::max(now, alone.next_deadline());
      alone.poll(now);
    }
    now = end;
  };
  run_for(10'000'000);
  EXPECT_EQ(alone.program.confirmations, 0U);
  EXPECT_EQ(alone.expected_heartbeat, 0xFFU) << "the heartbeat of any other node ends the trial";
  EXPECT_EQ(alone.program.good_starts, 1U) << "it has not stopped";
  ASSERT_FALSE(alone.pending.empty());
  const CanFrame boot_up = alone.pending.front();
  alone.pending.clear();
  alone.transmitted(now, boot_up);
  run_for(1'000'000);
  EXPECT_EQ(alone.program.confirmations, 0U) << "it has received nothing";
  alone.receive(now, encode(canopen::Heartbeat{77, canopen::NmtState::operational}));
  run_for(1'000'000);
  EXPECT_EQ(alone.program.confirmations, 1U);
}

TEST_F(ProgramUpdateTest, AConfirmedProgramReceivesTheHeartbeatThatItExpectsOnly) {
  robot.bus.run_for(trial);
  ASSERT_EQ(program().confirmations, 1U);
  EXPECT_EQ(robot.it().expected_heartbeat, 0U);
  robot.write(canopen::object::host_heartbeat, 9U << 16U | 500U);
  EXPECT_EQ(robot.it().expected_heartbeat, 9U);
  robot.write(canopen::object::host_heartbeat, 9U << 16U);
  EXPECT_EQ(robot.it().expected_heartbeat, 0U);
}

TEST(ProgramUpdate, WithoutABootloaderNothingIsInstalledOrConfirmed) {
  test::ModuleNode module({node, 1, {1, 2, 3}});
  module.program.is_bootloader_there = false;
  module.power_on(0);
  for (Microseconds now = 0; now < 2'000'000; now += 1'000) {
    module.poll(now);
    if (!module.pending.empty()) {
      const CanFrame frame = module.pending.front();
      module.pending.erase(module.pending.begin());
      module.transmitted(now, frame);
    }
  }
  EXPECT_EQ(module.program.confirmations, 0U);
  const std::uint32_t serial = serial_number(firmware::ModuleIdentity{node, 1, {1, 2, 3}});
  for (const CanFrame& frame :
       {broadcast::select_frame(9, serial), broadcast::begin_frame(9, 7),
        broadcast::block_frame(9, 0, broadcast::BlockKind::symbols), broadcast::symbol_frame(0, {}),
        broadcast::install_frame(9), broadcast::enter_frame(serial)}) {
    module.receive(2'000'000, frame);
  }
  module.poll(2'100'000);
  EXPECT_FALSE(module.program.installed);
  EXPECT_EQ(module.program.entries, 0U);
}

TEST_F(ProgramUpdateTest, AnOperationalModuleRefusesToInstallAndToEnterTheBootloader) {
  robot.configure(0);
  robot.start();
  ASSERT_EQ(robot.module().state(), canopen::NmtState::operational);
  bring_image();
  robot.bus.deliver(broadcast::install_frame(9));
  const broadcast::StatusAnswer answer = status();
  EXPECT_EQ(answer.state, ReceiverState::refused);
  EXPECT_EQ(answer.error, broadcast::refused_busy);
  EXPECT_NE(answer.condition.flags & flag::is_busy, 0);
  EXPECT_TRUE(ask(broadcast::enter_frame(serial())));
  robot.bus.run_for(100'000);
  EXPECT_FALSE(program().installed);
  EXPECT_EQ(program().entries, 0U);
}

TEST_F(ProgramUpdateTest, ItEntersTheBootloaderAfterItsAnswer) {
  EXPECT_TRUE(ask(broadcast::enter_frame(serial())));
  EXPECT_EQ(program().entries, 0U);
  robot.bus.run_for(firmware::ProgramUpdate::answer_time_us);
  EXPECT_EQ(program().entries, 1U);
  robot.bus.run_for(1'000'000);
  EXPECT_EQ(program().entries, 1U);
}

TEST_F(ProgramUpdateTest, ANodeIdFromLssKeepsTheOtherSettingsInASchemaThatTheProgramDoesNotKnow) {
  boot_with_newer_settings();
  EXPECT_NE(status().condition.flags & flag::has_newer_settings, 0);
  EXPECT_EQ(firmware::append_node(robot.it().flash, 33), firmware::AppendResult::ok);
  EXPECT_TRUE(firmware::has_newer_schema(robot.it().flash.sectors[0], robot.it().flash.sectors[1]));
  EXPECT_EQ(robot.it().flash.sectors[0][32 + 20], 0x77) << "copied";
}

TEST_F(ProgramUpdateTest, SavingTheSettingsEndsTheSchemaThatTheProgramDoesNotKnow) {
  boot_with_newer_settings();
  const std::array<std::uint8_t, 4> save{'s', 'a', 'v', 'e'};
  ASSERT_EQ(robot.bus.write(node, {0x1010, 1}, 4, read_little_endian(save, 0, 4)), canopen::AbortCode::none);
  EXPECT_EQ(status().condition.flags & flag::has_newer_settings, 0);
  robot.it().pending.clear();
  robot.boot();
  EXPECT_EQ(status().condition.flags & flag::has_newer_settings, 0);
  EXPECT_EQ(status().condition.node, node);
}

class NewerSettings : public ProgramUpdateTest {
 protected:
  void try_to_enable() {
    for (const std::uint16_t controlword : test::power_up) {
      ASSERT_EQ(robot.bus.write(node, canopen::object::controlword, controlword), canopen::AbortCode::none);
    }
  }
  [[nodiscard]] std::vector<canopen::EmergencyCode> codes() const {
    std::vector<canopen::EmergencyCode> found;
    for (const canopen::Emergency& emergency : robot.emergencies()) {
      found.push_back(emergency.code);
    }
    return found;
  }
};

TEST_F(NewerSettings, GiveTheServoNoPowerUntilSettingsAreSaved) {
  using canopen::EmergencyCode;
  boot_with_newer_settings();
  EXPECT_EQ(codes(), std::vector{EmergencyCode::newer_settings});
  EXPECT_EQ(robot.bus.value(node, canopen::object::error_register), 0x81U);
  try_to_enable();
  EXPECT_EQ(robot.module().power(), canopen::PowerState::switch_on_disabled);
  robot.configure(0);
  robot.start();
  try_to_enable();
  robot.tick(0);
  robot.sync(0);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.module().power(), canopen::PowerState::switch_on_disabled);
  EXPECT_EQ(robot.it().pulse_count(), 0U);
  EXPECT_EQ(codes(), std::vector{EmergencyCode::newer_settings}) << "once";

  robot.command(NmtCommand::enter_pre_operational);
  ASSERT_EQ(robot.bus.write(node, {0x1010, 1}, 4, canopen::signature_save), canopen::AbortCode::none);
  EXPECT_EQ(codes(), (std::vector{EmergencyCode::newer_settings, EmergencyCode::none}));
  try_to_enable();
  EXPECT_EQ(robot.module().power(), canopen::PowerState::operation_enabled);
}

}  // namespace
}  // namespace proleg
