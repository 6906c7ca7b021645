#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "sim/mcu/peripherals/chip_identity.hpp"
#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim {

/// The peripherals that answer the addresses of the AHB and APB buses (RM0090, table 1).
class PeripheralMap {
 public:
  /// Adds a peripheral at its base(). It must outlive the map.
  void add(Peripheral& peripheral) {
    const std::uint32_t end = peripheral.base() + peripheral.size();
    for (std::uint32_t address = peripheral.base(); address < end; address += block_bytes) {
      blocks_.at((address - start) / block_bytes) = &peripheral;
    }
  }

  /// The peripheral at an address, and the offset of its register. Throws UnmodelledAccess if the address has no
  /// peripheral, and for an access that is not a whole word. size: bytes.
  [[nodiscard]] std::pair<Peripheral*, std::uint32_t> find(std::uint32_t address, unsigned size) const {
    const std::uint32_t block = (address - start) / block_bytes;
    Peripheral* const peripheral = block < block_count ? blocks_[block] : nullptr;
    if (peripheral == nullptr || address - peripheral->base() >= peripheral->size()) {
      throw UnmodelledAccess(describe_address(address) + " is not modelled");
    }
    const std::uint32_t offset = address - peripheral->base();
    if (size != 4 || offset % 4 != 0) {
      throw UnmodelledAccess(peripheral->register_name(offset / 4 * 4) + ": an access of " + std::to_string(size * 8) +
                             " bits is not modelled");
    }
    return {peripheral, offset};
  }

 private:
  static constexpr std::uint32_t start = 0x4000'0000;
  static constexpr std::uint32_t block_bytes = 0x400;  ///< no two peripherals share a block
  static constexpr std::uint32_t block_count = 0x8'0000 / block_bytes;

  std::array<Peripheral*, block_count> blocks_{};
};

}  // namespace proleg::sim
