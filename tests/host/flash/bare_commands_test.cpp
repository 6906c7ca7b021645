// The commands that flash an empty chip write what they should, where they should, and nothing else.
// tests/tools/proleg/flash_bare_test.py runs them.
//
// Of what openocd, dfu-util and stm32flash print, a person gets one line: what was found, what was expected, what to
// do. The texts are those of the versions in Debian 12. tests/tools/proleg/flash_bare_test.py has more, from the
// programs.

#include "host/flash/bare_commands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace proleg::host {
namespace {

std::string failure(BareProbe probe, const std::string& output, bool is_for_other_bootloader = false) {
  BarePlan plan;
  plan.probe = probe;
  return bare_failure(plan, {"write the image", {"tool", "-x"}, "", "", is_for_other_bootloader}, output);
}

TEST(BareFailures, OfOpenocdAreExplained) {
  EXPECT_EQ(
      failure(BareProbe::stlink, "Info : clock speed 2000 kHz\nError: open failed\n\n"),
      "found no ST-LINK, expected one on USB: plug it in, 'lsusb -d 0483:' lists it; the command can be repeated");
  EXPECT_EQ(failure(BareProbe::stlink, "Error: libusb_open() failed with LIBUSB_ERROR_ACCESS\nError: open failed\n"),
            "found a probe without the rights to open it, expected rights: the udev rules 70-proleg.rules "
            "(docs/installing.md) give them to you; the command can be repeated");
  EXPECT_EQ(failure(BareProbe::stlink, "Error: init mode failed (unable to connect to the target)\n"),
            "found a probe without a chip, expected an STM32F405 behind it: check SWDIO, SWCLK, ground, and the "
            "board's supply; the command can be repeated");
}

TEST(BareFailures, OfTheScriptAreItsOwnWords) {
  EXPECT_EQ(failure(BareProbe::stlink, "Info\nrefused: found the read protection 0x55, expected 0xAA\nshutdown\n"),
            "found the read protection 0x55, expected 0xAA");
}

TEST(BareFailures, OfDfuAreExplained) {
  EXPECT_EQ(failure(BareProbe::dfu, "dfu-util: No DFU capable USB device available\n"),
            "found no DFU device, expected an STM32F405 on USB: set BOOT0 to high, reset the board, 'lsusb -d "
            "0483:df11' lists it; the command can be repeated");
  EXPECT_EQ(failure(BareProbe::dfu, "dfu-util: Cannot open device: LIBUSB_ERROR_ACCESS\n").substr(0, 52),
            "found a DFU device without the rights to open it, ex");
  EXPECT_EQ(failure(BareProbe::dfu, "dfu-util: More than one DFU capable USB device found! Try `--list'\n"),
            "found several DFU devices, expected one: pull the plugs of the others; the command can be repeated");
}

TEST(BareFailures, OfAUartAreExplained) {
  EXPECT_EQ(failure(BareProbe::uart, "Failed to init device, timeout.\n"),
            "found no answer on the line, expected the ROM bootloader: set BOOT0 to high, reset the board, check the "
            "wires; the command can be repeated");
}

TEST(BareFailures, OfAnotherKindNameTheStep) {
  for (const BareProbe probe : {BareProbe::stlink, BareProbe::dfu, BareProbe::uart}) {
    EXPECT_EQ(failure(probe, "something new\n"),
              "found an error of tool in the step 'write the image', expected none: its last lines say more; the "
              "command can be repeated");
  }
}

TEST(BareFailures, OfTheBootloaderNameTheWriteProtection) {
  EXPECT_EQ(
      failure(BareProbe::dfu, "dfu-util: ERASE_PAGE not correctly executed\n", true),
      "found an error of tool in the step 'write the image', expected none: its last lines say more; if sectors 0 "
      "and 1 are write-protected, flash with --probe stlink; the command can be repeated");
  EXPECT_EQ(
      bare_difference({"read the bootloader back", {}, "", "", true}),
      "found other bytes in the step 'read the bootloader back' than were written, expected the same; if sectors 0 "
      "and 1 are write-protected, flash with --probe stlink; the command can be repeated");
}

TEST(BareFailures, OfMissingProgramsNameThePackage) {
  EXPECT_EQ(
      missing_program("openocd"),
      "found no program openocd, expected the Debian package of that name: 'sudo apt install openocd' installs it");
}

using Words = std::vector<std::string>;

/// The flash of the reference board: docs/board.md, Flash.
BarePlan plan_of(BareProbe probe) {
  BarePlan plan;
  plan.probe = probe;
  plan.port = probe == BareProbe::uart ? "/dev/ttyUSB0" : "";
  plan.bootloader = {0x0800'0000, 0x8000};
  plan.settings = {0x0800'8000, 0x8000};
  plan.image = {0x0802'0000, 0x2'0000};
  plan.bootloader_size = 23'588;
  plan.image_size = 63'796;
  return plan;
}

BarePlan plan_with_settings(BareProbe probe) {
  BarePlan plan = plan_of(probe);
  plan.settings_size = settings_file_size(plan, 32);
  return plan;
}

std::vector<std::string> texts_of(const BarePlan& plan) {
  std::vector<std::string> texts;
  for (const BareStep& step : bare_steps(plan)) {
    texts.push_back(shell_text(step.command));
  }
  return texts;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// OpenOCD User's Guide, sections 8.2, 12.4.10.
TEST(BareCommands, OfAnStLinkRunOneScript) {
  EXPECT_EQ(texts_of(plan_of(BareProbe::stlink)),
            Words{"openocd -f interface/stlink.cfg -f target/stm32f4x.cfg -f bare.tcl"});
  EXPECT_TRUE(sets_option_bytes(BareProbe::stlink));
}

TEST(BareCommands, OfOtherProbesAtSwdSelectItSinceTheyHaveJtagToo) {
  EXPECT_EQ(texts_of(plan_of(BareProbe::jlink)),
            Words{"openocd -f interface/jlink.cfg -c 'transport select swd' -f target/stm32f4x.cfg -f bare.tcl"});
  EXPECT_EQ(texts_of(plan_of(BareProbe::cmsis_dap)),
            Words{"openocd -f interface/cmsis-dap.cfg -c 'transport select swd' -f target/stm32f4x.cfg -f bare.tcl"});
  for (const BareProbe probe : {BareProbe::jlink, BareProbe::cmsis_dap}) {
    EXPECT_TRUE(sets_option_bytes(probe));
    EXPECT_EQ(bare_script(plan_with_settings(probe)), bare_script(plan_with_settings(BareProbe::stlink)));
  }
}

TEST(BareCommands, OfDfuReadBackWhatTheyWrite) {
  EXPECT_EQ(texts_of(plan_with_settings(BareProbe::dfu)),
            (Words{"dfu-util -d ,0483:df11 -a 0 -s 0x08000000:23588 -U present.bin",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08008000 -D settings.bin",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08008000:32768 -U read_settings.bin",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08020000 -D image.pimg",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08020000:63796 -U read_image.pimg",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08000000 -D bootloader.bin",
                   "dfu-util -d ,0483:df11 -a 0 -s 0x08000000:23588 -U read_bootloader.bin"}));
}

// Without a length stm32flash erases up to the end of the flash, and with it the sectors that it covers.
TEST(BareCommands, OfAUartEraseTheirSectorsOnly) {
  EXPECT_EQ(texts_of(plan_with_settings(BareProbe::uart)),
            (Words{"stm32flash -b 115200 -r present.bin -S 0x08000000:23588 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -f -w settings.bin -S 0x08008000:32768 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -r read_settings.bin -S 0x08008000:32 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -f -w image.pimg -S 0x08020000:131072 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -r read_image.pimg -S 0x08020000:63796 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -f -w bootloader.bin -S 0x08000000:32768 /dev/ttyUSB0",
                   "stm32flash -b 115200 -c -r read_bootloader.bin -S 0x08000000:23588 /dev/ttyUSB0"}));
}

TEST(BareCommands, WriteTheBootloaderLastAndOnlyIfItIsAnother) {
  for (const BareProbe probe : {BareProbe::dfu, BareProbe::uart}) {
    const std::vector<BareStep> steps = bare_steps(plan_with_settings(probe));
    ASSERT_EQ(steps.size(), 7U);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      EXPECT_EQ(steps[i].is_for_other_bootloader, i >= 5) << steps[i].what;
    }
    EXPECT_EQ(steps.front().result, bare_file::present);
    EXPECT_EQ(steps.front().expected, "") << "any bootloader, or none";
    EXPECT_EQ(steps.back().expected, bare_file::bootloader);
  }
}

TEST(BareCommands, LeaveTheSettingsWithoutABoardRecord) {
  for (const BareProbe probe : {BareProbe::stlink, BareProbe::dfu, BareProbe::uart}) {
    std::string all = bare_script(plan_of(probe));
    for (const std::string& text : texts_of(plan_of(probe))) {
      all += text;
    }
    EXPECT_FALSE(contains(all, "settings"));
    EXPECT_FALSE(contains(all, "0x08008000"));
  }
}

// AN3155 and AN3156 have commands for the protection; none of the options of the programs that use them appears.
TEST(BareCommands, OfTheRomBootloaderSetNoOptionBytesAndEraseNoWholeFlash) {
  for (const BareProbe probe : {BareProbe::dfu, BareProbe::uart}) {
    EXPECT_FALSE(sets_option_bytes(probe));
    for (const BareStep& step : bare_steps(plan_with_settings(probe))) {
      for (const std::string& word : step.command) {
        EXPECT_FALSE(contains(word, "1FFF") || contains(word, "1fff")) << word;
        EXPECT_FALSE(contains(word, "mass-erase") || contains(word, "unprotect") || contains(word, "force")) << word;
        EXPECT_EQ(std::ranges::count(Words{"-j", "-k", "-u", "-o", "-e"}, word), 0) << word;
      }
    }
  }
}

TEST(BareScript, ErasesOnlyWhatItWritesInTheOrderThatCanBeRepeated) {
  const std::string script = bare_script(plan_with_settings(BareProbe::stlink));
  std::size_t at = 0;
  for (const char* part :
       {"init\n", "reset halt\n", "flash erase_address 0x08008000 32768\n",
        "flash write_image settings.bin 0x08008000 bin\n", "verify_image settings.bin 0x08008000 bin\n",
        "flash erase_address 0x08020000 131072\n", "flash write_image image.pimg 0x08020000 bin\n",
        "verify_image image.pimg 0x08020000 bin\n", "dump_image present.bin 0x08000000 23588\n",
        "flash protect 0 0 1 off\n", "flash erase_address 0x08000000 32768\n",
        "flash write_image bootloader.bin 0x08000000 bin\n", "verify_image bootloader.bin 0x08000000 bin\n",
        "stm32f2x options_write 0 ", "flash protect 0 0 1 on\n", "reset run\n", "shutdown\n"}) {
    const std::size_t found = script.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << " is not behind the parts before it";
    at = found;
  }
  for (const char* part : {"mass_erase", "lock 0", "write_image erase", "0x40023C08", "mww"}) {
    EXPECT_FALSE(contains(script, part)) << part;
  }
}

TEST(BareText, CanBeTypedIntoAShell) {
  EXPECT_EQ(shell_text({"stm32flash", "-S", "0x08000000:32768", "/dev/ttyUSB0"}),
            "stm32flash -S 0x08000000:32768 /dev/ttyUSB0");
  EXPECT_EQ(shell_text({"a b", "", "it's", "$x"}), R"('a b' '' 'it'\''s' '$x')");
}

}  // namespace
}  // namespace proleg::host
