#pragma once

// Files with images of modules: the header (shared/image/image_header.hpp) and the body, as they are sent over the bus
// and written into flash, and nothing else. Their names end with .pimg; no program depends on the name.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/image/image_header.hpp"

namespace proleg::host {

/// Bytes of a file that is read into memory: no chip of a module has more flash.
inline constexpr std::size_t max_image_size = 1024 * 1024;
/// Bytes of a body for which a slot of the reference board has room: 88 KiB, less the header (docs/board.md).
inline constexpr std::uint32_t slot_room = 88 * 1024 - image::header_size;

struct ImageFile {
  image::Header header;
  std::vector<std::uint8_t> bytes;  ///< header and body

  [[nodiscard]] std::span<const std::uint8_t> body() const { return std::span(bytes).subspan(image::header_size); }
};

/// The contents of a file, of a larger one the first max_image_size + 1 bytes. Throws InputError, with `expected`, if
/// it is no file that can be read, or is empty.
[[nodiscard]] std::vector<std::uint8_t> read_bytes(const std::string& file, const std::string& expected);

/// The header at the beginning of a file's bytes; the body is not looked at. file: its name, for messages. Throws
/// InputError if there is no image, if it has more than max_image_size bytes, or if its header is damaged or of another
/// version.
[[nodiscard]] image::Header read_image_header(const std::string& file, std::span<const std::uint8_t> bytes);

/// Throws InputError if what follows the header is not the body that the header describes.
void check_image_body(const std::string& file, const image::Header& header, std::span<const std::uint8_t> bytes);

/// An intact image. Throws InputError for anything else. Whether it fits to a board is a question for
/// image::check_place().
[[nodiscard]] ImageFile read_image(const std::string& file);

}  // namespace proleg::host
