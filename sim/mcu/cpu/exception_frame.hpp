#pragma once

// The registers that an exception saves on the stack (DDI 0403, B1.5.6).

#include <cstdint>

namespace proleg::sim {

inline constexpr std::uint32_t frame_size = 32;
// Bits of the saved xPSR.
inline constexpr std::uint32_t thumb_state = 1U << 24U;
inline constexpr std::uint32_t frame_was_aligned = 1U << 9U;
inline constexpr std::uint32_t exception_number_mask = 0x1FF;

}  // namespace proleg::sim
