#include "sim/mcu/peripherals/peripheral.hpp"

#include "shared/computer/text/text.hpp"

namespace proleg::sim {

std::string Peripheral::register_name(std::uint32_t offset) const {
  return std::string(name()) + " at offset " + hexadecimal(offset);
}

}  // namespace proleg::sim
