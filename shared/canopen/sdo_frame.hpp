#pragma once

// The layout of an SDO frame, for server and client (CiA 301, section 7.2.4.3): a command byte, index and sub-index of
// the entry, four bytes of data.

#include "shared/canopen/object.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::canopen::sdo {

inline constexpr std::uint8_t request_upload = 0x40;
inline constexpr std::uint8_t request_download = 0x20;
inline constexpr std::uint8_t answer_upload = 0x40;
inline constexpr std::uint8_t answer_download = 0x60;
inline constexpr std::uint8_t abort = 0x80;
/// Lower bits of a transfer's first frame.
inline constexpr std::uint8_t expedited = 0x02;
inline constexpr std::uint8_t size_indicated = 0x01;

/// The command specifier.
[[nodiscard]] constexpr std::uint8_t specifier(const CanFrame& frame) { return frame.data[0] & 0xE0U; }

/// Command bits of an expedited transfer of 1 to 4 bytes.
[[nodiscard]] constexpr std::uint8_t with_size(std::uint8_t command, unsigned size) {
  return static_cast<std::uint8_t>(command | (4U - size) << 2U | expedited | size_indicated);
}
/// The number of bytes by a command byte with the expedited bit; 0 if it is not indicated.
[[nodiscard]] constexpr std::uint8_t indicated_size(std::uint8_t command) {
  return (command & size_indicated) != 0 ? static_cast<std::uint8_t>(4U - ((command >> 2U) & 3U)) : std::uint8_t{0};
}

[[nodiscard]] constexpr Address address(const CanFrame& frame) {
  return {static_cast<std::uint16_t>(read_little_endian(frame.data, 1, 2)), frame.data[3]};
}
[[nodiscard]] constexpr std::uint32_t data(const CanFrame& frame, std::size_t size = 4) {
  return read_little_endian(frame.data, 4, size);
}

[[nodiscard]] constexpr CanFrame make(std::uint16_t identifier, std::uint8_t command, Address address,
                                      std::size_t size = 0, std::uint32_t value = 0) {
  CanFrame frame{identifier, 8, {command}};
  write_little_endian(frame.data, 1, 2, address.index);
  frame.data[3] = address.sub;
  write_little_endian(frame.data, 4, size, value);
  return frame;
}

}  // namespace proleg::canopen::sdo
