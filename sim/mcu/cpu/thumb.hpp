#pragma once

// What the first halfword of a Thumb instruction says.

#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::sim {

/// Length in bytes of the Thumb instruction that begins with this halfword (ARMv7-M reference manual, A5.1).
[[nodiscard]] inline std::size_t instruction_size(std::uint16_t first_halfword) {
  return (first_halfword >> 11U) >= 0x1DU ? 4 : 2;
}

/// Whether an instruction belongs to a coprocessor: the FPU is numbers 10 and 11, and the core uses no other
/// (ARMv7-M reference manual, A5.3.18).
[[nodiscard]] inline bool is_coprocessor_instruction(std::uint16_t first_halfword) {
  return (first_halfword & 0xEC00U) == 0xEC00U;
}

[[nodiscard]] inline std::uint16_t halfword_at(std::span<const std::uint8_t> code, std::size_t offset) {
  return static_cast<std::uint16_t>(code[offset] | code[offset + 1] << 8U);
}

/// Number of instructions in a stretch of code that begins and ends between instructions.
[[nodiscard]] inline std::size_t count_instructions(std::span<const std::uint8_t> code) {
  std::size_t count = 0;
  for (std::size_t offset = 0; offset + 1 < code.size(); offset += instruction_size(halfword_at(code, offset))) {
    ++count;
  }
  return count;
}

}  // namespace proleg::sim
