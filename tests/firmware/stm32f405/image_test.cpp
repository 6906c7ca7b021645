// The image that is flashed, as a file: its size, its addresses, and parts that it must not contain.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "firmware/module/board_record.hpp"
#include "firmware/module/tick_record.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/image/image_header.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/mcu/cpu/elf_image.hpp"
#include "tests/cortex_m/code_audit.hpp"

namespace proleg {
namespace {

using sim::ElfImage;

// Addresses of docs/board.md, and of RM0090, tables 1 and 5.
constexpr std::uint32_t flash_start = 0x0800'0000;  // of the bootloader or the start stub
constexpr std::uint32_t start_size = 32 * 1024;
constexpr std::uint32_t slot_a = 0x0802'0000;
constexpr std::uint32_t slot_a_size = 384 * 1024;
constexpr std::uint32_t image_body = slot_a + image::header_size;
constexpr std::uint32_t ram = 0x2000'0000;
constexpr std::uint32_t ram_size = 128 * 1024;

// Limits of an image.
constexpr std::uint32_t max_image_size = 88 * 1024;
constexpr std::uint32_t max_ram_size = 24 * 1024;

std::filesystem::path built(const std::string& name) {
  std::filesystem::path file = std::filesystem::path(PROLEG_STM32F405_BIN) / name;
  if (!std::filesystem::exists(file)) {
    throw std::runtime_error(file.string() +
                             ": found no such file, expected the image; build it with \"cmake --preset stm32f405 && "
                             "cmake --build --preset stm32f405\"");
  }
  return file;
}

std::uint32_t word_at(const std::vector<std::uint8_t>& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word |= std::uint32_t{bytes.at(offset + i)} << (8U * i);
  }
  return word;
}

class ImageTest : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] std::map<std::string, std::uint32_t> sizes() const {
    std::ifstream in(built(GetParam() + ".size.tsv"));
    std::map<std::string, std::uint32_t> table;
    std::string name;
    std::uint32_t value = 0;
    while (in >> name >> value) {
      table[name] = value;
    }
    return table;
  }
  /// The bytes from an address of the flash on, as in the segments; 0xFF between segments.
  [[nodiscard]] std::vector<std::uint8_t> flash(std::uint32_t start, std::uint32_t size) const {
    std::vector<std::uint8_t> bytes;
    for (const ElfImage::Segment& segment : image_.segments()) {
      if (segment.load_address >= start && segment.load_address < start + size) {
        const std::size_t offset = segment.load_address - start;
        bytes.resize(std::max(bytes.size(), offset + segment.bytes.size()), 0xFF);
        std::copy(segment.bytes.begin(), segment.bytes.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
      }
    }
    return bytes;
  }

  ElfImage image_{built(GetParam() + ".elf")};
};

TEST_P(ImageTest, UsesNoFpuAndNoOtherCoprocessor) {
  ASSERT_FALSE(image_.code().empty());
  EXPECT_EQ(cortex_m::coprocessor_instructions(image_, image_.code()), std::vector<std::string>());
}

TEST_P(ImageTest, HasNoFloatingPointHelperAndNoHeap) {
  for (const ElfImage::Symbol& symbol : image_.symbols()) {
    EXPECT_FALSE(cortex_m::is_floating_point_helper(symbol.name)) << symbol.name;
    EXPECT_FALSE(cortex_m::is_heap_function(symbol.name)) << symbol.name;
    EXPECT_EQ(symbol.name.find("printf"), std::string::npos) << symbol.name;
  }
}

TEST_P(ImageTest, KeepsToItsLimitsOfFlashRamAndStack) {
  auto table = sizes();
  EXPECT_GT(table["flash"], 0U);
  EXPECT_LE(table["flash"], max_image_size);
  EXPECT_LE(table["ram"] + table["stack"], max_ram_size);
  EXPECT_GT(table["stack_bound"], 0U);
  EXPECT_LE(table["stack_bound"], table["stack"]);
  EXPECT_EQ(table["flash_limit"], max_image_size);
  EXPECT_EQ(table["ram_limit"], max_ram_size);
  EXPECT_EQ(table["flash"], flash(slot_a, slot_a_size).size());
}

TEST_P(ImageTest, LiesWhereTheChipStartsAndInSlotAOnly) {
  for (const ElfImage::Segment& segment : image_.segments()) {
    const std::uint32_t end = segment.load_address + static_cast<std::uint32_t>(segment.bytes.size());
    const bool is_at_start = segment.load_address >= flash_start && end <= flash_start + start_size;
    const bool is_in_slot_a = segment.load_address >= slot_a && end <= slot_a + slot_a_size;
    EXPECT_TRUE(is_at_start || is_in_slot_a) << std::hex << segment.load_address << " to " << end;
  }
}

TEST_P(ImageTest, HasAVectorTableBehindItsHeaderWhoseEveryEntryIsAFunctionOfTheImage) {
  constexpr std::size_t vectors = 16 + 82;  // RM0090, table 61
  std::vector<std::uint8_t> bytes = flash(slot_a, slot_a_size);
  bytes.erase(bytes.begin(), bytes.begin() + image::header_size);
  const std::uint32_t stack = word_at(bytes, 0);
  EXPECT_EQ(stack, image_.symbol("stack_top").address);
  EXPECT_GT(stack, ram);
  EXPECT_LE(stack, ram + ram_size);
  EXPECT_EQ(stack % 8, 0U);
  EXPECT_EQ(word_at(bytes, 4), image_.symbol("reset_handler").address | 1U);
  for (std::size_t i = 1; i < vectors; ++i) {
    const std::uint32_t entry = word_at(bytes, 4 * i);
    EXPECT_EQ(entry & 1U, 1U) << i;
    const auto is_there = [&](const ElfImage::Symbol& symbol) {
      return symbol.is_function && symbol.address == (entry & ~1U);
    };
    EXPECT_TRUE(std::any_of(image_.symbols().begin(), image_.symbols().end(), is_there)) << i;
  }
  // Positions from the same table, and PendSV's from PM0214, table 17.
  for (const auto& [position, handler] : {std::pair{14U, "pend_sv_handler"},
                                          {16U + 1U, "pvd_handler"},
                                          {16U + 19U, "can1_tx_handler"},
                                          {16U + 20U, "can1_rx0_handler"},
                                          {16U + 22U, "can1_sce_handler"},
                                          {16U + 16U, "dma1_stream5_handler"},
                                          {16U + 17U, "dma1_stream6_handler"},
                                          {16U + 38U, "usart2_handler"},
                                          {16U + 50U, "tim5_handler"},
                                          {3U, "fault_handler"},
                                          {16U + 21U, "fault_handler"}}) {
    EXPECT_EQ(word_at(bytes, 4 * position), image_.symbol(handler).address | 1U) << handler;
  }
}

TEST_P(ImageTest, TheStartStubIsWhereTheChipStarts) {
  const std::vector<std::uint8_t> bytes = flash(flash_start, start_size);
  EXPECT_GT(word_at(bytes, 0), ram);
  EXPECT_LE(word_at(bytes, 0), ram + ram_size);
  EXPECT_EQ(word_at(bytes, 4), image_.symbol("stub_reset").address | 1U);
  EXPECT_LT(word_at(bytes, 4), flash_start + bytes.size());
}

TEST_P(ImageTest, TheImageFileIsSlotAAndNothingElseWithARightHeader) {
  std::ifstream in(built(GetParam() + ".pimg"), std::ios::binary);
  const std::vector<std::uint8_t> file{std::istreambuf_iterator<char>(in), {}};
  EXPECT_TRUE(file == flash(slot_a, slot_a_size));
  EXPECT_EQ(image::check_image(file, {1, 1, image_body, max_image_size - image::header_size}), image::Error::none);
  const image::Header header = image::decode(file).header;
  EXPECT_EQ(header.core_fingerprint, core_fingerprint);
  EXPECT_EQ(header.protocol, canopen::protocol_version);
  EXPECT_EQ(header.settings_schema, firmware::BoardRecord::schema);
}

/// While flash is erased the CPU cannot read it, so the code that waits is in RAM.
TEST_P(ImageTest, TheCodeInRamCallsAndReadsNothingOutsideRam) {
  const std::uint32_t start = image_.symbol("ram_code_start").address;
  const std::uint32_t end = image_.symbol("ram_code_end").address;
  ASSERT_GT(end, start + 32) << "there is some";
  const auto segment = std::ranges::find_if(image_.segments(), [&](const ElfImage::Segment& it) {
    return it.load_address == image_.symbol("ram_code_load").address && it.bytes.size() >= end - start;
  });
  ASSERT_NE(segment, image_.segments().end());
  for (std::uint32_t offset = 0; offset + 4 <= end - start; offset += 2) {
    // ARMv7-M, A7.7.18 (BL), A7.7.12 (B, T4) and A7.7.19 (BLX, BX other than LR).
    const std::uint32_t first = word_at(segment->bytes, offset) & 0xFFFFU;
    const std::uint32_t second = word_at(segment->bytes, offset) >> 16U;
    EXPECT_FALSE((first & 0xF800U) == 0xF000U && (second & 0x9000U) == 0x9000U) << "BL or B at offset " << offset;
    EXPECT_TRUE((first & 0xFF00U) != 0x4700U || first == 0x4770U) << "BX or BLX at offset " << offset;
    if (offset % 4 == 0) {
      const std::uint32_t word = word_at(segment->bytes, offset);
      EXPECT_FALSE(word >= flash_start && word < flash_start + 1024 * 1024)
          << "an address in flash at offset " << offset;
    }
  }
}

TEST_P(ImageTest, TheStackEndsWhereTheRamDoesSoThatAnOverflowIsAFault) {
  EXPECT_EQ(image_.symbol("stack_bottom").address, ram);
}

INSTANTIATE_TEST_SUITE_P(Images, ImageTest, testing::Values("proleg_stm32f405", "driver_tests"),
                         [](const auto& name) { return name.param; });

// What follows from the bootloader's place beside the module's program.
TEST(BootloaderImageTest, LiesWhereTheChipStartsAndUsesTheRamThatIsNotTheProgramsOrTheImagesBuffer) {
  const ElfImage image(built("proleg_boot_stm32f405.elf"));
  for (const ElfImage::Segment& segment : image.segments()) {
    EXPECT_GE(segment.load_address, flash_start);
    EXPECT_LE(segment.load_address + segment.bytes.size(), flash_start + start_size);
  }
  const std::uint32_t buffer = image.symbol("image_buffer_start").address;
  const std::uint32_t buffer_end = image.symbol("image_buffer_end").address;
  EXPECT_GE(buffer, ram + max_ram_size) << "the record of a fault that the program has left";
  EXPECT_GE(buffer_end - buffer, max_image_size);
  EXPECT_GE(image.symbol("stack_bottom").address, buffer_end);
  EXPECT_LE(image.symbol("ram_end").address, 0x2001'FF00U) << "the words that it shares with the program";
  EXPECT_EQ(cortex_m::coprocessor_instructions(image, image.code()), std::vector<std::string>());
}

TEST(ModuleImageTest, ItsTickRecordIsFoundByName) {
  const ElfImage image(built("proleg_stm32f405.elf"));
  const ElfImage::Symbol& pointer = image.symbol("proleg_tick_record");
  for (const ElfImage::Segment& segment : image.segments()) {
    if (pointer.address >= segment.load_address && pointer.address < segment.load_address + segment.bytes.size()) {
      const std::uint32_t address = word_at(segment.bytes, pointer.address - segment.load_address);
      EXPECT_GE(address, ram);
      EXPECT_LE(address + sizeof(firmware::TickRecord), image.symbol("ram_end").address);
      EXPECT_EQ(address % alignof(firmware::TickRecord), 0U);
      return;
    }
  }
  FAIL() << "proleg_tick_record is not in flash";
}

}  // namespace
}  // namespace proleg
