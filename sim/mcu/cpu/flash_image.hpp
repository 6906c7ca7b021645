#pragma once

// A program for the flash of an STM32F405, with all checks that are possible before it runs.

#include <cstdint>
#include <filesystem>

#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::sim {

class FlashImage {
 public:
  /// Throws ElfError, one line that names the file, what was found and what was expected: for what is no linked ARM
  /// program (see ElfImage); was compiled for another kind of CPU, or for the FPU; has segments outside the flash, or
  /// that overlap; or has no vector table at the start of the flash that leads into the program.
  explicit FlashImage(const std::filesystem::path& file);

  [[nodiscard]] const ElfImage& elf() const { return elf_; }

  /// There must be a vector table at this address, too, that leads into the program. Throws ElfError.
  void require_vector_table(std::uint32_t address) const;
  /// What is in flash at an address. Throws ElfError if nothing is.
  [[nodiscard]] std::uint32_t require_word(std::uint32_t address) const;

 private:
  ElfImage elf_;
};

}  // namespace proleg::sim
