#pragma once

#include <cstdint>

#include "shared/fixed/crc32.hpp"

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

}  // namespace proleg::firmware
