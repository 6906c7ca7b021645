// A bootloader of a file becomes the bytes of its sector, or is refused.

#include "host/flash/bootloader_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr FlashPart sector_0{0x0800'0000, 0x4000};

void append(Bytes& bytes, std::uint32_t value, unsigned size = 4) {
  for (unsigned i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i & 0xFFU));
  }
}

/// A vector table, and bytes that count.
Bytes program_of(std::size_t size, std::uint32_t reset = 0x0800'0011) {
  Bytes bytes;
  for (const std::uint32_t word : {0x2001'9000U, reset, 0x0800'0021U, 0x0800'0031U}) {
    append(bytes, word);
  }
  while (bytes.size() < size) {
    bytes.push_back(static_cast<std::uint8_t>(bytes.size()));
  }
  return bytes;
}

struct Part {
  std::uint32_t type = 1;  // PT_LOAD
  std::uint32_t physical_address = 0;
  Bytes bytes;
};

/// Tool Interface Standard, ELF specification 1.2: a header, a program header for each part, the parts.
Bytes elf_of(const std::vector<Part>& parts) {
  Bytes elf{0x7F, 'E', 'L', 'F', 1, 1, 1};
  elf.resize(16);
  for (const std::uint32_t half : {2U, 40U}) {
    append(elf, half, 2);
  }
  for (const std::uint32_t word : {1U, 0x0800'0010U, 52U, 0U, 0U}) {
    append(elf, word);
  }
  for (const std::uint32_t half : {52U, 32U, static_cast<std::uint32_t>(parts.size()), 40U, 0U, 0U}) {
    append(elf, half, 2);
  }
  auto offset = static_cast<std::uint32_t>(elf.size() + 32 * parts.size());
  for (const Part& part : parts) {
    const auto size = static_cast<std::uint32_t>(part.bytes.size());
    for (const std::uint32_t word : {part.type, offset, 0x2000'0000U, part.physical_address, size, size + 64, 5U, 4U}) {
      append(elf, word);
    }
    offset += size;
  }
  for (const Part& part : parts) {
    elf.insert(elf.end(), part.bytes.begin(), part.bytes.end());
  }
  return elf;
}

Bytes contents_of(const Bytes& file) { return bootloader_of("FILE", file, sector_0); }

std::string refusal_of(const Bytes& file) {
  return message_of<InputError>([&] { static_cast<void>(contents_of(file)); });
}

TEST(BootloaderFiles, OfRawBytesAreTakenAsTheyAre) {
  for (const std::size_t size : {std::size_t{20}, std::size_t{0x4000}}) {
    EXPECT_EQ(contents_of(program_of(size)), program_of(size));
  }
}

TEST(BootloaderFiles, AreFilledUpToWordsWithErasedBytes) {
  Bytes expected = program_of(21);
  expected.insert(expected.end(), 3, 0xFF);
  EXPECT_EQ(contents_of(program_of(21)), expected);
  EXPECT_EQ(contents_of(elf_of({{1, 0x0800'0000, program_of(21)}})), expected);
}

TEST(BootloaderFiles, OfElfAreWhatTheFlashHolds) {
  const Bytes whole = program_of(256);
  const Bytes first(whole.begin(), whole.begin() + 100);
  const Bytes second(whole.begin() + 100, whole.end());
  const Part debug{0, 0, Bytes(40, 1)};
  const Part no_bytes{1, 0x2000'0000, {}};
  EXPECT_EQ(contents_of(elf_of({{1, 0x0800'0064, second}, debug, no_bytes, {1, 0x0800'0000, first}})), whole);

  Bytes with_gap = first;
  with_gap.resize(200, 0xFF);
  with_gap.insert(with_gap.end(), second.begin(), second.end());
  EXPECT_EQ(contents_of(elf_of({{1, 0x0800'0000, first}, {1, 0x0800'00C8, second}})), with_gap);
}

TEST(BootloaderFiles, AreRefusedIfTheyAreNoBootloader) {
  EXPECT_EQ(refusal_of({'P', 'I', 'M', 'G'}),
            "FILE: found an image, expected a bootloader: an ELF file or a raw binary");
  EXPECT_EQ(refusal_of({'t', 'e', 'x', 't'}),
            "FILE: found a file of an unknown format, expected a bootloader: an ELF file or a raw binary");
  EXPECT_EQ(refusal_of(elf_of({})),
            "FILE: found no vector table at 0x08000000, expected a bootloader: an ELF file or a raw binary");
}

TEST(BootloaderFiles, AreRefusedIfTheyBelongElsewhere) {
  EXPECT_EQ(refusal_of(program_of(0x4001)),
            "FILE: found 16388 bytes, expected at most 16384, for which the sector of the bootloader has room");
  EXPECT_EQ(refusal_of(program_of(64, 0x0802'0211)),
            "FILE: found the reset vector 0x08020211, expected one within 0x08000000 to 0x08003FFF, where the chip "
            "starts");
  EXPECT_EQ(
      refusal_of(elf_of({{1, 0x0800'3FFC, Bytes(8, 0)}})),
      "FILE: found a program with bytes from 0x08003FFC to 0x08004003, expected one for 0x08000000 to 0x08003FFF");
  EXPECT_EQ(
      refusal_of(elf_of({{1, 0x07FF'FFFC, Bytes(8, 0)}})),
      "FILE: found a program with bytes from 0x07FFFFFC to 0x08000003, expected one for 0x08000000 to 0x08003FFF");
  Bytes other = elf_of({{1, 0x0800'0000, program_of(64)}});
  other[18] = 62;  // x86-64
  EXPECT_EQ(refusal_of(other),
            "FILE: found an ELF file for another processor, or a damaged one, expected one for a 32-bit ARM, "
            "little-endian");
}

// No part of a file leads to reads outside of it.
TEST(BootloaderFiles, AreRefusedWithAnyPartMissing) {
  const Bytes whole = elf_of({{1, 0x0800'0000, program_of(64)}});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(refusal_of(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))), "") << size;
  }
}

TEST(BootloaderFiles, WithAnyBitChangedAreReadOrRefused) {
  const Bytes whole = elf_of({{1, 0x0800'0000, program_of(64)}});
  for (std::size_t i = 4; i < whole.size(); ++i) {
    for (const unsigned bit : {0U, 3U, 7U}) {
      Bytes changed = whole;
      changed[i] ^= static_cast<std::uint8_t>(1U << bit);
      static_cast<void>(refusal_of(changed));
    }
  }
}

}  // namespace
}  // namespace proleg::host
