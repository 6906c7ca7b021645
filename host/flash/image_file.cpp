#include "host/flash/image_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "host/flash/program_format.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::host {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr const char* an_image = "an image (.pimg)";
constexpr const char* damaged = ": the file is damaged, copy or build it again";

[[noreturn]] void refuse(const std::string& file, const std::string& found, const std::string& expected) {
  throw InputError(file, 0, found, expected);
}

/// What makes an image of a program in another format.
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
  // First: an ELF file may be larger than an image.
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
