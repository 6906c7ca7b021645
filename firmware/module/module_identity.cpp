#include "firmware/module/module_identity.hpp"

#include "shared/fixed/crc32.hpp"

namespace proleg::firmware {

std::uint32_t serial_number(const ModuleIdentity& identity) {
  Crc32 crc;
  for (const std::uint32_t word : identity.unique_id) {
    for (unsigned byte = 0; byte < 4; ++byte) {
      crc.add(static_cast<std::uint8_t>(word >> (8U * byte)));
    }
  }
  return crc.value();
}

}  // namespace proleg::firmware
