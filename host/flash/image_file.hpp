#pragma once

// Files with images of modules. They contain the header (shared/image/image_header.hpp) and the body, as they are sent
// over the bus and written into flash, and nothing else. Their names end with .pimg; no program depends on the name.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/flash/bare_commands.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::host {

/// The formats in which compilers and their tools write a program for a chip.
enum class ProgramFormat : std::uint8_t {
  unknown,
  image,      ///< an image (shared/image/image_header.hpp): it begins with PIMG
  elf,        ///< an ELF file, with addresses and debug information: it begins with 0x7F ELF
  intel_hex,  ///< text: a colon, and hexadecimal digits
  s_records,  ///< text of Motorola: S0 to S9, and hexadecimal digits
  raw,        ///< the bytes of the flash: they begin with the vector table of a Cortex-M (ARMv7-M, section B1.5.3)
};

/// Finds the format by the first bytes of a file.
[[nodiscard]] ProgramFormat find_format(std::span<const std::uint8_t> bytes);

/// The name of a format for messages: "an ELF file".
[[nodiscard]] std::string_view name_of(ProgramFormat format);

/// Greatest number of bytes of a file that is read into memory: no chip of a module has more flash.
inline constexpr std::size_t max_image_size = 1024 * 1024;
/// Greatest size of a body in a slot of the reference board: 88 KiB, less the header (docs/board.md).
inline constexpr std::uint32_t slot_room = 88 * 1024 - image::header_size;

struct ImageFile {
  image::Header header;
  std::vector<std::uint8_t> bytes;  ///< header and body

  [[nodiscard]] std::span<const std::uint8_t> body() const { return std::span(bytes).subspan(image::header_size); }
};

/// Reads the contents of a file, or the first max_image_size + 1 bytes of a larger file. Throws InputError, with
/// `expected`, if the file cannot be read or is empty.
[[nodiscard]] std::vector<std::uint8_t> read_bytes(const std::string& file, const std::string& expected);

/// Reads the header at the beginning of a file's bytes, without a look at the body. file: its name, for messages.
/// Throws InputError if there is no image, if it has more than max_image_size bytes, or if its header is damaged or of
/// another version.
[[nodiscard]] image::Header read_image_header(const std::string& file, std::span<const std::uint8_t> bytes);

/// Throws InputError if what follows the header is not the body that the header describes.
void check_image_body(const std::string& file, const image::Header& header, std::span<const std::uint8_t> bytes);

/// Reads an intact image. Throws InputError for any other file. image::check_place() decides whether the image fits a
/// board.
[[nodiscard]] ImageFile read_image(const std::string& file);

/// A bootloader as the flash holds it: the bytes from the beginning of its sector, with 0xFF up to a multiple of 4. The
/// file is an ELF file (for a 32-bit ARM, little-endian) or a raw binary. file: its name, for messages. Throws
/// InputError for anything else, and for a bootloader that does not fit into the sector, or does not start there.
[[nodiscard]] std::vector<std::uint8_t> bootloader_of(const std::string& file, std::span<const std::uint8_t> bytes,
                                                      const FlashPart& sector);
/// The id of the board for which a bootloader is (shared/image/board_names.hpp). One that names none is for the
/// reference board.
[[nodiscard]] std::uint16_t board_of_bootloader(std::span<const std::uint8_t> bootloader);

/// A board for messages: "board 3 (weact-stm32f405)", "board 77" for an id without a name.
[[nodiscard]] std::string board_text(std::uint16_t id);

/// Reads a file and returns bootloader_of() its bytes.
[[nodiscard]] std::vector<std::uint8_t> read_bootloader(const std::string& file, const FlashPart& sector);

}  // namespace proleg::host
