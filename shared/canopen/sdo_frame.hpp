#pragma once

// The layout of an SDO frame, for server and client (CiA 301, section 7.2.4.3): a command byte, index and sub-index of
// the entry, four bytes of data.

#include "shared/canopen/object.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::canopen::sdo {

// Command specifiers, the upper three bits of the command byte.
inline constexpr std::uint8_t request_upload = 0x40;
inline constexpr std::uint8_t request_download = 0x20;
inline constexpr std::uint8_t answer_upload = 0x40;
inline constexpr std::uint8_t answer_download = 0x60;
inline constexpr std::uint8_t request_upload_segment = 0x60;
inline constexpr std::uint8_t answer_upload_segment = 0x00;
inline constexpr std::uint8_t request_download_segment = 0x00;
inline constexpr std::uint8_t answer_download_segment = 0x20;
inline constexpr std::uint8_t abort = 0x80;
inline constexpr std::uint8_t block_download = 0xC0;         ///< a block download's client, and a block upload's server
inline constexpr std::uint8_t answer_block_download = 0xA0;  ///< a block download's server, and a block upload's client
/// Lower bits of the command byte in the first frame of a transfer.
inline constexpr std::uint8_t expedited = 0x02;
inline constexpr std::uint8_t size_indicated = 0x01;
/// Lower bits of the command byte in a segment.
inline constexpr std::uint8_t toggle = 0x10;
inline constexpr std::uint8_t no_more_segments = 0x01;
/// Lower bits of the command byte in the frames of a block transfer.
inline constexpr std::uint8_t block_crc = 0x04;   ///< in the first frame: a checksum is supported
inline constexpr std::uint8_t block_size = 0x02;  ///< in the first frame: the size is indicated
inline constexpr std::uint8_t block_end = 0x01;
inline constexpr std::uint8_t block_acknowledge = 0x02;
inline constexpr std::uint8_t block_start = 0x03;
/// Bits of the command byte that distinguish the frames with specifier 0xA0.
inline constexpr std::uint8_t block_command = 0x03;

/// Number of bytes of the last segment that hold no data, from the frame that ends a block transfer.
[[nodiscard]] constexpr std::uint8_t unused_at_end(const CanFrame& frame) { return (frame.data[0] >> 2U) & 7U; }
/// Number of bytes of a segment that hold no data, in a segmented transfer.
[[nodiscard]] constexpr std::uint8_t unused_in_segment(const CanFrame& frame) { return (frame.data[0] >> 1U) & 7U; }

/// Command specifier of a frame.
[[nodiscard]] constexpr std::uint8_t specifier(const CanFrame& frame) { return frame.data[0] & 0xE0U; }

/// Adds the bits of an expedited transfer of 1 to 4 bytes to a command byte.
[[nodiscard]] constexpr std::uint8_t with_size(std::uint8_t command, unsigned size) {
  return static_cast<std::uint8_t>(command | (4U - size) << 2U | expedited | size_indicated);
}
/// Number of bytes by a command byte with the expedited bit; 0 if it is not indicated.
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
