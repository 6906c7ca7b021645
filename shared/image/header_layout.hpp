#pragma once

// Positions of the fields of a header (image_header.hpp). The image that is being linked uses them, too: the compiler
// writes its header.

#include "shared/fixed/little_endian.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::image::layout {

inline constexpr std::uint32_t magic = 0x474D4950;  // "PIMG"
inline constexpr std::uint16_t format = 1;

inline constexpr std::size_t magic_at = 0;
inline constexpr std::size_t format_at = 4;
inline constexpr std::size_t size_at = 6;
inline constexpr std::size_t board_at = 8;
inline constexpr std::size_t lowest_revision_at = 10;
inline constexpr std::size_t highest_revision_at = 11;
inline constexpr std::size_t major_at = 12;
inline constexpr std::size_t minor_at = 14;
inline constexpr std::size_t patch_at = 16;
inline constexpr std::size_t protocol_at = 18;
inline constexpr std::size_t fingerprint_at = 20;
inline constexpr std::size_t schema_at = 24;
inline constexpr std::size_t flags_at = 25;
inline constexpr std::size_t address_at = 28;
inline constexpr std::size_t length_at = 32;
inline constexpr std::size_t body_crc_at = 36;
inline constexpr std::size_t commit_at = 40;
inline constexpr std::size_t key_at = 60;
inline constexpr std::size_t hash_at = 64;
inline constexpr std::size_t signature_at = 96;
inline constexpr std::size_t signature_end = 160;
inline constexpr std::size_t header_crc_at = header_size - 4;

inline constexpr std::uint8_t flag_changed_sources = 1;

template <std::size_t Size>
constexpr void write_bytes(HeaderBytes& bytes, std::size_t at, const std::array<std::uint8_t, Size>& value) {
  for (std::size_t i = 0; i < Size; ++i) {
    bytes[at + i] = value[i];
  }
}

/// The bytes of a header without its CRC, which is 0.
constexpr HeaderBytes encode_fields(const Header& header) {
  HeaderBytes bytes{};
  write_little_endian(bytes, magic_at, 4, magic);
  write_little_endian(bytes, format_at, 2, format);
  write_little_endian(bytes, size_at, 2, header_size);
  write_little_endian(bytes, board_at, 2, header.board_id);
  bytes[lowest_revision_at] = header.lowest_revision;
  bytes[highest_revision_at] = header.highest_revision;
  write_little_endian(bytes, major_at, 2, header.version.major);
  write_little_endian(bytes, minor_at, 2, header.version.minor);
  write_little_endian(bytes, patch_at, 2, header.version.patch);
  write_little_endian(bytes, protocol_at, 2, header.protocol);
  write_little_endian(bytes, fingerprint_at, 4, header.core_fingerprint);
  bytes[schema_at] = header.settings_schema;
  bytes[flags_at] = header.has_changed_sources ? flag_changed_sources : 0;
  write_little_endian(bytes, address_at, 4, header.address);
  write_little_endian(bytes, length_at, 4, header.length);
  write_little_endian(bytes, body_crc_at, 4, header.crc);
  write_bytes(bytes, commit_at, header.commit);
  write_little_endian(bytes, key_at, 4, header.key_id);
  write_bytes(bytes, hash_at, header.hash);
  write_bytes(bytes, signature_at, header.signature);
  return bytes;
}

}  // namespace proleg::image::layout
