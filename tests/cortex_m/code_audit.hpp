#pragma once

#include <string>
#include <vector>

#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::cortex_m {

using sim::ElfImage;

/// Where code uses the FPU or another coprocessor: address and function of each such instruction.
[[nodiscard]] std::vector<std::string> coprocessor_instructions(const ElfImage& image,
                                                                const std::vector<ElfImage::Code>& code);

/// Whether a function of that name computes with floating point in software (Run-time ABI for the Arm Architecture,
/// section 4.1, and libgcc's names) or in the mathematics library.
[[nodiscard]] bool is_floating_point_helper(std::string_view name);

/// Whether a function of that name allocates memory.
[[nodiscard]] bool is_heap_function(std::string_view name);

}  // namespace proleg::cortex_m
