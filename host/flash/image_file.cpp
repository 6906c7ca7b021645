#include "host/flash/image_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/image/board_names.hpp"

namespace proleg::host {
namespace {

using Bytes = std::span<const std::uint8_t>;

bool starts_with(Bytes bytes, std::string_view start) {
  return bytes.size() >= start.size() && std::equal(start.begin(), start.end(), bytes.begin());
}

bool are_digits(Bytes bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) {
    return (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'F') || (byte >= 'a' && byte <= 'f');
  });
}

/// Whether the text begins with a record of Intel HEX, which has at least the digits of length, address and checksum.
bool is_intel_hex(Bytes bytes) {
  constexpr std::size_t digits = 10;
  return bytes.size() > digits && bytes[0] == ':' && are_digits(bytes.subspan(1, digits));
}

bool is_s_record(Bytes bytes) {
  constexpr std::size_t digits = 8;
  return bytes.size() > 1 + digits && bytes[0] == 'S' && bytes[1] >= '0' && bytes[1] <= '9' &&
         are_digits(bytes.subspan(2, digits - 1));
}

/// Whether the first four words are a vector table: the stack pointer, in RAM, and three handlers, in the flash and
/// with the bit of Thumb.
bool has_vector_table(Bytes bytes) {
  constexpr std::size_t words = 4;
  if (bytes.size() < 4 * words) {
    return false;
  }
  const std::uint32_t stack = read_little_endian(bytes, 0, 4);
  constexpr std::uint32_t lowest_ram = 0x1000'0000;  // lowest RAM of an STM32F4; of most chips 0x20000000
  constexpr std::uint32_t end_of_code = 0x2000'0000;
  constexpr std::uint32_t end_of_ram = 0x4000'0000;
  bool holds = stack % 4 == 0 && stack > lowest_ram && stack <= end_of_ram;
  for (std::size_t i = 1; i < words; ++i) {
    const std::uint32_t handler = read_little_endian(bytes, 4 * i, 4);
    holds = holds && handler % 2 == 1 && handler < end_of_code;
  }
  return holds;
}

constexpr const char* an_image = "an image (.pimg)";
constexpr const char* damaged = ": the file is damaged, copy or build it again";

[[noreturn]] void refuse(const std::string& file, const std::string& found, const std::string& expected) {
  throw InputError(file, 0, found, expected);
}

/// Text that says where the image of a program in another format is, or how to make it.
std::string way_to_image(const std::string& file, ProgramFormat format) {
  const std::filesystem::path beside = std::filesystem::path(file).replace_extension(".pimg");
  std::error_code error;
  if (beside != file && std::filesystem::is_regular_file(beside, error)) {
    return ": " + beside.string() + " is beside it";
  }
  switch (format) {
    case ProgramFormat::elf:
    case ProgramFormat::intel_hex:
    case ProgramFormat::s_records:
      return "; 'objcopy -O binary' makes a raw binary of it, and 'proleg image make' an image of that";
    case ProgramFormat::raw:
      return "; 'proleg image make' puts a header in front of it";
    default:
      return ", which begins with PIMG";
  }
}

[[noreturn]] void refuse_header(const std::string& file, image::Error error, Bytes bytes) {
  switch (error) {
    case image::Error::too_short:
      refuse(file, "the first " + std::to_string(bytes.size()) + " bytes of an image",
             "a header of " + std::to_string(image::header_size) + " bytes and a body: the file is cut off");
    case image::Error::unknown_format:
      refuse(file,
             "an image of format " + std::to_string(read_little_endian(bytes, 4, 2)) + " with a header of " +
                 std::to_string(read_little_endian(bytes, 6, 2)) + " bytes",
             "format 1 with 512 bytes: a later version of this program may read it");
    case image::Error::damaged_header:
      refuse(file, "a header with the CRC-32 " + hexadecimal(read_little_endian(bytes, image::header_size - 4, 4), 8),
             hexadecimal(crc32(bytes.first(image::header_size - 4)), 8) + ", computed from its bytes" + damaged);
    case image::Error::impossible_value:
      refuse(file, "a header with an impossible value", "the values that docs/flashing.md lists");
    default:
      refuse(file, std::string(image::describe(error)), an_image);
  }
}

constexpr const char* a_bootloader = "a bootloader: an ELF file or a raw binary";
constexpr std::uint8_t erased = 0xFF;

// Offsets of the ELF specification (version 1.2, figures 1-3 and 2-1), for 32 bits.
constexpr std::size_t class_at = 4;
constexpr std::size_t data_at = 5;
constexpr std::size_t machine_at = 18;
constexpr std::size_t table_at = 28;
constexpr std::size_t entry_size_at = 42;
constexpr std::size_t entry_count_at = 44;
constexpr std::size_t elf_header_size = 52;
constexpr std::size_t entry_size = 32;
constexpr std::uint32_t loaded = 1;
constexpr std::uint32_t arm = 40;

[[noreturn]] void reject(const std::string& file, const std::string& found, const std::string& expected) {
  throw InputError(file, 0, found, expected);
}

std::string range_text(const FlashPart& sector) {
  return hexadecimal(sector.address, 8) + " to " + hexadecimal(sector.address + sector.size - 1, 8);
}

/// The bytes of the loaded parts of an ELF file, in their places in the flash (physical addresses).
std::vector<std::uint8_t> flash_contents(const std::string& file, Bytes elf, const FlashPart& sector) {
  if (elf.size() < elf_header_size || elf[class_at] != 1 || elf[data_at] != 1 ||
      read_little_endian(elf, machine_at, 2) != arm || read_little_endian(elf, entry_size_at, 2) != entry_size) {
    reject(file, "an ELF file for another processor, or a damaged one", "one for a 32-bit ARM, little-endian");
  }
  const std::size_t table = read_little_endian(elf, table_at, 4);
  const std::size_t count = read_little_endian(elf, entry_count_at, 2);
  std::vector<std::uint8_t> contents;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = table + i * entry_size;
    if (entry + entry_size > elf.size()) {
      reject(file, "an ELF file that is cut off", a_bootloader);
    }
    const std::size_t offset = read_little_endian(elf, entry + 4, 4);
    const std::uint32_t address = read_little_endian(elf, entry + 12, 4);
    const std::size_t size = read_little_endian(elf, entry + 16, 4);
    if (read_little_endian(elf, entry, 4) != loaded || size == 0) {
      continue;
    }
    // The sum needs 64 bits: that of two numbers of a damaged file may be more than 32 bits hold.
    if (address < sector.address || std::uint64_t{address} + size > std::uint64_t{sector.address} + sector.size) {
      reject(file,
             "a program with bytes from " + hexadecimal(address, 8) + " to " +
                 hexadecimal(static_cast<std::uint32_t>(address + size - 1), 8),
             "one for " + range_text(sector));
    }
    if (offset + size > elf.size()) {
      reject(file, "an ELF file that is cut off", a_bootloader);
    }
    const std::size_t start = address - sector.address;
    contents.resize(std::max(contents.size(), start + size), erased);
    std::ranges::copy(elf.subspan(offset, size), contents.begin() + static_cast<std::ptrdiff_t>(start));
  }
  return contents;
}

}  // namespace

ProgramFormat find_format(Bytes bytes) {
  if (starts_with(bytes, "PIMG")) {
    return ProgramFormat::image;
  }
  if (starts_with(bytes,
                  "\x7F"
                  "ELF")) {
    return ProgramFormat::elf;
  }
  if (is_intel_hex(bytes)) {
    return ProgramFormat::intel_hex;
  }
  if (is_s_record(bytes)) {
    return ProgramFormat::s_records;
  }
  return has_vector_table(bytes) ? ProgramFormat::raw : ProgramFormat::unknown;
}

std::string_view name_of(ProgramFormat format) {
  switch (format) {
    case ProgramFormat::image:
      return "an image";
    case ProgramFormat::elf:
      return "an ELF file";
    case ProgramFormat::intel_hex:
      return "an Intel HEX file";
    case ProgramFormat::s_records:
      return "a file of S-records";
    case ProgramFormat::raw:
      return "a raw binary, which begins with a vector table";
    case ProgramFormat::unknown:
      break;
  }
  return "a file of an unknown format";
}

std::vector<std::uint8_t> read_bytes(const std::string& file, const std::string& expected) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    refuse(file, "a folder", expected);
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> characters(max_image_size + 1);
  stream.read(characters.data(), static_cast<std::streamsize>(characters.size()));
  if (stream.bad() || (stream.fail() && !stream.eof())) {
    const std::string reason = errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : "";
    refuse(file, "no file that can be read" + reason, expected);
  }
  const auto size = static_cast<std::size_t>(stream.gcount());
  if (size == 0) {
    refuse(file, "an empty file", expected);
  }
  return {characters.begin(), characters.begin() + static_cast<std::ptrdiff_t>(size)};
}

image::Header read_image_header(const std::string& file, Bytes bytes) {
  // The format is checked before the size, because an ELF file may be larger than an image.
  const ProgramFormat format = find_format(bytes);
  if (format != ProgramFormat::image) {
    refuse(file, std::string(name_of(format)), an_image + way_to_image(file, format));
  }
  if (bytes.size() > max_image_size) {
    refuse(file, "more than " + std::to_string(max_image_size) + " bytes", "an image, which has at most as many");
  }
  const image::HeaderResult result = image::decode(bytes);
  if (result.error != image::Error::none) {
    refuse_header(file, result.error, bytes);
  }
  return result.header;
}

void check_image_body(const std::string& file, const image::Header& header, Bytes bytes) {
  const Bytes body = bytes.subspan(image::header_size);
  const image::Error error = image::check_body(header, body);
  if (error == image::Error::none) {
    return;
  }
  if (error == image::Error::wrong_length) {
    refuse(file, std::to_string(body.size()) + " bytes behind the header",
           std::to_string(header.length) + ", as the header says: " +
               (body.size() < header.length ? "the file is cut off" : "other bytes follow the image"));
  }
  const std::uint32_t crc = crc32(body);
  if (crc != header.crc) {
    refuse(file, "a body with the CRC-32 " + hexadecimal(crc, 8),
           hexadecimal(header.crc, 8) + ", as the header says" + damaged);
  }
  refuse(file, "a body with another SHA-256 than the header says, although the CRC-32 is right",
         "an image as it was made");
}

ImageFile read_image(const std::string& file) {
  ImageFile image{{}, read_bytes(file, an_image)};
  image.header = read_image_header(file, image.bytes);
  check_image_body(file, image.header, image.bytes);
  return image;
}

std::vector<std::uint8_t> bootloader_of(const std::string& file, Bytes bytes, const FlashPart& sector) {
  const ProgramFormat format = find_format(bytes);
  if (format != ProgramFormat::elf && format != ProgramFormat::raw) {
    reject(file, std::string(name_of(format)), a_bootloader);
  }
  std::vector<std::uint8_t> contents =
      format == ProgramFormat::elf ? flash_contents(file, bytes, sector) : std::vector(bytes.begin(), bytes.end());
  contents.resize((contents.size() + 3) / 4 * 4, erased);
  if (contents.size() > sector.size) {
    reject(file, std::to_string(contents.size()) + " bytes",
           "at most " + std::to_string(sector.size) + ", for which the place of the bootloader has room");
  }
  if (find_format(contents) != ProgramFormat::raw) {
    reject(file, "no vector table at " + hexadecimal(sector.address, 8), a_bootloader);
  }
  const std::uint32_t reset = read_little_endian(contents, 4, 4);
  if (reset < sector.address || reset - sector.address >= contents.size()) {
    reject(file, "the reset vector " + hexadecimal(reset, 8),
           "one within " + range_text(sector) + ", where the chip starts");
  }
  return contents;
}

std::uint16_t board_of_bootloader(Bytes bootloader) {
  constexpr std::uint32_t id_bits = 0xFFFF;
  constexpr std::uint16_t reference_board = 1;
  if (bootloader.size() < image::bootloader_board_at + 4) {
    return reference_board;
  }
  const std::uint32_t word = read_little_endian(bootloader, image::bootloader_board_at, 4);
  return (word & ~id_bits) == image::bootloader_board_mark ? static_cast<std::uint16_t>(word & id_bits)
                                                           : reference_board;
}

std::string board_text(std::uint16_t id) {
  const std::string_view name = image::board_name(id);
  return "board " + std::to_string(id) + (name.empty() ? "" : " (" + std::string(name) + ")");
}

std::vector<std::uint8_t> read_bootloader(const std::string& file, const FlashPart& sector) {
  // Debug information can make an ELF file larger than the bytes that are read; the loaded parts come before it.
  return bootloader_of(file, read_bytes(file, a_bootloader), sector);
}

}  // namespace proleg::host
