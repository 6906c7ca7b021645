#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/fixed/crc32.hpp"
#include "shared/kernel/kernel.hpp"

namespace proleg::firmware {

/// CRC-32 over all set-points of the joint, from tick 0 on. With it a host compares every bit of them; state frames
/// contain only a part of the bits (object 0x200D).
class SetpointChecksum {
 public:
  struct Value {
    std::uint32_t ticks = 0;  ///< number of set-points that were added; 0: none, or not all of them are known
    std::uint32_t crc = 0;    ///< CRC of these set-points as int32, little-endian
  };

  /// Starts again: the next set-point is that of tick 0.
  void restart() { *this = {}; }
  /// Notes that set-points of earlier ticks are not known: nothing is added until restart().
  void lose() {
    restart();
    is_complete_ = false;
  }
  /// Adds the set-point of the next tick, 90 degrees = 2^30.
  void add(std::int32_t setpoint) {
    if (is_complete_) {
      crc_.add_little_endian(static_cast<std::uint32_t>(setpoint), 4);
      ++ticks_;
    }
  }
  /// Keeps the present value until the next take() or restart(), so that its two parts belong to the same tick.
  void take() { taken_ = {ticks_, crc_.value()}; }
  [[nodiscard]] const Value& taken() const { return taken_; }

 private:
  Crc32 crc_;
  std::uint32_t ticks_ = 0;
  bool is_complete_ = true;
  Value taken_;
};

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
