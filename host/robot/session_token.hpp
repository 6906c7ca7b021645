#pragma once

#include <cstdint>
#include <random>

namespace proleg::host {

/// A token for the lease of a robot (object 0x2002): not 0, and different from that of any other host.
[[nodiscard]] inline std::uint32_t random_token() {
  std::random_device device;
  return std::uniform_int_distribution<std::uint32_t>(1)(device);
}

}  // namespace proleg::host
