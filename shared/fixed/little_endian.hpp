#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg {

/// Reads a number of `size` bytes, 1 to 4, from `position` on, lowest byte first.
[[nodiscard]] constexpr std::uint32_t read_little_endian(std::span<const std::uint8_t> bytes, std::size_t position,
                                                         std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4 && i < size; ++i) {  // the constant bound lets the compiler unroll
    value |= std::uint32_t{bytes[position + i]} << (8U * i);
  }
  return value;
}

/// Writes the low `size` bytes of a value, 0 to 4, from `position` on, lowest byte first.
constexpr void write_little_endian(std::span<std::uint8_t> bytes, std::size_t position, std::size_t size,
                                   std::uint32_t value) {
  for (std::size_t i = 0; i < 4 && i < size; ++i) {
    bytes[position + i] = static_cast<std::uint8_t>(value >> (8U * i));
  }
}

}  // namespace proleg
