#pragma once

#include <filesystem>

#include "tests/cortex_m/machine.hpp"

namespace proleg::cortex_m {

/// The test image for a CPU, as its cross preset builds it. Throws sim::ElfError, which names the command, if it was
/// not built.
[[nodiscard]] std::filesystem::path core_image_file(Cpu cpu);

}  // namespace proleg::cortex_m
