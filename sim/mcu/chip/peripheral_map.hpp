#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "sim/mcu/peripherals/chip_identity.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

/// The peripherals that answer the addresses of the AHB and APB buses (RM0090, table 1).
class PeripheralMap {
 public:
  /// A peripheral, and the register of an access.
  struct Place {
    Peripheral* peripheral;
    std::uint32_t offset;
    bool answers;  ///< whether its registers are known to answer
  };

  /// Adds a peripheral at its base(). It must outlive the map.
  void add(Peripheral& peripheral) {
    const Block block{&peripheral, peripheral.base(), peripheral.size(), false};
    for (std::uint32_t address = block.base; address < block.base + block.size; address += block_bytes) {
      blocks_.at((address - start) / block_bytes) = block;
    }
  }

  /// Throws UnmodelledAccess if the address has no peripheral, and for an access that is not a whole word. size: bytes.
  [[nodiscard]] Place find(std::uint32_t address, unsigned size) const {
    const std::uint32_t number = (address - start) / block_bytes;
    const Block block = number < block_count ? blocks_[number] : Block{};
    const std::uint32_t offset = address - block.base;
    if (block.peripheral == nullptr || offset >= block.size) {
      throw UnmodelledAccess(describe_address(address) + " is not modelled");
    }
    if (size != 4 || offset % 4 != 0) {
      throw UnmodelledAccess(block.peripheral->register_name(offset / 4 * 4) + ": an access of " +
                             std::to_string(size * 8) + " bits is not modelled");
    }
    return {block.peripheral, offset, block.answers};
  }

  /// Notes that the registers at an address answer: the peripheral has its clock and is not held in reset.
  void note_answer(std::uint32_t address) { blocks_.at((address - start) / block_bytes).answers = true; }
  /// To be called when clocks may have been switched off, or resets begun.
  void forget_answers() {
    for (Block& block : blocks_) {
      block.answers = false;
    }
  }

 private:
  static constexpr std::uint32_t start = 0x4000'0000;
  static constexpr std::uint32_t block_bytes = 0x400;  ///< no two peripherals share a block
  static constexpr std::uint32_t block_count = 0x8'0000 / block_bytes;

  struct Block {
    Peripheral* peripheral = nullptr;
    std::uint32_t base = 0;
    std::uint32_t size = 0;
    bool answers = false;
  };
  std::array<Block, block_count> blocks_{};
};

}  // namespace proleg::sim
