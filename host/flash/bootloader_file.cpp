#include "host/flash/bootloader_file.hpp"

#include <algorithm>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::host {
namespace {

using Bytes = std::span<const std::uint8_t>;

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
           "at most " + std::to_string(sector.size) + ", for which the sector of the bootloader has room");
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

std::vector<std::uint8_t> read_bootloader(const std::string& file, const FlashPart& sector) {
  // Debug information can make an ELF file larger than the bytes that are read; the loaded parts come before it.
  return bootloader_of(file, read_bytes(file, a_bootloader), sector);
}

}  // namespace proleg::host
