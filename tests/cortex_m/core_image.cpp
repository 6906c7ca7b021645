#include "tests/cortex_m/core_image.hpp"

#include <string>

namespace proleg::cortex_m {

std::filesystem::path core_image_file(Cpu cpu) {
  const std::string preset = cpu == Cpu::cortex_m4 ? "stm32f405" : "cortex-m0";
  const std::filesystem::path file = std::filesystem::path(PROLEG_CROSS_BUILD_DIR) / preset / "bin/core_image.elf";
  if (!std::filesystem::exists(file)) {
    throw sim::ElfError(file.string() +
                        ": found no such file, expected the test image; build it with \"cmake --preset " + preset +
                        " && cmake --build --preset " + preset + "\"");
  }
  return file;
}

}  // namespace proleg::cortex_m
