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

using Bytes = std::span<const std::uint8_t>;

constexpr const char* an_image = "an image (.pimg)";
constexpr const char* damaged = ": the file is damaged, copy or build it again";

[[noreturn]] void refuse(const std::string& file, const std::string& found, const std::string& expected) {
  throw InputError(file, 0, found, expected);
}

/// Text that says how to make an image of a program in another format.
std::string way_to_image(ProgramFormat format) {
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
    refuse(file, std::string(name_of(format)), an_image + way_to_image(format));
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

}  // namespace proleg::host
