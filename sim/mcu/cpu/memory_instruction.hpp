#pragma once

// The memory access of an instruction, to find the one that caused a fault.

#include <cstdint>
#include <optional>
#include <span>

namespace proleg::sim {

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
