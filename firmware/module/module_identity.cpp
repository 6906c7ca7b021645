#include "firmware/module/module_identity.hpp"

#include "shared/fixed/crc32.hpp"

namespace proleg::firmware {

std::uint32_t serial_number(const ModuleIdentity& identity) {
  Crc32 crc;
  for (const std::uint32_t word : identity.unique_id) {
    crc.add_little_endian(word, 4);
  }
  return crc.value();
}

}  // namespace proleg::firmware
