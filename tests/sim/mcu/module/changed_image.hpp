#pragma once

// Other versions of the image that is flashed.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "shared/fixed/little_endian.hpp"
#include "shared/image/image_header.hpp"
#include "sim/mcu/module/virtual_module.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {

using ImageChange = std::function<void(image::Header& header, std::vector<std::uint8_t>& body)>;

/// The checksums are those of the changed body.
inline std::vector<std::uint8_t> changed(const FirmwareImage& program, const ImageChange& change) {
  const std::vector<std::uint8_t> bytes = program.image();
  image::Header header = image::decode(bytes).header;
  std::vector<std::uint8_t> body(bytes.begin() + image::header_size, bytes.end());
  change(header, body);
  image::describe_body(header, body);
  const image::HeaderBytes header_bytes = image::encode(header);
  body.insert(body.begin(), header_bytes.begin(), header_bytes.end());
  return body;
}

inline ImageChange newer_version() {
  return [](image::Header& header, std::vector<std::uint8_t>& /*body*/) { ++header.version.minor; };
}

/// Its first instruction is replaced.
inline ImageChange starts_with(std::uint16_t instruction) {
  return [instruction](const image::Header& header, std::vector<std::uint8_t>& body) {
    const std::uint32_t entry = (read_little_endian(body, 4, 4) & ~1U) - header.address;
    write_little_endian(body, entry, 2, instruction);
  };
}

/// An ELF file like that of the program, with this image of the same length (ELF specification 1.2, figures 1-3, 2-1).
inline void write_elf(const std::filesystem::path& file, const FirmwareImage& program,
                      const std::vector<std::uint8_t>& image) {
  constexpr std::uint32_t slot_a = 0x0802'0000;  // docs/board.md
  std::string text = file_contents(program.file());
  std::vector<std::uint8_t> elf(text.begin(), text.end());
  const std::uint32_t headers = read_little_endian(elf, 28, 4);
  const std::uint32_t header_size = read_little_endian(elf, 42, 2);
  const std::uint32_t count = read_little_endian(elf, 44, 2);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t header = headers + i * header_size;
    const std::uint32_t offset = read_little_endian(elf, header + 4, 4);
    const std::uint32_t address = read_little_endian(elf, header + 12, 4);
    const std::uint32_t size = read_little_endian(elf, header + 16, 4);
    if (address >= slot_a && address - slot_a < image.size()) {
      std::copy_n(image.begin() + (address - slot_a), size, elf.begin() + offset);
    }
  }
  text.assign(elf.begin(), elf.end());
  std::ofstream(file, std::ios::binary) << text;
}

}  // namespace proleg::sim
