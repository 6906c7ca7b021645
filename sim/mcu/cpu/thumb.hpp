#pragma once

// Thumb instructions: their length, and their memory access, by which the one that caused a fault is found.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace proleg::sim {

/// Length in bytes of the Thumb instruction that begins with this halfword (ARMv7-M reference manual, A5.1).
[[nodiscard]] constexpr std::size_t instruction_size(std::uint16_t first_halfword) {
  return (first_halfword >> 11U) >= 0x1DU ? 4 : 2;
}

/// Whether an instruction belongs to a coprocessor: the FPU is numbers 10 and 11, and the core uses no other
/// (ARMv7-M reference manual, A5.3.18).
[[nodiscard]] constexpr bool is_coprocessor_instruction(std::uint16_t first_halfword) {
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

struct MemoryAccess {
  std::uint32_t first = 0;  ///< lowest address
  std::uint32_t size = 0;   ///< bytes from there
  bool is_store = false;
};

/// The access of the instruction of these two halfwords (ARMv7-M, A5.2 and A5.3); the second counts for instructions of
/// four bytes. registers: r0 to r15 before it, r15 being its own address. Nothing if it is neither load nor store.
[[nodiscard]] std::optional<MemoryAccess> memory_access(std::uint16_t first, std::uint16_t second,
                                                        std::span<const std::uint32_t, 16> registers);

}  // namespace proleg::sim
