#include "sim/mcu/cpu/flash_image.hpp"

#include <elf.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

using Bytes = std::vector<char>;

Bytes bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

class FlashImageTest : public testing::Test {
 protected:
  FlashImageTest()
      : file_(std::filesystem::path(testing::TempDir()) /
              (std::string("proleg_flash_image_") + testing::UnitTest::GetInstance()->current_test_info()->name())),
        valid_(bytes_of(image_file("cpu_programs"))) {}
  ~FlashImageTest() override { std::filesystem::remove(file_); }

  /// The error for a file with these bytes; empty: none.
  [[nodiscard]] std::string rejection(const Bytes& bytes) const {
    std::ofstream(file_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      const FlashImage image(file_);
    } catch (const ElfError& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with(file_.string() + ": found ")) << text;
      EXPECT_NE(text.find(", expected "), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text.substr(file_.string().size() + 2);
    }
    return {};
  }

  template <typename Record>
  static Record read(const Bytes& bytes, std::size_t offset) {
    Record record;
    std::memcpy(&record, &bytes.at(offset), sizeof record);
    return record;
  }
  template <typename Record>
  static void write(Bytes& bytes, std::size_t offset, const Record& record) {
    std::memcpy(&bytes.at(offset), &record, sizeof record);
  }

  /// Offset of the header of the segment that holds the vector table.
  [[nodiscard]] std::size_t first_segment() const {
    const auto header = read<Elf32_Ehdr>(valid_, 0);
    for (std::size_t i = 0; i < header.e_phnum; ++i) {
      const std::size_t offset = header.e_phoff + i * sizeof(Elf32_Phdr);
      const auto segment = read<Elf32_Phdr>(valid_, offset);
      if (segment.p_type == PT_LOAD && segment.p_paddr == ChipMemory::flash_start) {
        return offset;
      }
    }
    ADD_FAILURE() << "no segment with the vector table";
    return header.e_phoff;
  }

  template <typename Change>
  [[nodiscard]] std::string refusal_with_segment(Change change) const {
    Bytes bytes = valid_;
    auto segment = read<Elf32_Phdr>(bytes, first_segment());
    change(segment);
    write(bytes, first_segment(), segment);
    return rejection(bytes);
  }

  [[nodiscard]] std::string refusal_with_vectors(std::uint32_t stack, std::uint32_t start) const {
    Bytes bytes = valid_;
    const auto segment = read<Elf32_Phdr>(bytes, first_segment());
    write(bytes, segment.p_offset, stack);
    write(bytes, segment.p_offset + 4, start);
    return rejection(bytes);
  }

  std::filesystem::path file_;
  Bytes valid_;
};

TEST_F(FlashImageTest, AProgramForThisChipIsAccepted) {
  EXPECT_EQ(rejection(valid_), "");
  EXPECT_EQ(FlashImage(image_file("cpu_programs")).elf().segments()[0].load_address, ChipMemory::flash_start);
}

TEST_F(FlashImageTest, AProgramForCortexM0IsAcceptedToo) {
  const std::filesystem::path other =
      std::filesystem::path(PROLEG_CROSS_BUILD_DIR) / "cortex-m0" / "bin" / "core_image.elf";
  if (!std::filesystem::exists(other)) {
    GTEST_SKIP() << "the preset cortex-m0 was not built";
  }
  EXPECT_NO_THROW(FlashImage{other});
}

TEST_F(FlashImageTest, AFileThatIsNotElfIsRejected) {
  EXPECT_EQ(rejection(Bytes(1000, 'x')), "found a file without the ELF magic number, expected an ARM program");
}

TEST_F(FlashImageTest, AProgramForThisComputerIsRejected) {
  EXPECT_EQ(rejection(bytes_of("/proc/self/exe")),
            "found a program that is not 32-bit little-endian, expected an ARM program");
}

TEST_F(FlashImageTest, OtherMachinesTypesAndByteOrdersAreRejected) {
  for (const std::size_t offset :
       {offsetof(Elf32_Ehdr, e_machine), offsetof(Elf32_Ehdr, e_type), std::size_t{EI_DATA}}) {
    Bytes bytes = valid_;
    bytes[offset] = static_cast<char>(bytes[offset] + 1);
    EXPECT_NE(rejection(bytes), "") << offset;
  }
}

TEST_F(FlashImageTest, AProgramForAnotherChipIsRejectedWithItsAddress) {
  for (const std::uint32_t address : {0x0000'0000U, 0x0001'0000U, 0x1000'0000U}) {
    const std::string text = refusal_with_segment([&](Elf32_Phdr& segment) { segment.p_paddr = address; });
    EXPECT_NE(text.find(", a program for another chip, expected all of it in the flash at 0x8000000"),
              std::string::npos)
        << text;
  }
}

TEST_F(FlashImageTest, AProgramThatDoesNotFitIsRejected) {
  const std::string text = refusal_with_segment(
      [](Elf32_Phdr& segment) { segment.p_paddr = ChipMemory::flash_start + ChipMemory::flash_size - 16; });
  EXPECT_NE(text.find("expected at most 1048576 bytes from 0x8000000 on"), std::string::npos) << text;
}

TEST_F(FlashImageTest, SegmentsThatOverlapAreRejected) {
  Bytes bytes = valid_;
  auto header = read<Elf32_Ehdr>(bytes, 0);
  const auto segment = read<Elf32_Phdr>(bytes, first_segment());
  // A second table of segments at the end of the file.
  header.e_phoff = static_cast<Elf32_Off>(bytes.size());
  header.e_phnum = 2;
  bytes.resize(bytes.size() + 2 * sizeof segment);
  write(bytes, header.e_phoff, segment);
  auto second = segment;
  second.p_paddr += 4;
  write(bytes, header.e_phoff + sizeof segment, second);
  write(bytes, 0, header);
  EXPECT_EQ(rejection(bytes), "found segments at 0x8000000 and 0x8000004 that overlap, expected each address once");
}

TEST_F(FlashImageTest, OffsetsBeyondTheFileAreRejected) {
  const std::string text = refusal_with_segment([](Elf32_Phdr& segment) { segment.p_offset = 0x7FFF'FFFF; });
  EXPECT_TRUE(text.starts_with("found the end of the file at byte ")) << text;
}

TEST_F(FlashImageTest, AProgramWithoutVectorTableIsRejected) {
  const std::string text = refusal_with_segment([](Elf32_Phdr& segment) { segment.p_paddr += 0x10000; });
  EXPECT_EQ(text, "found nothing at 0x8000000, expected the vector table");
}

TEST_F(FlashImageTest, TheInitialStackPointerMustEndAMemory) {
  const std::uint32_t start = ChipMemory::flash_start + 0x201;
  EXPECT_EQ(refusal_with_vectors(ChipMemory::ram_start + ChipMemory::ram_size, start), "");
  EXPECT_EQ(refusal_with_vectors(ChipMemory::ccm_start + ChipMemory::ccm_size, start), "");
  for (const std::uint32_t stack : {0U, ChipMemory::ram_start, ChipMemory::ram_start + ChipMemory::ram_size + 4,
                                    ChipMemory::ram_start + 1026, 0xFFFF'FFFFU, ChipMemory::flash_start + 1024}) {
    EXPECT_TRUE(refusal_with_vectors(stack, start)
                    .starts_with("found a vector table at 0x8000000 with the initial stack pointer "))
        << stack;
  }
}

TEST_F(FlashImageTest, TheStartAddressMustBeThumbCodeOfTheProgram) {
  const std::uint32_t stack = ChipMemory::ram_start + ChipMemory::ram_size;
  for (const std::uint32_t start :
       {0U, ChipMemory::flash_start + 0x200, ChipMemory::flash_start + ChipMemory::flash_size - 1,
        ChipMemory::ram_start + 1, 0xFFFF'FFFFU}) {
    EXPECT_TRUE(
        refusal_with_vectors(stack, start).starts_with("found a vector table at 0x8000000 with the start address "))
        << start;
  }
}

TEST_F(FlashImageTest, AProgramThatPassesArgumentsInTheFpuIsRejected) {
  Bytes bytes = valid_;
  auto header = read<Elf32_Ehdr>(bytes, 0);
  header.e_flags |= EF_ARM_ABI_FLOAT_HARD;
  write(bytes, 0, header);
  EXPECT_EQ(rejection(bytes),
            "found a program that passes arguments in the FPU, expected one compiled with -mfloat-abi=soft");
}

TEST_F(FlashImageTest, AProgramForAnApplicationProcessorIsRejected) {
  const auto header = read<Elf32_Ehdr>(valid_, 0);
  bool changed = false;
  Bytes bytes = valid_;
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const auto section = read<Elf32_Shdr>(valid_, header.e_shoff + i * sizeof(Elf32_Shdr));
    if (section.sh_type != SHT_ARM_ATTRIBUTES) {
      continue;
    }
    // Tag_CPU_arch 13 and Tag_CPU_arch_profile 'M', as gcc writes them one behind the other.
    for (std::size_t at = section.sh_offset; at + 3 < section.sh_offset + section.sh_size; ++at) {
      if (bytes[at] == 6 && bytes[at + 1] == 13 && bytes[at + 2] == 7 && bytes[at + 3] == 'M') {
        bytes[at + 1] = 10;
        bytes[at + 3] = 'A';
        changed = true;
      }
    }
  }
  ASSERT_TRUE(changed);
  EXPECT_TRUE(rejection(bytes).starts_with("found a program for architecture 10, expected one for a Cortex-M4"));
}

TEST_F(FlashImageTest, CorruptedFilesAreReadOrRefusedButNeverMore) {
  constexpr unsigned seed = 405;
  constexpr int corruptions = 2000;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937 random(seed);
  const auto header = read<Elf32_Ehdr>(valid_, 0);
  int refused = 0;
  for (int i = 0; i < corruptions; ++i) {
    Bytes bytes = valid_;
    const unsigned changes = 1 + random() % 8;
    for (unsigned k = 0; k < changes; ++k) {
      // Where it hurts, as often as anywhere: the headers, the tables of segments and sections.
      std::size_t place = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          place = random() % sizeof(Elf32_Ehdr);
          break;
        case 1:
          place = header.e_phoff + random() % (header.e_phnum * sizeof(Elf32_Phdr));
          break;
        case 2:
          place = header.e_shoff + random() % (header.e_shnum * sizeof(Elf32_Shdr));
          break;
        default:
          break;
      }
      bytes[place] = static_cast<char>(random());
    }
    if (random() % 8 == 0) {
      bytes.resize(random() % bytes.size());
    }
    refused += rejection(bytes).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, corruptions / 4);
  EXPECT_LT(refused, corruptions);
}

}  // namespace
}  // namespace proleg::sim
