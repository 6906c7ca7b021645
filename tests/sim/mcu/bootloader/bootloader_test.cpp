// The bootloader and the image of a module in a virtual chip: from a chip without a program to one that runs, and what
// it does about a program that does not start.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "chip_bootloader.hpp"
#include "shared/canopen/messages.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::sim {
namespace {

TEST_F(ChipBootloader, AChipWithoutAProgramTakesPartInTheBusWithTheNodeIdOfItsSettings) {
  start_bootloader();
  EXPECT_EQ(rig->read(0x1000, 0), 0U) << "no device profile";
  EXPECT_EQ(rig->read(0x1018, 4), serial);
  EXPECT_EQ(rig->read(0x1F56, 1), 0U) << "no program";
}

TEST_F(ChipBootloader, AConfirmedProgramStartsAtOnceWithTheSameSerialNumber) {
  write_slot(slot_a, program(), true);
  rig->power_on();
  ASSERT_TRUE(starts_program());
  const BusTime start = rig->frames(heartbeat)[0].time;
  std::cout << "from power on to the boot-up of a confirmed program: " << start / us << " us\n";
  EXPECT_LT(start, 200 * ms);
  EXPECT_EQ(rig->read(0x1018, 4), serial);
  EXPECT_NE(rig->board.console.find("started by power on"), std::string::npos) << rig->board.console;
}

TEST_F(ChipBootloader, TheServosLineIsLowFromTheFirstInstructionsOnUntilTheServoGetsPower) {
  write_slot(slot_a, program(), true);
  rig->board.servo_pulls_up = true;
  std::vector<BusTime> rises;
  std::vector<BusTime> falls;
  rig->chip.set_pin_watch('A', 5, [&](BusTime time, bool high) { (high ? rises : falls).push_back(time); });
  for (const bool by_pin : {false, true}) {
    rises.clear();
    falls.clear();
    const BusTime start = rig->bus.now();
    by_pin ? rig->chip.pull_reset_pin() : rig->power_on();
    ASSERT_TRUE(starts_program(1'000 * ms));
    ASSERT_FALSE(falls.empty());
    EXPECT_LT(falls.front() - start, 50 * us);
    for (const BusTime rise : rises) {  // after power on there is a second reset, at the end of the window
      const auto fall = std::ranges::lower_bound(falls, rise);
      ASSERT_NE(fall, falls.end());
      EXPECT_LT(*fall - rise, 50 * us);
    }
  }
}

TEST_F(ChipBootloader, AnImageThatComesByBroadcastIsInstalledAndRuns) {
  start_bootloader();
  const BusTime start = rig->bus.now();
  EXPECT_EQ(flash(program()), ReceiverState::installed);
  std::cout << program().size() << " bytes to an empty chip: " << (rig->bus.now() - start) / ms << " ms\n";
  EXPECT_TRUE(holds(slot_a, program()));
  leave_bootloader();
  EXPECT_TRUE(starts_program());
}

TEST_F(ChipBootloader, TheImageBeforeIsTheBackupUntilTheNewOneIsConfirmed) {
  const std::vector<std::uint8_t> newer = newer_program();
  write_slot(slot_a, program(), true);
  enter_bootloader();
  EXPECT_EQ(flash(newer), ReceiverState::installed);
  EXPECT_TRUE(holds(slot_b, program()));
  for (unsigned start = 0; start < bootloader::Slots::max_attempts; ++start) {
    rig->power_on();
    ASSERT_TRUE(starts_program()) << start;
    EXPECT_TRUE(holds(slot_a, newer));
  }
  rig->power_on();
  ASSERT_TRUE(starts_program(3 * s)) << "after the backup was copied";
  EXPECT_TRUE(holds(slot_a, program()));
  rig->power_on();
  ASSERT_TRUE(starts_program()) << "it is confirmed, as it was before";
}

TEST_F(ChipBootloader, AProgramThatHangsOrFaultsGivesWayToTheOneBeforeByItself) {
  constexpr std::uint16_t wait_for_interrupt = 0xBF30;  // there is none: it is simulated faster than an endless loop
  for (const std::uint16_t instruction : {wait_for_interrupt, undefined_instruction}) {
    make_chip();
    write_slot(slot_a, program(), true);
    enter_bootloader();
    const std::vector<std::uint8_t> broken = program_that_starts_with(instruction);
    ASSERT_EQ(flash(broken), ReceiverState::installed);
    const BusTime start = rig->bus.now();
    leave_bootloader();
    EXPECT_TRUE(starts_program(10 * s)) << std::hex << instruction;
    std::cout << "until the program before runs again: " << (rig->bus.now() - start) / ms << " ms\n";
    EXPECT_TRUE(holds(slot_a, program()));
  }
}

TEST_F(ChipBootloader, AnImageForAnotherBoardIsRefusedAndNothingIsErased) {
  write_slot(slot_a, program(), true);
  enter_bootloader();
  const std::vector<std::uint8_t> foreign =
      other_program([](image::Header& header, std::vector<std::uint8_t>& /*body*/) { header.board_id = 2; });
  EXPECT_EQ(flash(foreign), ReceiverState::refused);
  EXPECT_TRUE(holds(slot_a, program()));
  leave_bootloader();
  EXPECT_TRUE(starts_program());
}

TEST_F(ChipBootloader, TwoResetsByThePinWithinHalfASecondAreAWayIn) {
  write_slot(slot_a, program(), true);
  rig->power_on();
  ASSERT_TRUE(starts_program());
  rig->chip.pull_reset_pin();
  rig->run_for(5 * ms);
  rig->chip.pull_reset_pin();  // it bounces
  rig->run_for(250 * ms);
  rig->chip.pull_reset_pin();
  ASSERT_TRUE(sends_boot_up());
  EXPECT_FALSE(is_program());
}

TEST_F(ChipBootloader, OneResetByThePinStartsTheProgramHoweverItBouncesAndWheneverTheNextOneComes) {
  write_slot(slot_a, program(), true);
  rig->power_on();
  ASSERT_TRUE(starts_program());
  for (unsigned press = 0; press < 2; ++press) {
    rig->chip.pull_reset_pin();
    rig->run_for(10 * ms);
    rig->chip.pull_reset_pin();
    ASSERT_TRUE(starts_program(s)) << press;
    EXPECT_NE(rig->board.console.find("started by reset pin"), std::string::npos) << rig->board.console;
  }
}

TEST_F(ChipBootloader, TheButtonIsAWayInAtEachResetButThoseBySoftware) {
  write_slot(slot_a, program(), true);
  rig->board.holds_recover = true;
  rig->power_on();
  ASSERT_TRUE(sends_boot_up());
  EXPECT_FALSE(is_program());
  rig->board.holds_recover = false;
  ASSERT_TRUE(starts_program(11 * s));
  rig->run_for(100 * ms);
  rig->board.holds_recover = true;
  rig->chip.pull_reset_pin();
  ASSERT_TRUE(sends_boot_up(s));
  EXPECT_FALSE(is_program());
}

TEST_F(ChipBootloader, AButtonThatIsStuckDelaysTheProgramByTenSecondsAtMost) {
  write_slot(slot_a, program(), true);
  rig->board.holds_recover = true;
  start_bootloader();
  ASSERT_TRUE(starts_program(11 * s)) << "the bootloader is within reach meanwhile";
  rig->host.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, 0}));
  EXPECT_TRUE(starts_program()) << "at once";
}

TEST_F(ChipBootloader, AButtonThatIsStuckDoesNotKeepAnImageFromBeingInstalled) {
  write_slot(slot_a, program(), true);
  rig->board.holds_recover = true;
  start_bootloader();
  ASSERT_TRUE(starts_program(11 * s));
  EXPECT_EQ(flash(newer_program()), ReceiverState::installed);
  leave_bootloader();
  EXPECT_TRUE(starts_program());
  EXPECT_TRUE(holds(slot_a, newer_program()));
}

TEST_F(ChipBootloader, WithoutACrystalNoStartOnTrialIsUsedUp) {
  write_slot(slot_a, program(), false);
  rig->chip.set_crystal(false);
  rig->power_on();
  rig->run_for(8 * s);
  EXPECT_EQ(rig->word(slot_a + slot_size - 12), 0xFFFF'FFFFU) << "the first start on trial";
  rig->chip.set_crystal(true);
  EXPECT_TRUE(starts_program(3 * s));
}

TEST_F(ChipBootloader, WithoutAProgramThatMayRunItStaysOnTheBus) {
  write_slot(slot_a, program(), false);
  for (unsigned start = 0; start < bootloader::Slots::max_attempts; ++start) {
    rig->power_on();
    ASSERT_TRUE(starts_program()) << start;
  }
  start_bootloader();
  EXPECT_FALSE(sends_boot_up(25 * s)) << "it starts again and again";
}

TEST_F(ChipBootloader, WithoutAHostItStartsTheProgramAfterTenSeconds) {
  write_slot(slot_a, program(), true);
  enter_bootloader();
  const BusTime start = rig->bus.now();
  EXPECT_TRUE(starts_program(11 * s));
  EXPECT_GT(rig->bus.now() - start, 9 * s);
}

TEST_F(ChipBootloader, AFreshChipKeepsTheNodeIdThatLssGivesIt) {
  make_chip(std::nullopt);
  rig->power_on();
  EXPECT_FALSE(sends_boot_up()) << "it has no node id";
  const auto lss = [this](std::uint8_t service, std::uint8_t first = 0) {
    rig->host.send({0x7E5, 8, {service, first}});
    rig->run_for(10 * ms);
  };
  lss(0x04, 1);  // CiA 305: configuration state for all
  lss(0x11, ChipRig::node);
  lss(0x17);
  lss(0x04, 0);
  write_slot(slot_a, program(), true);
  rig->power_on();
  EXPECT_TRUE(starts_program()) << "it has the node id from the flash";
}

TEST_F(ChipBootloader, TheProgramTakesAnImageWhileItRunsAndRestartsToInstallIt) {
  write_slot(slot_a, program(), true);
  start_program();
  const std::vector<std::uint8_t> newer = newer_program();
  FlashingHost& host = host_with(newer);
  const BusTime start = rig->bus.now();
  host.transfer();
  EXPECT_TRUE(holds(slot_a, program()));
  EXPECT_EQ(host.finish(), ReceiverState::installed);
  std::cout << newer.size() << " bytes to a program that runs, with a backup of it: " << (rig->bus.now() - start) / ms
            << " ms\n";
  EXPECT_TRUE(holds(slot_a, newer));
  EXPECT_TRUE(holds(slot_b, program()));
  leave_bootloader();
  EXPECT_TRUE(starts_program());
}

TEST_F(ChipBootloader, AnImageThatHasRunHalfASecondAndCanSendIsConfirmed) {
  namespace flag = broadcast::module_flag;
  write_slot(slot_a, program(), false);
  start_program();
  EXPECT_EQ(flags(), flag::runs_program | flag::has_image | flag::has_bootloader);
  rig->run_for(600 * ms);
  EXPECT_EQ(flags(), flag::runs_program | flag::has_image | flag::has_bootloader | flag::is_confirmed);
  for (unsigned start = 0; start <= bootloader::Slots::max_attempts; ++start) {
    start_program();
  }
}

TEST_F(ChipBootloader, AnImageThatNobodyHearsIsNotConfirmed) {
  write_slot(slot_a, program(), false);
  rig->host.switch_off();
  rig->power_on();
  rig->run_for(2 * s);
  EXPECT_EQ(rig->word(slot_a + slot_size - 16), 0xFFFF'FFFFU);
}

TEST_F(ChipBootloader, AConfirmedProgramThatStopsAgainAndAgainGivesTheBusToTheBootloader) {
  namespace flag = broadcast::module_flag;
  for (const std::uint16_t instruction : {std::uint16_t{0xBF30}, undefined_instruction}) {
    make_chip();
    write_slot(slot_a, program_that_starts_with(instruction), true);
    rig->power_on();
    const BusTime start = rig->bus.now();
    ASSERT_TRUE(sends_boot_up(15 * s));
    std::cout << "a confirmed program that does not start: the bootloader serves the bus after "
              << (rig->bus.now() - start) / ms << " ms\n";
    EXPECT_EQ(flags(), flag::has_image | flag::has_bootloader | flag::is_confirmed | flag::starts_badly);
    EXPECT_EQ(flash(program()), ReceiverState::installed);
    leave_bootloader();
    EXPECT_TRUE(starts_program());
  }
}

TEST_F(ChipBootloader, AModuleWhoseServoHasPowerInstallsNothing) {
  write_slot(slot_a, program(), true);
  start_program();
  rig->start_booted_robot(20'000);
  rig->enable_servo(0);
  EXPECT_NE(flags() & broadcast::module_flag::is_busy, 0);
  EXPECT_EQ(flash(newer_program()), ReceiverState::refused);
  rig->host.send(broadcast::enter_frame(serial));
  EXPECT_FALSE(sends_boot_up()) << "neither does it go into the bootloader";
  EXPECT_TRUE(holds(slot_a, program()));
}

TEST_F(ChipBootloader, ATenthOfTheFramesMayBeLost) {
  write_slot(slot_a, program(), true);
  start_program();
  lose_frames(5);
  const BusTime start = rig->bus.now();
  EXPECT_EQ(flash(newer_program()), ReceiverState::installed);
  std::cout << "with a tenth of the frames lost: " << (rig->bus.now() - start) / ms << " ms\n";
  rig->bus.set_loss_rule({});  // these requests are sent once
  leave_bootloader();
  EXPECT_TRUE(starts_program());
  EXPECT_TRUE(holds(slot_a, newer_program()));
}

/// A cut of the power in an update, which the flash model leaves behind as a chip may (docs/virtual-chip.md), and the
/// start after it.
class ChipPowerCut : public ChipBootloader {
 protected:
  struct FlashOperation {
    std::uint32_t address;
    bool is_erase;
  };

  /// From the request to install on: until operation `last` of the flash has begun, or the update is done.
  std::vector<FlashOperation> update_until(std::size_t last, bool loses_frames) {
    constexpr BusTime less_than_a_word = 10 * us;
    make_chip();
    write_slot(slot_a, program(), true);
    start_program();
    if (loses_frames) {
      lose_frames(static_cast<unsigned>(last));
    }
    std::vector<FlashOperation> operations;
    rig->chip.set_flash_watch([&operations](std::uint32_t address, bool is_erase) {
      operations.push_back({address, is_erase});
    });
    FlashingHost& host = host_with(newer_);
    host.transfer();
    rig->set_max_lead(less_than_a_word);
    unsigned leave_requests = 4;  // as host::RobotUpdate repeats it, since frames may be lost
    BusTime next_question = 0;
    EXPECT_TRUE(rig->run_until_true(
        [&] {
          is_leaving_ = is_leaving_ || host.is_installed();
          if (is_leaving_ && rig->bus.now() >= next_question) {
            if (leave_requests > 0) {
              --leave_requests;
              leave_bootloader();
            }
            rig->host.send(broadcast::status_frame(serial));  // a program that hears nobody is not confirmed
            next_question = rig->bus.now() + 200 * ms;
          }
          return operations.size() > last || holds_confirmed();
        },
        20 * s));
    is_leaving_ = false;
    rig->chip.set_flash_watch({});
    return operations;
  }
  [[nodiscard]] bool holds_confirmed() const {
    return is_leaving_ &&
           rig->word(slot_a + slot_size - bootloader::Slots::words_size) == bootloader::Slots::confirmed_word;
  }
  /// Cuts the power somewhere in the operation that has begun. 0: the old program runs afterwards, 1: the new one.
  std::size_t cut_and_start(bool is_erase, std::mt19937& random) {
    rig->run_for(is_erase ? random() % 1'000 * ms : random() % 12 * us);
    rig->set_max_lead(200 * us);
    rig->bus.set_loss_rule({});  // the questions that follow are sent once
    rig->power_on();
    EXPECT_TRUE(starts_program(5 * s));
    const bool is_old = holds(slot_a, program());
    EXPECT_TRUE(is_old || holds(slot_a, newer_));
    EXPECT_EQ(rig->read(0x1018, 4), serial);
    return is_old ? 0 : 1;
  }

  const std::vector<std::uint8_t> newer_ = newer_program();

 private:
  bool is_leaving_ = false;
};

TEST_F(ChipPowerCut, AtEveryKindOfOperationLeavesAProgramThatRunsWithTheSettings) {
  constexpr unsigned seed = 7;
  const std::uint32_t others = from_environment("PROLEG_CUTS", 0);
  const bool is_long = others != 0;
  std::mt19937 random(seed);
  const std::vector<FlashOperation> all = update_until(~std::size_t{0}, false);
  std::vector<std::size_t> chosen;
  unsigned erases = 0;
  unsigned words = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::uint32_t offset = (all[i].address - slot_a) % slot_size;
    const bool is_of_header = offset < image::header_size;
    const bool is_state = offset >= slot_size - bootloader::Slots::words_size;
    if (all[i].is_erase || (is_long && (is_state || is_of_header))) {
      chosen.push_back(i);
      ++(all[i].is_erase ? erases : words);
    }
  }
  for (unsigned i = 0; i < others; ++i) {
    chosen.push_back(random() % all.size());
  }
  EXPECT_EQ(erases, 2U) << "of both slots";
  std::array<unsigned, 2> runs{};
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", operation " + std::to_string(chosen[i]));
    const auto reached = update_until(chosen[i], i % 2 == 1);
    ASSERT_GT(reached.size(), chosen[i]);
    ++runs.at(cut_and_start(reached[chosen[i]].is_erase, random));
  }
  std::cout << all.size() << " operations of the flash in an update; power cut in " << erases << " erases, " << words
            << " words of headers and states, " << others << " others, half of them with a tenth of the frames lost "
            << "(seed " << seed << "): the old program runs " << runs[0] << " times, the new one " << runs[1]
            << " times\n";
}

}  // namespace
}  // namespace proleg::sim
