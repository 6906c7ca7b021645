#pragma once

#include "shared/can/can_frame.hpp"

namespace proleg::host {

inline constexpr double bus_bit_rate = 1e6;  ///< bit/s, docs/protocol.md

/// Number of bits that a frame takes on the bus, with its interframe space and an average number of stuff bits.
[[nodiscard]] inline double average_bits(const CanFrame& frame) {
  constexpr double fixed_bits = 47;  // bits of a frame with an 11-bit identifier, without data
  constexpr double average_stuffing = 1.08;
  return (fixed_bits + 8.0 * frame.length) * average_stuffing;
}

}  // namespace proleg::host
