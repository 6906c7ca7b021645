#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace proleg {

/// A classic CAN data frame with an 11-bit identifier (ISO 11898-1). The protocol uses neither remote nor extended
/// frames.
struct CanFrame {
  static constexpr std::uint16_t max_identifier = 0x7FF;
  static constexpr std::uint8_t max_length = 8;

  std::uint16_t identifier = 0;        ///< 0 to 0x7FF; the lower one wins the bus
  std::uint8_t length = 0;             ///< 0 to 8 bytes of data
  std::array<std::uint8_t, 8> data{};  ///< bytes from `length` on are 0

  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {data.data(), length}; }

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

}  // namespace proleg
