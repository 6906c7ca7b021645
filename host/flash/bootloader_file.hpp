#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/flash/bare_commands.hpp"

namespace proleg::host {

/// A bootloader as the flash holds it: the bytes from the beginning of its sector, with 0xFF up to a multiple of 4. The
/// file is an ELF file (for a 32-bit ARM, little-endian) or a raw binary. file: its name, for messages. Throws
/// InputError for anything else, and for a bootloader that does not fit into the sector, or does not start there.
[[nodiscard]] std::vector<std::uint8_t> bootloader_of(const std::string& file, std::span<const std::uint8_t> bytes,
                                                      const FlashPart& sector);
/// Reads a file and returns bootloader_of() its bytes.
[[nodiscard]] std::vector<std::uint8_t> read_bootloader(const std::string& file, const FlashPart& sector);

}  // namespace proleg::host
