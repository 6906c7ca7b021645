// Which files are accepted as the firmware of a module. Errors of ELF files as such: tests/sim/mcu/cpu.

#include "sim/mcu/module/virtual_module.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace proleg::sim {
namespace {

std::string rejection(const std::string& file) {
  try {
    const FirmwareImage image(file);
  } catch (const ElfError& error) {
    return error.what();
  }
  return "";
}

TEST(FirmwareImage, FindsWhereTheModuleStoresItsLastTick) {
  const FirmwareImage image(PROLEG_IMAGE);
  EXPECT_GE(image.tick_record(), 0x2000'0000U);
  EXPECT_LT(image.tick_record(), 0x2002'0000U);
}

TEST(FirmwareImage, RejectsAProgramThatIsNotAModule) {
  const std::string message = rejection(PROLEG_OTHER_PROGRAM);
  EXPECT_NE(message.find("proleg_tick_record"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(FirmwareImage, RejectsAFileThatIsNotAProgram) {
  EXPECT_NE(rejection("/nowhere/x.elf").find("/nowhere/x.elf"), std::string::npos);
  EXPECT_NE(rejection(__FILE__), "");
}

}  // namespace
}  // namespace proleg::sim
