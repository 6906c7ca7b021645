#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim/mcu/cpu/flash_image.hpp"

namespace proleg::sim {

/// The firmware of a joint module, as linked for the reference board (firmware/stm32f405).
class FirmwareImage {
 public:
  /// Reads an ELF file. Throws ElfError if it is not a program for this chip, or not that of a joint module: one line
  /// that names the file, what was found and what was expected.
  explicit FirmwareImage(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const FlashImage& flash() const { return flash_; }
  /// The image that is flashed over the bus, with its header (shared/image/image_header.hpp). The build writes the same
  /// bytes to the file with the name .pimg.
  [[nodiscard]] std::vector<std::uint8_t> image() const;
  /// Address of the record of the module's last tick (firmware/module/tick_record.hpp).
  [[nodiscard]] std::uint32_t tick_record() const { return tick_record_; }

 private:
  std::filesystem::path file_;
  FlashImage flash_;
  std::uint32_t tick_record_;
};

}  // namespace proleg::sim
