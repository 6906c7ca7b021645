// Which files are taken for the firmware of a module. What is wrong with an ELF file as such: tests/sim/mcu/cpu.

#include "sim/mcu/module/firmware_image.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace proleg::sim {
namespace {

std::string refusal(const std::string& file) {
  try {
    const FirmwareImage image(file);
  } catch (const ElfError& error) {
    return error.what();
  }
  return "";
}

TEST(FirmwareImage, KnowsWhereTheModuleKeepsItsLastTick) {
  const FirmwareImage image(PROLEG_IMAGE);
  EXPECT_GE(image.tick_record(), 0x2000'0000U);
  EXPECT_LT(image.tick_record(), 0x2002'0000U);
}

TEST(FirmwareImage, RefusesAProgramThatIsNoModule) {
  const std::string message = refusal(PROLEG_OTHER_PROGRAM);
  EXPECT_NE(message.find("proleg_tick_record"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(FirmwareImage, RefusesWhatIsNoProgram) {
  EXPECT_NE(refusal("/nowhere/x.elf").find("/nowhere/x.elf"), std::string::npos);
  EXPECT_NE(refusal(__FILE__), "");
}

}  // namespace
}  // namespace proleg::sim
