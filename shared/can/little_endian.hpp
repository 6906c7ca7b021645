#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/can/can_frame.hpp"

namespace proleg {

/// Reads `size` bytes of a frame's data, 1 to 4, lowest first; position + size is at most 8.
[[nodiscard]] constexpr std::uint32_t read_little_endian(const CanFrame& frame, std::size_t position,
                                                         std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= std::uint32_t{frame.data[position + i]} << (8U * i);
  }
  return value;
}

/// Writes the low `size` bytes of a value, lowest first.
constexpr void write_little_endian(CanFrame& frame, std::size_t position, std::size_t size, std::uint32_t value) {
  for (std::size_t i = 0; i < size; ++i) {
    frame.data[position + i] = static_cast<std::uint8_t>(value >> (8U * i));
  }
}

}  // namespace proleg
