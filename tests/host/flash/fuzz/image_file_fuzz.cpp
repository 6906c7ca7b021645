// Files that should be images. Any bytes are an image that decodes to what was encoded, or are refused with one line.
// The first byte of the input decides what is made right, so that the inputs get behind the checksums: nothing, the
// start and the CRC of the header, or also the body and the bytes that are reserved.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/flash/image_file.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/image/image_header.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using test::require;

void make_header_right(std::vector<std::uint8_t>& bytes) {
  const std::string start = "PIMG\x01";
  std::copy(start.begin(), start.end(), bytes.begin());
  write_little_endian(bytes, 5, 3, 0x02'0000);
  write_little_endian(bytes, 508, 4, crc32(std::span(bytes).first(508)));
}

void make_body_right(std::vector<std::uint8_t>& bytes) {
  bytes[25] &= 1U;
  write_little_endian(bytes, 26, 3, 0);
  bytes[29] &= 0xFEU;
  std::fill(bytes.begin() + 160, bytes.begin() + 508, std::uint8_t{0});
  const std::span<const std::uint8_t> body = std::span(bytes).subspan(image::header_size);
  write_little_endian(bytes, 32, 4, static_cast<std::uint32_t>(body.size()));
  write_little_endian(bytes, 36, 4, crc32(body));
  const image::Sha256::Hash hash = image::sha256(body);
  std::copy(hash.begin(), hash.end(), bytes.begin() + 64);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const unsigned mode = data[0] % 3U;
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  const bool is_long = bytes.size() >= image::header_size;
  if (is_long && mode == 2) {
    make_body_right(bytes);
  }
  if (is_long && mode >= 1) {
    make_header_right(bytes);
  }
  try {
    const image::Header header = host::read_image_header("FILE", bytes);
    require(host::find_format(bytes) == host::ProgramFormat::image, "an image begins with PIMG");
    const image::HeaderBytes encoded = image::encode(header);
    require(std::equal(encoded.begin(), encoded.end(), bytes.begin()), "a header encodes to the bytes it came from");
    host::check_image_body("FILE", header, bytes);
    require(mode == 2, "a body is not accepted by chance");
    require(bytes.size() == image::header_size + header.length, "an image has header and body and nothing else");
  } catch (const InputError& error) {
    const std::string text = error.what();
    require(text.starts_with("FILE: found ") && text.find(", expected ") != std::string::npos, "the form of an error");
    require(text.find('\n') == std::string::npos, "an error is one line");
  }
  return 0;
}
