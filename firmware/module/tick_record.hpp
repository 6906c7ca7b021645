#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/kernel/kernel.hpp"

namespace proleg::firmware {

/// Results of a module's last tick, at a fixed address and in a layout that is the same on every computer. A debugger
/// reads it from a running module; the simulator compares it.
struct TickRecord {
  static constexpr std::uint32_t none = 0xFFFF'FFFF;

  std::uint32_t tick = none;  ///< `none`: nothing was computed since the set-up
  std::int32_t setpoint = 0;  ///< Kernel::setpoint()
  std::uint8_t joint = 0;
  std::uint8_t flags = 0;  ///< byte 6 of the state frame
  std::uint8_t value_count = 0;
  std::uint8_t power = 0;        ///< present canopen::PowerState of the drive; the owner of the record updates it
  std::uint16_t current_ma = 0;  ///< current of the servo, as algorithms could read it
  std::uint16_t unused = 0;
  /// Internal values of the joint's algorithms, slot by slot, each in the order of its declaration.
  std::array<std::int32_t, max_slots * max_internal_values> internal_values{};

  /// Number of leading bytes that are in use.
  [[nodiscard]] std::size_t used_bytes() const {
    return sizeof(TickRecord) - (internal_values.size() - value_count) * sizeof(std::int32_t);
  }
};

}  // namespace proleg::firmware
