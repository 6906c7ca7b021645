#pragma once

#include <cstdint>

namespace proleg::canopen {

// Values that a host writes to the controlword of a drive (0x6040; CiA 402, table 27).
inline constexpr std::uint16_t shutdown_controlword = 0x0006;
inline constexpr std::uint16_t switch_on_controlword = 0x0007;
inline constexpr std::uint16_t enable_operation_controlword = 0x000F;
inline constexpr std::uint16_t quick_stop_controlword = 0x0002;

}  // namespace proleg::canopen
