#pragma once

#include <cstdint>

#include "shared/fixed/crc32.hpp"

namespace proleg::firmware {

/// CRC-32 over all set-points of the joint, from tick 0 on: with it a host compares every bit of them, of which state
/// frames carry a part only (object 0x200D).
class SetpointChecksum {
 public:
  struct Value {
    std::uint32_t ticks = 0;  ///< how many set-points were added; 0: none, or not all of them are known
    std::uint32_t crc = 0;    ///< of them, int32, little-endian
  };

  /// Tick 0 comes next.
  void restart() { *this = {}; }
  /// The set-points of earlier ticks are not known: nothing counts until restart().
  void lose() {
    restart();
    is_complete_ = false;
  }
  /// The set-point of the next tick, 90 degrees = 2^30.
  void add(std::int32_t setpoint) {
    if (is_complete_) {
      crc_.add_little_endian(static_cast<std::uint32_t>(setpoint), 4);
      ++ticks_;
    }
  }
  /// Keeps the present value until the next take() or restart(): both of its parts belong to one tick.
  void take() { taken_ = {ticks_, crc_.value()}; }
  [[nodiscard]] const Value& taken() const { return taken_; }

 private:
  Crc32 crc_;
  std::uint32_t ticks_ = 0;
  bool is_complete_ = true;
  Value taken_;
};

}  // namespace proleg::firmware
