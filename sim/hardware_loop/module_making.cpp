#include "sim/hardware_loop/module_making.hpp"

#include <optional>
#include <span>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/random.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/scenario/random_streams.hpp"

namespace proleg::sim {
namespace {

/// The last word of a unique id whose checksum is the given serial number: CRC-32 (shared/fixed/crc32.hpp), reversed.
std::uint32_t word_for_serial(std::uint32_t crc_before, std::uint32_t serial) {
  constexpr std::uint32_t reflected_polynomial = 0xEDB88320;
  std::uint32_t remainder = ~serial;
  for (int bit = 0; bit < 32; ++bit) {
    const bool divided = (remainder & 0x80000000U) != 0;
    remainder = (divided ? (remainder ^ reflected_polynomial) << 1U | 1U : remainder << 1U);
  }
  return remainder ^ ~crc_before;
}

}  // namespace

Crystal make_crystal(const Scenario& scenario, std::size_t joint, std::uint32_t error_ppm) {
  Pcg32 noise(scenario.kernel.seed, random_stream::crystals + joint);
  const auto range = static_cast<std::int32_t>(error_ppm) * 1000;
  return Crystal(static_cast<std::int32_t>(noise.below(static_cast<std::uint32_t>(2 * range + 1))) - range);
}

firmware::ModuleIdentity make_identity(const Scenario& scenario, std::size_t joint) {
  Pcg32 noise(scenario.kernel.seed, random_stream::boards + joint);
  firmware::ModuleIdentity identity;
  identity.node = scenario.modules[joint].node;
  identity.core_fingerprint = core_fingerprint;
  identity.capabilities = canopen::measures_angle;
  for (std::uint32_t& word : identity.unique_id) {
    word = noise.next();
  }
  if (const std::optional<std::uint32_t> serial = scenario.modules[joint].serial) {
    Crc32 crc;
    for (const std::uint32_t word : std::span(identity.unique_id).first(2)) {
      for (unsigned shift = 0; shift < 32; shift += 8) {
        crc.add(static_cast<std::uint8_t>(word >> shift));
      }
    }
    identity.unique_id[2] = word_for_serial(crc.value(), *serial);
  }
  return identity;
}

}  // namespace proleg::sim
