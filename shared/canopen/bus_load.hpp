#pragma once

#include <bit>

#include "shared/kernel/kernel.hpp"

namespace proleg::canopen {

/// A bus is not driven above this share of its time in the worst case, in thousandths: EMCY, SDO and the host need
/// room.
inline constexpr std::uint32_t highest_bus_load_permille = 850;

/// Share of a 1 Mbit/s bus, in thousandths and rounded up, that a robot's SYNC and state frames take if every frame has
/// the most stuff bits: 135 bits for 8 bytes of data and 65 for one, with interframe space (ISO 11898-1).
[[nodiscard]] inline std::uint32_t worst_bus_load_permille(const KernelConfiguration& kernel) {
  const auto second_frames = static_cast<std::uint32_t>(std::popcount(kernel.second_channel_senders().bits()));
  constexpr std::uint32_t state_bits = 135;
  constexpr std::uint32_t sync_bits = 65;
  constexpr std::uint32_t tick_bits = 135;  // every tenth tick
  const std::uint32_t bits = (kernel.joint_count + second_frames) * state_bits + sync_bits + (tick_bits + 9) / 10;
  // At 1 Mbit/s a bit is a microsecond.
  return (bits * 1000 + kernel.tick_period_us - 1) / kernel.tick_period_us;
}

}  // namespace proleg::canopen
