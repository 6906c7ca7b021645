// An image file is read as it was made, or refused with one line that a person can act on.
// A bootloader of a file becomes the bytes of its place, or is refused.

#include "host/flash/image_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr FlashPart the_place{0x0800'0000, 0x8000};

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

Bytes contents_of(const Bytes& file) { return bootloader_of("FILE", file, the_place); }

std::string refusal_of(const Bytes& file) {
  return message_of<InputError>([&] { static_cast<void>(contents_of(file)); });
}

TEST(BootloaderFiles, OfRawBytesAreTakenAsTheyAre) {
  for (const std::size_t size : {std::size_t{20}, std::size_t{0x8000}}) {
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
  EXPECT_EQ(refusal_of(program_of(0x8001)),
            "FILE: found 32772 bytes, expected at most 32768, for which the place of the bootloader has room");
  EXPECT_EQ(refusal_of(program_of(64, 0x0802'0211)),
            "FILE: found the reset vector 0x08020211, expected one within 0x08000000 to 0x08007FFF, where the chip "
            "starts");
  EXPECT_EQ(
      refusal_of(elf_of({{1, 0x0800'7FFC, Bytes(8, 0)}})),
      "FILE: found a program with bytes from 0x08007FFC to 0x08008003, expected one for 0x08000000 to 0x08007FFF");
  EXPECT_EQ(
      refusal_of(elf_of({{1, 0x07FF'FFFC, Bytes(8, 0)}})),
      "FILE: found a program with bytes from 0x07FFFFFC to 0x08000003, expected one for 0x08000000 to 0x08007FFF");
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

constexpr std::size_t body_size = 96;
constexpr unsigned seed = 3;

Bytes random_bytes(std::size_t size) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  std::ranges::generate(bytes, [&random] { return static_cast<std::uint8_t>(random()); });
  return bytes;
}

image::Header header_of(const Bytes& body) {
  image::Header header;
  header.board_id = 1;
  header.highest_revision = 3;
  header.version = {1, 2, 3};
  header.protocol = 0x0100;
  header.core_fingerprint = 0x8793'2128;
  header.settings_schema = 2;
  header.address = 0x0802'0200;
  header.commit.fill(0xC3);
  image::describe_body(header, body);
  return header;
}

Bytes image_of(const Bytes& body) {
  const image::HeaderBytes header = encode(header_of(body));
  Bytes bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// Both checks, as read_image() makes them.
std::string refusal(const Bytes& bytes) {
  return message_of<InputError>([&] { check_image_body("FILE", read_image_header("FILE", bytes), bytes); });
}

class ImageFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string written(const Bytes& bytes, const char* name = "module.pimg") const {
    const std::filesystem::path path = folder_ / name;
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path.string();
  }
  /// What follows the name of the file in the message of read_image().
  [[nodiscard]] static std::string refusal_of_file(const std::string& file) {
    const std::string message = message_of<InputError>([&] { static_cast<void>(read_image(file)); });
    EXPECT_TRUE(message.starts_with(file + ": ")) << message;
    return message.substr(std::min(message.size(), file.size() + 2));
  }

  TemporaryFolder folder_;
};

TEST_F(ImageFiles, AreReadAsTheyWereMade) {
  for (const std::size_t size : {std::size_t{4}, body_size, max_image_size - image::header_size}) {
    const Bytes body = random_bytes(size);
    const ImageFile image = read_image(written(image_of(body)));
    EXPECT_EQ(image.header, header_of(body));
    EXPECT_TRUE(std::ranges::equal(image.body(), body));
    EXPECT_EQ(image.bytes, image_of(body));
  }
}

TEST_F(ImageFiles, AreRefusedIfTheyCannotBeRead) {
  EXPECT_EQ(refusal_of_file((folder_ / "missing.pimg").string()),
            "found no file that can be read (No such file or directory), expected an image (.pimg)");
  EXPECT_EQ(refusal_of_file(folder_.path().string()), "found a folder, expected an image (.pimg)");
  EXPECT_EQ(refusal_of_file(written({})), "found an empty file, expected an image (.pimg)");
  // Nothing is mapped at address 0 of this process: the file opens, and reading it fails.
  EXPECT_EQ(refusal_of_file("/proc/self/mem"),
            "found no file that can be read (Input/output error), expected an image (.pimg)");
}

TEST_F(ImageFiles, AreRefusedIfTheyAreTooLarge) {
  constexpr const char* too_large = "found more than 1048576 bytes, expected an image, which has at most as many";
  EXPECT_EQ(refusal_of_file(written(image_of(random_bytes(max_image_size - image::header_size + 4)))), too_large);
  // A file that never ends is not read to its end.
  EXPECT_EQ(refusal_of_file("/dev/zero"),
            "found a file of an unknown format, expected an image (.pimg), which begins with PIMG");
}

// Debug information makes ELF files larger than any image.
TEST_F(ImageFiles, OfOtherFormatsAreNamedWhateverTheirSize) {
  constexpr const char* elf =
      "found an ELF file, expected an image (.pimg); 'objcopy -O binary' makes a raw binary of it, and 'proleg image "
      "make' an image of that";
  for (const std::size_t size : {std::size_t{8}, 2 * max_image_size}) {
    Bytes bytes{0x7F, 'E', 'L', 'F', 1, 1, 1, 0};
    bytes.resize(size);
    EXPECT_EQ(refusal_of_file(written(bytes)), elf);
  }
  const std::string hex = ":020000040802F0\r\n";
  EXPECT_EQ(refusal_of_file(written(Bytes(hex.begin(), hex.end()))),
            "found an Intel HEX file, expected an image (.pimg); 'objcopy -O binary' makes a raw binary of it, and "
            "'proleg image make' an image of that");
  const Bytes vectors{0, 8, 0, 0x20, 1, 4, 2, 8, 0x11, 4, 2, 8, 0x13, 4, 2, 8};
  EXPECT_EQ(refusal_of_file(written(vectors)),
            "found a raw binary, which begins with a vector table, expected an image (.pimg); 'proleg image make' puts "
            "a header in front of it");
}

TEST_F(ImageFiles, OfAProgramInAnotherFormatAreFoundBesideIt) {
  const std::filesystem::path program = written({0x7F, 'E', 'L', 'F', 1, 1, 1, 0}, "module.elf");
  const std::filesystem::path image = std::filesystem::path(program).replace_extension(".pimg");
  std::ofstream(image) << "PIMG";
  EXPECT_EQ(refusal_of_file(program),
            "found an ELF file, expected an image (.pimg): " + image.string() + " is beside it");
}

TEST(ImageBytes, AreRefusedWithAnyPartMissing) {
  const Bytes bytes = image_of(random_bytes(body_size));
  ASSERT_EQ(refusal(bytes), "");
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    const std::string message = refusal(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    const std::string expected =
        size < 4 ? "FILE: found a file of an unknown format, expected an image (.pimg), which begins with PIMG"
        : size < image::header_size
            ? "FILE: found the first " + std::to_string(size) +
                  " bytes of an image, expected a header of 512 bytes and a body: the file is cut off"
            : "FILE: found " + std::to_string(size - image::header_size) +
                  " bytes behind the header, expected 96, as the header says: the file is cut off";
    ASSERT_EQ(message, expected);
  }
}

TEST(ImageBytes, AreRefusedWithMoreBehindThem) {
  Bytes bytes = image_of(random_bytes(body_size));
  bytes.push_back('\n');
  EXPECT_EQ(refusal(bytes),
            "FILE: found 97 bytes behind the header, expected 96, as the header says: other bytes follow the image");
}

TEST(ImageBytes, AreRefusedWithAnyBitChanged) {
  const Bytes bytes = image_of(random_bytes(body_size));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes changed = bytes;
      changed[i] ^= static_cast<std::uint8_t>(1U << bit);
      const std::string expected = i < 4                    ? "found a file of an unknown format, expected"
                                   : i < 8                  ? "expected format 1 with 512 bytes"
                                   : i < image::header_size ? "found a header with the CRC-32 0x"
                                                            : "found a body with the CRC-32 0x";
      ASSERT_NE(refusal(changed).find(expected), std::string::npos)
          << "byte " << i << ", bit " << bit << ": " << refusal(changed);
    }
  }
}

// The values are those of zlib: python3 -c 'import zlib; print(hex(zlib.crc32(b"123456789" + bytes([0, 0, 1]))))'
TEST(ImageBytes, AreRefusedWithTheChecksumsThatDiffer) {
  const std::string characters = "123456789";
  Bytes body(characters.begin(), characters.end());
  body.resize(12);
  Bytes bytes = image_of(body);
  bytes.back() = 1;
  EXPECT_EQ(refusal(bytes),
            "FILE: found a body with the CRC-32 0x00D268A2, expected 0x77D55834, as the header says: the file is "
            "damaged, copy or "
            "build it again");
}

// The CRC of the header is right, as a program that makes images of its own may write it.
TEST(ImageBytes, AreRefusedWithAnImpossibleValue) {
  Bytes bytes = image_of(random_bytes(body_size));
  bytes[26] = 1;  // reserved
  write_little_endian(bytes, 508, 4, crc32(std::span(bytes).first(508)));
  EXPECT_EQ(refusal(bytes),
            "FILE: found a header with an impossible value, expected the values that docs/flashing.md lists");
}

TEST(ImageBytes, AreRefusedIfOnlyTheCrcOfTheBodyIsRight) {
  const Bytes body = random_bytes(body_size);
  image::Header header = header_of(body);
  header.hash[0] ^= 1U;
  const image::HeaderBytes encoded = encode(header);
  Bytes bytes = image_of(body);
  std::ranges::copy(encoded, bytes.begin());
  EXPECT_EQ(refusal(bytes),
            "FILE: found a body with another SHA-256 than the header says, although the CRC-32 is right, expected an "
            "image as it was made");
}

}  // namespace
}  // namespace proleg::host
