// Chips that were flashed through their bootloader: what their flash holds, how they start, and what cannot be flashed.

#include "sim/mcu/module/flashed_chip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "changed_image.hpp"
#include "sim/hardware_loop/fault_run.hpp"
#include "sim/hardware_loop/native_program.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

constexpr std::array<std::uint32_t, 3> first_id{0x0123'4567, 0x89AB'CDEF, 0x5A5A'0F0F};
constexpr std::size_t slot_size = 128 * 1024;  // docs/board.md: the bootloader uses sector 5
constexpr std::uint16_t wait_for_interrupt = 0xBF30;
constexpr std::uint16_t undefined_instruction = 0xDE00;  // udf #0

const FlashedChip& flashed_chip() {
  static const FlashedChip chip = flash_chip(flashed_image(), PROLEG_BOOTLOADER, first_id);
  return chip;
}

/// A file that the build makes beside the image, by objcopy.
std::vector<std::uint8_t> built_file(const std::string& name) {
  const std::string text = file_contents(std::filesystem::path(PROLEG_IMAGE).parent_path() / name);
  EXPECT_FALSE(text.empty()) << name;
  return {text.begin(), text.end()};
}

/// What is at the addresses of a part of the flash; erased where nothing was written.
std::vector<std::uint8_t> contents(const FlashContents& flash, std::uint32_t begin, std::size_t size) {
  std::vector<std::uint8_t> bytes(size, 0xFF);
  for (const ElfImage::Segment& part : flash.parts) {
    for (std::size_t i = 0; i < part.bytes.size(); ++i) {
      const std::size_t offset = part.load_address - begin + i;
      if (part.load_address >= begin && offset < size) {
        bytes[offset] = part.bytes[i];
      }
    }
  }
  return bytes;
}

TEST(FlashedChip, HoldsTheImageThatWasSentWithTheWordsOfItsTrialAndItsConfirmation) {
  std::vector<std::uint8_t> expected = built_file("proleg_stm32f405.pimg");
  EXPECT_EQ(flashed_chip().image_size, expected.size());
  expected.resize(slot_size, 0xFF);
  // firmware/bootloader/slots.hpp: confirmed, and one start on trial.
  const std::array<std::uint8_t, 8> words{0x0D, 0x60, 0x0D, 0x60, 0, 0, 0, 0};
  std::ranges::copy(words, expected.end() - 16);
  EXPECT_EQ(contents(flashed_chip().flash, 0x0802'0000, slot_size), expected);
  EXPECT_TRUE(flashed_chip().problems.empty());
}

TEST(FlashedChip, HasTheBootloaderInItsFirstSector) {
  const std::vector<std::uint8_t> expected = built_file("proleg_boot_stm32f405.bin");
  EXPECT_EQ(contents(flashed_chip().flash, 0x0800'0000, expected.size()), expected);
}

TEST(FlashedChip, HasTheSameFlashWhateverItsUniqueIdIs) {
  for (const std::array<std::uint32_t, 3>& unique_id :
       {std::array<std::uint32_t, 3>{}, {1, 2, 3}, {0xFFFF'FFFF, 0xFFFF'FFFF, 0xFFFF'FFFF}}) {
    const FlashedChip other = flash_chip(flashed_image(), PROLEG_BOOTLOADER, unique_id);
    EXPECT_EQ(contents(other.flash, 0x0800'0000, 1024 * 1024),
              contents(flashed_chip().flash, 0x0800'0000, 1024 * 1024));
    EXPECT_EQ(other.start_time, flashed_chip().start_time);
  }
}

TEST(FlashedChip, TakesTwoToFourSecondsAndThenATenthOfASecondForEachStart) {
  std::cout << "a chip is flashed in " << flashed_chip().flash_time / 1'000'000 << " ms; its program starts after "
            << flashed_chip().start_time.value() / 1'000 << " us\n";
  // Erase and writing of 64 KiB take a second and a quarter (DS8626, table 41), the transfer about as long; half a
  // second on trial.
  EXPECT_GT(flashed_chip().flash_time, 2'000'000'000U);
  EXPECT_LT(flashed_chip().flash_time, 4'000'000'000U);
  EXPECT_NEAR(static_cast<double>(flashed_chip().start_time.value()) * 1e-3,
              static_cast<double>(NativeProgram::start_time_us), 1'000.0)
      << "what native modules need";
}

TEST(FlashedChips, CrawlBitForBitLikeTheSimulation) {
  const Scenario scenario = shipped("obstacle/reflex");
  Simulation simulation(scenario);
  VirtualRobot robot(scenario, {}, VirtualRobot::all, &flashed_chip().flash);
  robot.run_to(400);
  while (simulation.tick() < 400) {
    simulation.advance();
  }
  EXPECT_EQ(robot.loop().differences(), 0U);
  EXPECT_EQ(robot.loop().setpoint_hash().hex(), simulation.setpoint_hash().hex());
  EXPECT_EQ(robot.loop().servo_hash().hex(), simulation.servo_hash().hex());
  EXPECT_TRUE(std::ranges::all_of(
      robot.console, [](const auto& line) { return line.second.find("started by power on") != std::string::npos; }));
}

TEST(FlashedChips, ThatRestartJoinAgainAtTheSameTickAsNativeModules) {
  for (const std::uint32_t tick_us : {4'000U, 10'000U, 25'000U}) {
    Scenario scenario = shipped("travelling_wave/coupled");
    scenario.kernel.tick_period_us = tick_us;
    const auto run = [&](const VirtualRobot::Choice& is_virtual) {
      HardwareOptions options;
      options.restarts = {{100, 2}};
      options.start_time_us = static_cast<std::uint32_t>(flashed_chip().start_time.value() / 1'000);
      auto robot = std::make_unique<VirtualRobot>(scenario, std::move(options), is_virtual, &flashed_chip().flash);
      robot->run_to(160);
      return robot;
    };
    const auto chips = run(VirtualRobot::all);
    const auto native = run([](unsigned) { return false; });
    EXPECT_EQ(chips->loop().differences(), 0U);
    ASSERT_EQ(chips->joined.size(), 1U);
    EXPECT_GT(chips->joined[0].second, 100 + 93'000 / tick_us) << "a start takes 93 ms";
    EXPECT_EQ(chips->joined, native->joined) << "tick " << tick_us;
    EXPECT_EQ(chips->loop().setpoint_hash().hex(), native->loop().setpoint_hash().hex());
    EXPECT_EQ(chips->loop().servo_hash().hex(), native->loop().servo_hash().hex());
  }
}

TEST(FlashedChips, HaveNoLastTickUntilTheirProgramHasStarted) {
  VirtualRobot robot(shipped("travelling_wave/uniform"), {}, VirtualRobot::all, &flashed_chip().flash);
  robot.run_to(50);
  EXPECT_EQ(robot.module(2).last_tick().tick, 50U);
  robot.module(2).power_on(robot.now());
  robot.run_to(54);
  EXPECT_EQ(robot.module(2).last_tick().tick, firmware::TickRecord::none) << "its RAM holds noise";
}

TEST(FlashedChips, ThatAreResetOrLoseTheirSupplyHaveTheSetpointsOfNativeModules) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.robot.servo.period_us = 20'000;  // as in the campaigns (fault_campaign_test.cpp)
  const auto fault = [](FaultKind kind, std::uint64_t start_us, unsigned joint) {
    Fault made;
    made.kind = kind;
    made.start_us = start_us;
    made.joint = joint;
    return made;
  };
  Fault supply = fault(FaultKind::supply, 1'504'300, 3);  // 0 V
  supply.duration_us = 255'000;
  const FaultSchedule schedule{fault(FaultKind::reset, 1'004'300, 2), supply};
  const auto start_us = static_cast<std::uint32_t>(flashed_chip().start_time.value() / 1'000);
  const FaultRunResult chips = run_with_faults(
      scenario, schedule, 300,
      [](const ModuleParts& parts) {
        VirtualModuleOptions options;
        options.flash = &flashed_chip().flash;
        return std::make_unique<VirtualModule>(parts, flashed_image(), std::move(options));
      },
      start_us);
  const FaultRunResult native = run_with_faults(scenario, schedule, 300, nullptr, start_us);
  EXPECT_TRUE(chips.violations.empty());
  EXPECT_EQ(chips.ends, native.ends);
  EXPECT_EQ(chips.setpoint_hash, native.setpoint_hash);
  EXPECT_EQ(chips.servo_hash, native.servo_hash);
}

class BrokenChips : public testing::Test {
 protected:
  BrokenChips() : robot(shipped("travelling_wave/uniform"), {}, VirtualRobot::all, &flashed_chip().flash) {
    robot.run_to(20);
  }
  void replace(std::uint32_t address, std::initializer_list<std::uint16_t> instructions) {
    std::vector<std::uint8_t> bytes;
    for (const std::uint16_t instruction : instructions) {
      bytes.push_back(static_cast<std::uint8_t>(instruction));
      bytes.push_back(static_cast<std::uint8_t>(instruction >> 8U));
    }
    robot.module(2).chip().write(address, bytes);
  }
  VirtualRobot robot;
};

TEST_F(BrokenChips, AProgramThatHangsIsStartedByTheBootloaderAndReportsItsWatchdog) {
  const std::uint32_t address = flashed_image().flash().elf().symbol("proleg::firmware::Module::handle").address;
  std::array<std::uint8_t, 2> before{};
  robot.module(2).chip().read(address, before);
  replace(address, {0xE7FE});  // a branch to itself
  for (std::uint32_t tick = 20; !robot.was_noticed("watchdog") && tick < 100; ++tick) {
    robot.run_to(tick);
  }
  robot.module(2).chip().write(address, before);
  robot.run_to(150);
  EXPECT_TRUE(robot.was_noticed("reset by its watchdog"));
  EXPECT_TRUE(robot.was_noticed("0x6010")) << "EMCY: software reset, watchdog";
  ASSERT_EQ(robot.joined.size(), 1U);
  EXPECT_EQ(robot.joined[0].first, 2U);
}

TEST_F(BrokenChips, ABootloaderThatFailsIsReportedWithItsFunctions) {
  // movw r3, #0x3000; movt r3, #0x4001; str r3, [r3]: SPI1, which is not modelled.
  replace(FlashImage(PROLEG_BOOTLOADER).elf().symbol("reset_handler").address,
          {0xF243, 0x0300, 0xF2C4, 0x0301, 0x601B});
  robot.module(2).power_on(robot.now());
  robot.run_to(22);
  EXPECT_TRUE(robot.was_noticed("SPI1"));
  EXPECT_TRUE(robot.was_noticed("reset_handler"));
}

TEST_F(BrokenChips, AFaultOfAnotherProgramThanThatOfTheFileHasNoBackTrace) {
  const std::vector<std::uint8_t> newer = changed(flashed_image(), newer_version());
  robot.module(2).chip().write(0x0802'0000, std::span(newer).first(image::header_size));
  replace(flashed_image().flash().elf().symbol("proleg::firmware::Module::handle").address, {undefined_instruction});
  robot.run_to(22);
  EXPECT_TRUE(robot.was_noticed("undefined instruction"));
  EXPECT_TRUE(robot.was_noticed(std::string("no back trace: the image in the chip is not that of ") + PROLEG_IMAGE));
}

class RefusedFlashing : public testing::Test {
 protected:
  [[nodiscard]] static std::string refusal(const FirmwareImage& image, const std::filesystem::path& bootloader) {
    return message_of<ElfError>([&] { static_cast<void>(flash_chip(image, bootloader, first_id)); });
  }
  /// An ELF file whose image was changed.
  [[nodiscard]] FirmwareImage changed_image(const ImageChange& change) const {
    write_elf(folder / "changed.elf", flashed_image(), changed(flashed_image(), change));
    return FirmwareImage(folder / "changed.elf");
  }
  static void expect_line(const std::string& message, const std::vector<std::string>& words) {
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& word : words) {
      EXPECT_NE(message.find(word), std::string::npos) << message << "\nwithout: " << word;
    }
  }
  TemporaryFolder folder;
};

TEST_F(RefusedFlashing, NamesABootloaderThatIsMissing) {
  expect_line(refusal(flashed_image(), "/nowhere/boot.elf"), {"/nowhere/boot.elf: found no", "expected"});
}

TEST_F(RefusedFlashing, NamesAProgramThatIsNoBootloader) {
  expect_line(refusal(flashed_image(), PROLEG_IMAGE),
              {PROLEG_IMAGE, "found a program with bytes at 0x0802", "expected the bootloader", "below 0x08008000"});
  const std::filesystem::path other = std::filesystem::path(PROLEG_IMAGE).parent_path() / "cpu_programs.elf";
  expect_line(refusal(flashed_image(), other),
              {"cpu_programs.elf: found a program that sends no boot-up", "expected the bootloader"});
}

TEST_F(RefusedFlashing, NamesAnImageForAnotherBoard) {
  const FirmwareImage known =
      changed_image([](image::Header& header, std::vector<std::uint8_t>& /*body*/) { header.board_id = 2; });
  expect_line(
      refusal(known, PROLEG_BOOTLOADER),
      {"changed.elf: found an image for board 2 (olimex-stm32-p405), expected one for board 1 (reference), as the "
       "bootloader ",
       PROLEG_BOOTLOADER});
  const FirmwareImage unknown =
      changed_image([](image::Header& header, std::vector<std::uint8_t>& /*body*/) { header.board_id = 77; });
  expect_line(
      refusal(unknown, PROLEG_BOOTLOADER),
      {"changed.elf: found an image for board 77 (not known) at 0x08020200 that the bootloader refuses (it is for "
       "another board)",
       "expected an image for the board of ", PROLEG_BOOTLOADER, "at 0x08020200"});
}

TEST_F(RefusedFlashing, OfAProgramThatDoesNotRunLeavesItOnTrialAndReportsWhatItDid) {
  const std::vector<std::uint8_t> image = changed(flashed_image(), starts_with(wait_for_interrupt));
  const FlashedChip hangs = flash_chip(changed_image(starts_with(wait_for_interrupt)), PROLEG_BOOTLOADER, first_id);
  EXPECT_FALSE(hangs.start_time.has_value());
  std::vector<std::uint8_t> expected = image;
  expected.resize(slot_size, 0xFF);
  EXPECT_EQ(contents(hangs.flash, 0x0802'0000, slot_size), expected) << "no trial was used";
  ASSERT_FALSE(hangs.problems.empty());
  EXPECT_NE(hangs.problems[0].find("reset by its watchdog"), std::string::npos) << hangs.problems[0];
  const FlashedChip faults = flash_chip(changed_image(starts_with(undefined_instruction)), PROLEG_BOOTLOADER, first_id);
  EXPECT_FALSE(faults.start_time.has_value());
  ASSERT_FALSE(faults.problems.empty());
  EXPECT_NE(faults.problems[0].find("undefined instruction"), std::string::npos) << faults.problems[0];
  EXPECT_NE(faults.problems[0].find("reset_handler"), std::string::npos) << faults.problems[0];
}

}  // namespace
}  // namespace proleg::sim
