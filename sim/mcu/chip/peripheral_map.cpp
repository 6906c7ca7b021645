#include "sim/mcu/chip/peripheral_map.hpp"

#include <string>

#include "sim/mcu/peripherals/chip_identity.hpp"

namespace proleg::sim {

void PeripheralMap::add(Peripheral& peripheral) {
  const std::uint32_t end = peripheral.base() + peripheral.size();
  for (std::uint32_t address = peripheral.base(); address < end; address += block_bytes) {
    blocks_.at((address - start) / block_bytes) = &peripheral;
  }
}

std::pair<Peripheral*, std::uint32_t> PeripheralMap::find(std::uint32_t address, unsigned size) const {
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

}  // namespace proleg::sim
