#pragma once

// Unicorn's Cortex-M4 (version 2.0.1): an independent program that executes the same instructions.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <unicorn/unicorn.h>

namespace proleg::sim {

class ReferenceCpu {
 public:
  static constexpr std::size_t register_count = 17;  ///< r0 to r15, xPSR
  using Registers = std::array<std::uint32_t, register_count>;

  /// Its memory: `size` bytes at `start`, both multiples of 4096. The chip's other memory is there, too, and all zeros.
  ReferenceCpu(std::uint32_t start, std::size_t size);
  ~ReferenceCpu();
  ReferenceCpu(const ReferenceCpu&) = delete;
  ReferenceCpu& operator=(const ReferenceCpu&) = delete;

  [[nodiscard]] std::span<std::uint8_t> memory() { return memory_; }

  struct Step {
    bool is_executed;  ///< without a fault
    Registers registers;
  };
  /// Executes the instruction of `size` bytes at registers[15], which is new there.
  [[nodiscard]] Step execute(const Registers& registers, std::uint32_t size);

 private:
  uc_engine* uc_ = nullptr;
  std::vector<std::uint8_t> buffer_;
  std::span<std::uint8_t> memory_;
};

}  // namespace proleg::sim
