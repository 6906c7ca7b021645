#include "host/flash/program_format.hpp"

#include <algorithm>
#include <string>

#include "shared/fixed/little_endian.hpp"

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

/// A record has at least the digits of length, address and checksum.
bool is_intel_hex(Bytes bytes) {
  constexpr std::size_t digits = 10;
  return bytes.size() > digits && bytes[0] == ':' && are_digits(bytes.subspan(1, digits));
}

bool is_s_record(Bytes bytes) {
  constexpr std::size_t digits = 8;
  return bytes.size() > 1 + digits && bytes[0] == 'S' && bytes[1] >= '0' && bytes[1] <= '9' &&
         are_digits(bytes.subspan(2, digits - 1));
}

/// The first four words: the stack pointer, in RAM, and three handlers, in the flash and with the bit of Thumb.
bool has_vector_table(Bytes bytes) {
  constexpr std::size_t words = 4;
  if (bytes.size() < 4 * words) {
    return false;
  }
  const std::uint32_t stack = read_little_endian(bytes, 0, 4);
  constexpr std::uint32_t lowest_ram = 0x1000'0000;  // of an STM32F4; most have theirs from 0x20000000 on
  constexpr std::uint32_t end_of_code = 0x2000'0000;
  constexpr std::uint32_t end_of_ram = 0x4000'0000;
  bool holds = stack % 4 == 0 && stack > lowest_ram && stack <= end_of_ram;
  for (std::size_t i = 1; i < words; ++i) {
    const std::uint32_t handler = read_little_endian(bytes, 4 * i, 4);
    holds = holds && handler % 2 == 1 && handler < end_of_code;
  }
  return holds;
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

}  // namespace proleg::host
