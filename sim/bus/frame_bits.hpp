#pragma once

#include <cstdint>

#include "shared/can/can_frame.hpp"

namespace proleg::sim {

/// Recessive bits between two frames: no node may start in them (ISO 11898-1, intermission).
inline constexpr unsigned interframe_bits = 3;

/// Bits of a frame on the wire, stuff bits included, from start of frame to the last bit of end of frame
/// (ISO 11898-1, classical base frame format), without the interframe space. 44 to 132.
[[nodiscard]] unsigned frame_bits(const CanFrame& frame);

/// The minimum of frame_bits().
inline constexpr unsigned min_frame_bits = 44;

/// The first bit, from 0 (start of frame), in which two frames differ on the wire; frame_bits() if they do not.
[[nodiscard]] unsigned first_different_bit(const CanFrame& left, const CanFrame& right);

/// The CRC sequence that a controller appends to the data: 15 bits, generator polynomial 0x4599 (CRC-15/CAN), over all
/// bits before it except stuff bits.
[[nodiscard]] std::uint16_t crc_sequence(const CanFrame& frame);

}  // namespace proleg::sim
