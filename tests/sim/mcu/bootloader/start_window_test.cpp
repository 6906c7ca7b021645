// The window after power on, in which the bootloader listens before it starts a confirmed program (docs/flashing.md).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <optional>

#include "chip_bootloader.hpp"
#include "firmware/bootloader/handover.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime window = broadcast::start_window_us * us;
constexpr BusTime hold_period = broadcast::hold_period_us * us;

/// An image so small that its checksum takes no time. It makes the servo's pin high, and then feeds the watchdog for
/// ever: it never takes part in the bus.
std::vector<std::uint8_t> deaf_program() {
  return other_program([](const image::Header& header, std::vector<std::uint8_t>& body) {
    constexpr std::size_t code_at = 400;  // behind the vector table
    constexpr std::array<std::uint16_t, 14> code{
        0xF240, 0x0018, 0xF2C4, 0x0002,  // r0 = 0x40020018: GPIOA_BSRR
        0x2120, 0x6001,                  // the pin 5
        0xF243, 0x0000, 0xF2C4, 0x0000,  // r0 = 0x40003000: IWDG_KR
        0xF64A, 0x21AA,                  // r1 = 0xAAAA: feed
        0x6001, 0xE7FD,                  // str r1, [r0], again and again
    };
    body.resize(code_at + 2 * code.size());
    write_little_endian(body, 4, 4, header.address + code_at + 1);
    for (std::size_t i = 0; i < code.size(); ++i) {
      write_little_endian(body, code_at + 2 * i, 2, code.at(i));
    }
  });
}

class ChipStartWindow : public ChipBootloader {
 protected:
  /// The chip has a confirmed program that is deaf.
  ChipStartWindow() { insert_deaf_program(); }

  void insert_deaf_program() {
    write_slot(slot_a, deaf_program(), true);
    rig->chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
      if (high) {
        started_ = time;
      }
    });
  }
  void insert_good_program() {
    make_chip();
    write_slot(slot_a, program(), true);
  }
  /// Time from now to the start of the deaf program.
  [[nodiscard]] std::optional<BusTime> start_time(BusTime timeout = s) {
    started_.reset();
    const BusTime begin = rig->bus.now();
    rig->run_until_true([this] { return started_.has_value(); }, timeout);
    return started_ ? std::optional(*started_ - begin) : std::nullopt;
  }
  [[nodiscard]] double start_ms() { return static_cast<double>(start_time().value_or(10 * s)) / 1e6; }
  void power_on_and_hold(std::uint32_t serial_number) {
    rig->power_on();
    rig->run_for(window / 2);
    rig->host.send(broadcast::enter_frame(serial_number));
  }
  /// Requests of a host as `proleg recover` repeats them.
  void hold_for(BusTime time) {
    for (const BusTime end = rig->bus.now() + time; rig->bus.now() < end;) {
      rig->host.send(broadcast::enter_frame(broadcast::every_serial));
      rig->run_for(hold_period);
    }
  }
  /// The bootloader resets the chip by software.
  void leave_by_network_command() {
    rig->host.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 0}));
  }

 private:
  std::optional<BusTime> started_;
};

TEST_F(ChipStartWindow, DelaysAProgramAfterPowerOnAndNotAfterAResetBySoftware) {
  rig->power_on();
  const double after_power_on = start_ms();
  power_on_and_hold(broadcast::every_serial);
  ASSERT_TRUE(sends_boot_up());
  leave_by_network_command();
  const double after_reset = start_ms();
  std::cout << "a program without a checksum to speak of starts " << after_power_on << " ms after power on, "
            << after_reset << " ms after a reset by software\n";
  EXPECT_NEAR(after_power_on - after_reset, static_cast<double>(window) / 1e6, 5.0);
  EXPECT_LT(after_reset, 5.0);
}

TEST_F(ChipStartWindow, ComesAfterABrownOutToo) {
  insert_good_program();  // it clears the flags of the power on
  start_program();
  rig->run_for(100 * ms);
  rig->chip.set_supply(2'600);  // below level 3 of the brown-out reset
  rig->run_for(10 * ms);
  rig->chip.set_supply(3'300);
  const BusTime begin = rig->bus.now();
  hold_for(window);
  EXPECT_FALSE(rig->frames(heartbeat, begin).empty());
  EXPECT_FALSE(is_program());
}

TEST_F(ChipStartWindow, DoesNotComeAfterAResetByThePin) {
  insert_good_program();  // it clears the flags of the power on
  start_program();
  rig->run_for(100 * ms);
  rig->chip.pull_reset_pin();
  hold_for(600 * ms);
  EXPECT_TRUE(is_program());
}

TEST_F(ChipStartWindow, TakesNoTimeBesideTheChecksumOfAProgram) {
  insert_good_program();
  rig->power_on();
  ASSERT_TRUE(starts_program());
  const BusTime with_window = rig->frames(heartbeat)[0].time;
  rig->host.send(broadcast::enter_frame(serial));
  ASSERT_TRUE(sends_boot_up());
  rig->run_for(20 * ms);
  const BusTime begin = rig->bus.now();
  leave_by_network_command();
  ASSERT_TRUE(starts_program());
  const BusTime without_window = rig->frames(heartbeat, begin)[0].time - begin;
  std::cout << "boot-up of the program: " << with_window / us << " us after power on, with the window; "
            << without_window / us << " us after a reset by software, without it\n";
  EXPECT_NEAR(static_cast<double>(with_window) / 1e6, static_cast<double>(without_window) / 1e6, 5.0);
}

TEST_F(ChipStartWindow, OfAModuleSendsNothingAndMovesNoServo) {
  rig->board.servo_pulls_up = true;
  unsigned rises = 0;
  rig->power_on();
  rig->run_for(ms);
  rig->chip.set_pin_watch('A', 5, [&rises](BusTime /*time*/, bool high) { rises += high ? 1U : 0U; });
  rig->run_for(window);
  EXPECT_EQ(rises, 0U);
  EXPECT_TRUE(rig->log.empty());
}

TEST_F(ChipStartWindow, HoldsAModuleThatARequestNames) {
  for (const std::uint32_t named : {serial, broadcast::every_serial}) {
    power_on_and_hold(named);
    ASSERT_TRUE(sends_boot_up()) << named;
    EXPECT_FALSE(is_program());
    EXPECT_FALSE(start_time(5 * s).has_value()) << "it stays";
  }
}

TEST_F(ChipStartWindow, IgnoresARequestForAnotherModule) {
  power_on_and_hold(serial + 1);
  EXPECT_FALSE(sends_boot_up());
}

TEST_F(ChipStartWindow, IsOverWhenTheProgramStarts) {
  rig->power_on();
  ASSERT_TRUE(start_time().has_value());
  hold_for(200 * ms);
  EXPECT_TRUE(rig->frames(heartbeat).empty());
  insert_good_program();
  start_program();
  hold_for(200 * ms);
  EXPECT_TRUE(is_program()) << "a program ignores the request for every module";
}

TEST_F(ChipStartWindow, IsNotExtendedByAFloodOfForeignFrames) {
  rig->power_on();
  const double quiet = start_ms();
  for (const CanFrame& frame : {CanFrame{broadcast::host_identifier, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
                                broadcast::enter_frame(serial + 1), CanFrame{0x000, 0, {}}, CanFrame{0x123, 8, {}}}) {
    make_chip();
    insert_deaf_program();
    for (unsigned i = 0; i < 5'000; ++i) {  // back to back for 200 ms or more
      rig->host.send(frame);
    }
    rig->power_on();
    EXPECT_NEAR(start_ms(), quiet, 1.0) << std::hex << frame.identifier;
    EXPECT_FALSE(rig->host.is_done());
  }
}

TEST_F(ChipStartWindow, EndsOnABusThatIsStuck) {
  rig->power_on();
  const double quiet = start_ms();
  rig->bus.hold_dominant(true);
  rig->power_on();
  EXPECT_NEAR(start_ms(), quiet, 1.0);
}

TEST_F(ChipStartWindow, NeedsACrystalAndNoProgramWaitsForIt) {
  rig->chip.set_crystal(false);
  rig->power_on();
  EXPECT_LT(start_ms(), 150.0);
}

TEST_F(ChipStartWindow, InWhichThePowerIsCutChangesNothing) {
  insert_good_program();
  const std::vector<std::uint8_t> before = rig->memory(0x0800'0000, 1024 * 1024);
  for (unsigned cut = 0; cut < 2 * bootloader::max_bad_starts; ++cut) {
    rig->power_on();
    rig->run_for(window * (cut + 1) / 12);
  }
  EXPECT_EQ(rig->memory(0x0800'0000, 1024 * 1024), before);
  EXPECT_TRUE(rig->frames(heartbeat).empty());
  start_program();
}

TEST_F(ChipStartWindow, DoesNotHideThatAProgramStartsBadly) {
  write_slot(slot_a, program_that_starts_with(undefined_instruction), true);
  rig->power_on();
  ASSERT_TRUE(sends_boot_up(15 * s));
  EXPECT_NE(flags() & broadcast::module_flag::starts_badly, 0);
}

TEST_F(ChipStartWindow, IsTheWayToAConfirmedProgramThatIsDeaf) {
  rig->power_on();
  ASSERT_TRUE(start_time().has_value());
  rig->host.send(broadcast::enter_frame(serial));
  EXPECT_FALSE(sends_boot_up(2 * s)) << "nothing else reaches it";
  rig->power_on();
  hold_for(window);
  ASSERT_FALSE(rig->frames(heartbeat).empty());
  EXPECT_EQ(flash(program()), ReceiverState::installed);
  leave_bootloader();
  EXPECT_TRUE(starts_program());
}

}  // namespace
}  // namespace proleg::sim
