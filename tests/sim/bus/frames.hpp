#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <random>

#include "shared/can/can_frame.hpp"

namespace proleg::sim {

[[nodiscard]] inline CanFrame frame_of(std::uint16_t identifier, std::initializer_list<std::uint8_t> data = {}) {
  CanFrame frame;
  frame.identifier = identifier;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

/// A frame with that identifier and length; its bytes have runs of equal bits, which cause stuff bits.
[[nodiscard]] inline CanFrame random_frame(std::uint16_t identifier, std::uint8_t length, std::mt19937_64& random) {
  CanFrame frame;
  frame.identifier = identifier;
  frame.length = length;
  for (unsigned i = 0; i < length; ++i) {
    const std::uint64_t draw = random();
    constexpr std::uint8_t runs[4] = {0x00, 0xFF, 0x0F, 0xC1};
    frame.data[i] = (draw & 1U) != 0 ? static_cast<std::uint8_t>(draw >> 8U) : runs[(draw >> 1U) & 3U];
  }
  return frame;
}

}  // namespace proleg::sim
