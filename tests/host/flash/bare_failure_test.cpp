// Of what openocd, dfu-util and stm32flash print, a person gets one line: what was found, what was expected, what to
// do. The texts are those of the versions in Debian 12. tests/tools/proleg/flash_bare_test.py has more, from the
// programs.

#include "host/flash/bare_failure.hpp"

#include <gtest/gtest.h>

#include <string>

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
            "found an ST-LINK without the rights to open it, expected rights: host/udev/70-proleg.rules gives them to "
            "you; the file says how to install it; the command can be repeated");
  EXPECT_EQ(failure(BareProbe::stlink, "Error: init mode failed (unable to connect to the target)\n"),
            "found an ST-LINK without a chip, expected an STM32F405 behind it: check SWDIO, SWCLK, ground, and the "
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
  EXPECT_EQ(failure(BareProbe::dfu, "dfu-util: ERASE_PAGE not correctly executed\n", true),
            "found an error of tool in the step 'write the image', expected none: its last lines say more; if sector 0 "
            "is write-protected, flash with --probe stlink; the command can be repeated");
  EXPECT_EQ(
      bare_difference({"read the bootloader back", {}, "", "", true}),
      "found other bytes in the step 'read the bootloader back' than were written, expected the same; if sector 0 "
      "is write-protected, flash with --probe stlink; the command can be repeated");
}

TEST(BareFailures, OfMissingProgramsNameThePackage) {
  EXPECT_EQ(
      missing_program("openocd"),
      "found no program openocd, expected the Debian package of that name: 'sudo apt install openocd' installs it");
}

}  // namespace
}  // namespace proleg::host
