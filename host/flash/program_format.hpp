#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace proleg::host {

/// What compilers and their tools make of a program for a chip.
enum class ProgramFormat : std::uint8_t {
  unknown,
  image,      ///< shared/image/image_header.hpp: it begins with PIMG
  elf,        ///< with addresses and debug information: it begins with 0x7F ELF
  intel_hex,  ///< text: a colon, and hexadecimal digits
  s_records,  ///< text of Motorola: S0 to S9, and hexadecimal digits
  raw,        ///< the bytes of the flash: they begin with the vector table of a Cortex-M (ARMv7-M, section B1.5.3)
};

/// By the first bytes of a file.
[[nodiscard]] ProgramFormat find_format(std::span<const std::uint8_t> bytes);

/// For messages: "an ELF file".
[[nodiscard]] std::string_view name_of(ProgramFormat format);

}  // namespace proleg::host
