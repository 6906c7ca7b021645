#include "sim/mcu/cpu/elf_image.hpp"

#include <elf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tests/cortex_m/core_image.hpp"

namespace proleg::cortex_m {
namespace {

using sim::ElfError;

std::vector<char> bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Writes the bytes to a file of the running test and reads it as an image.
std::string error_of(const std::vector<char>& bytes) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) /
      (std::string("proleg_elf_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::string error = "no error";
  try {
    const ElfImage image(file);
  } catch (const ElfError& caught) {
    error = caught.what();
  }
  std::filesystem::remove(file);
  EXPECT_EQ(error == "no error" || error.starts_with(file.string() + ": found "), true) << error;
  return error;
}

TEST(ElfImage, NamesFunctionsByMangledAndByQualifiedName) {
  const ElfImage image(core_image_file(Cpu::cortex_m4));
  EXPECT_EQ(image.symbol("_ZN6proleg6Kernel7advanceEv").address, image.symbol("proleg::Kernel::advance").address);
  EXPECT_TRUE(image.symbol("proleg::Kernel::advance").is_function);
  EXPECT_FALSE(image.symbol("identity_trace").is_function);
}

TEST(ElfImage, DescribesAnAddressByItsFunction) {
  const ElfImage image(core_image_file(Cpu::cortex_m4));
  const std::uint32_t address = image.symbol("proleg::Kernel::advance").address;
  EXPECT_NE(image.describe(address + 2).find("(proleg::Kernel::advance()+2)"), std::string::npos);
  EXPECT_EQ(image.describe(0x60000000), "0x60000000");
}

TEST(ElfImage, AMissingSymbolIsAnErrorThatNamesIt) {
  const ElfImage image(core_image_file(Cpu::cortex_m4));
  try {
    static_cast<void>(image.symbol("no_such_function"));
    FAIL();
  } catch (const ElfError& error) {
    EXPECT_NE(std::string(error.what()).find("found 0 symbols \"no_such_function\", expected one"), std::string::npos);
  }
}

TEST(ElfImage, AMissingFileIsAnError) { EXPECT_THROW(ElfImage("no_such_file.elf"), ElfError); }

TEST(ElfImage, AFileOfAnotherFormatIsAnError) {
  EXPECT_NE(error_of({}).find("the end of the file at byte 0"), std::string::npos);
  EXPECT_NE(error_of(std::vector<char>(100, 'x')).find("without the ELF magic number"), std::string::npos);
}

TEST(ElfImage, AProgramForThisComputerIsAnError) {
  EXPECT_NE(error_of(bytes_of("/proc/self/exe")).find("not 32-bit little-endian"), std::string::npos);
}

TEST(ElfImage, AProgramForAnotherProcessorIsAnError) {
  std::vector<char> bytes = bytes_of(core_image_file(Cpu::cortex_m4));
  bytes[offsetof(Elf32_Ehdr, e_machine)] = EM_386;
  EXPECT_NE(error_of(bytes).find("machine 3, type 2"), std::string::npos);
}

TEST(ElfImage, ATruncatedProgramIsAnErrorWhereverItIsCut) {
  const std::vector<char> bytes = bytes_of(core_image_file(Cpu::cortex_m4));
  // The section headers are the last in the file, so every cut hits something.
  for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 37) {
    const std::string error = error_of({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_NE(error, "no error") << size;
  }
}

TEST(ElfImage, AStrippedProgramIsAnError) {
  std::vector<char> bytes = bytes_of(core_image_file(Cpu::cortex_m4));
  Elf32_Ehdr header;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.e_shnum = 0;
  std::memcpy(bytes.data(), &header, sizeof header);
  EXPECT_NE(error_of(bytes).find("no symbol"), std::string::npos);
}

}  // namespace
}  // namespace proleg::cortex_m
