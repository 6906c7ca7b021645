#pragma once

// An image is the program of a module as it is sent over the bus and written into flash: a header of 512 bytes, then
// the body, which begins with the vector table. The header describes the body and the boards that it is for.
//
// Header, format 1 (little-endian; what is not listed is 0):
//   0  u32  magic, the characters PIMG
//   4  u16  format, 1
//   6  u16  bytes of the header, 512
//   8  u16  board id, as object 0x2000:4
//  10  u8   lowest hardware revision of the board, u8 highest
//  12  u16  version: major, u16 minor, u16 patch
//  18  u16  version of the protocol, as object 0x2000:1
//  20  u32  core fingerprint, as object 0x2000:3
//  24  u8   schema version of the settings that the program writes
//  25  u8   flags; bit 0: the sources were not those of the commit
//  28  u32  address for which the body is linked
//  32  u32  bytes of the body, a multiple of 4
//  36  u32  CRC-32 (shared/fixed/crc32.hpp) of the body
//  40  20 bytes  git commit of the sources; all 0: not known
//  60  u32  id of the key of the signature (shared/image/image_trust.hpp); 0: not signed
//  64  32 bytes  SHA-256 of the body
//  96  64 bytes  signature (shared/image/image_trust.hpp); all 0 if it is not signed
// 160  u16  lowest version that the module takes after this image: major, u16 minor, u16 patch; all 0: as before
// 168  32 bytes  key with which later images are signed; all 0: as before
// 508  u32  CRC-32 of the 508 bytes before
//
// A bootloader writes the header last: a valid header stands before a complete body.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "shared/fixed/little_endian.hpp"
#include "shared/image/sha256.hpp"

namespace proleg::image {

inline constexpr std::size_t header_size = 512;
using HeaderBytes = std::array<std::uint8_t, header_size>;

struct Version {
  std::uint16_t major = 0;
  std::uint16_t minor = 0;
  std::uint16_t patch = 0;

  friend constexpr bool operator==(const Version&, const Version&) = default;
  /// Whether `one` is the older version.
  friend constexpr bool operator<(const Version& one, const Version& other) {
    return one.major != other.major   ? one.major < other.major
           : one.minor != other.minor ? one.minor < other.minor
                                      : one.patch < other.patch;
  }
};

/// The part of a header that decides whether an image runs. A bootloader has no room to read more.
struct Summary {
  std::uint16_t board_id = 0;
  std::uint8_t lowest_revision = 0;
  std::uint8_t highest_revision = 0;  ///< at least the lowest
  std::uint32_t address = 0;          ///< address of the body
  std::uint32_t length = 0;           ///< bytes of the body: a multiple of 4, not 0
  std::uint32_t crc = 0;              ///< CRC-32 of the body

  friend bool operator==(const Summary&, const Summary&) = default;
};

struct Header : Summary {
  Version version;
  std::uint16_t protocol = 0;
  std::uint32_t core_fingerprint = 0;
  std::uint8_t settings_schema = 0;
  bool has_changed_sources = false;
  std::array<std::uint8_t, 20> commit{};
  std::uint32_t key_id = 0;
  Sha256::Hash hash{};  ///< SHA-256 of the body
  std::array<std::uint8_t, 64> signature{};
  Version minimum_version;                  ///< lowest version that is taken after this image; 0.0.0: as before
  std::array<std::uint8_t, 32> next_key{};  ///< key of later images; all 0: as before

  friend bool operator==(const Header&, const Header&) = default;
};

/// The board, and the place on it, at which an image would run.
struct Place {
  std::uint16_t board_id = 0;
  std::uint8_t revision = 0;  ///< hardware revision of the board
  std::uint32_t address = 0;  ///< address at which bodies begin
  std::uint32_t room = 0;     ///< number of bytes that a body may have
};

enum class Error : std::uint8_t {
  none,
  too_short,         ///< fewer bytes than a header has
  not_an_image,      ///< the magic is wrong
  unknown_format,    ///< a format or a header size of a later version
  damaged_header,    ///< the CRC of the header is wrong
  impossible_value,  ///< the CRC is right, but a value is out of its range
  other_board,
  other_revision,
  other_address,  ///< it is linked for another address
  too_large,
  wrong_length,  ///< there are more or fewer bytes than the header says
  damaged_body,  ///< the CRC or the SHA-256 of the body is wrong
  // The rest: what the module trusts (shared/image/image_trust.hpp) forbids the image.
  not_signed,
  other_key,        ///< it is signed with another key
  wrong_signature,  ///< it names the right key, but the signature is not valid
  version_too_old,  ///< its version is below the lowest that the module takes
  unusable_key,     ///< the key for later images is none
  has_key,          ///< instead of an image a first key came, and the module has one
  key_too_late,     ///< a first key came later than ten minutes after the start of the module
  no_room_for_key,  ///< the module has no room to keep the key or the lowest version that come with the image
};

/// A phrase for people that describes the error, without a full stop.
[[nodiscard]] std::string_view describe(Error error);

/// Bytes of a header, with its CRC, which is computed.
[[nodiscard]] HeaderBytes encode(const Header& header);

struct HeaderResult {
  Header header;  ///< valid if error is `none`
  Error error = Error::none;
};

/// Decodes the header at the beginning of some bytes. The body is not checked.
[[nodiscard]] HeaderResult decode(std::span<const std::uint8_t> bytes);
/// Decodes the summary at the beginning of some bytes. It is valid if the error is `none`.
[[nodiscard]] Error decode(std::span<const std::uint8_t> bytes, Summary& summary);

/// Whether an image with this header can run at this place: `other_board` to `too_large`, or `none`.
[[nodiscard]] Error check_place(const Summary& header, const Place& place);

/// Checks a whole image: header, place and body.
[[nodiscard]] Error check_image(std::span<const std::uint8_t> image, const Place& place);

/// Whether a body is the one that the header describes: `wrong_length`, `damaged_body`, or `none`.
[[nodiscard]] Error check_body(const Header& header, std::span<const std::uint8_t> body);

/// Sets the length, CRC and SHA-256 of the header from a body.
void describe_body(Header& header, std::span<const std::uint8_t> body);

/// Where the fields of a header are. For the image that is being linked, too, whose header the compiler writes.
namespace layout {

inline constexpr std::uint32_t magic = 0x474D4950;  // "PIMG"
inline constexpr std::uint16_t format = 1;

inline constexpr std::size_t magic_at = 0;
inline constexpr std::size_t format_at = 4;
inline constexpr std::size_t size_at = 6;
inline constexpr std::size_t board_at = 8;
inline constexpr std::size_t lowest_revision_at = 10;
inline constexpr std::size_t highest_revision_at = 11;
inline constexpr std::size_t version_at = 12;
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
inline constexpr std::size_t minimum_version_at = 160;
inline constexpr std::size_t minimum_version_end = 166;
inline constexpr std::size_t next_key_at = 168;
inline constexpr std::size_t next_key_end = 200;
inline constexpr std::size_t header_crc_at = header_size - 4;

inline constexpr std::uint8_t flag_changed_sources = 1;

template <std::size_t Size>
constexpr void write_bytes(HeaderBytes& bytes, std::size_t at, const std::array<std::uint8_t, Size>& value) {
  for (std::size_t i = 0; i < Size; ++i) {
    bytes[at + i] = value[i];
  }
}

constexpr void write_version(std::span<std::uint8_t> bytes, std::size_t at, const Version& version) {
  write_little_endian(bytes, at, 2, version.major);
  write_little_endian(bytes, at + 2, 2, version.minor);
  write_little_endian(bytes, at + 4, 2, version.patch);
}

constexpr Version read_version(std::span<const std::uint8_t> bytes, std::size_t at) {
  const auto number = [&](std::size_t offset) {
    return static_cast<std::uint16_t>(read_little_endian(bytes, at + offset, 2));
  };
  return {number(0), number(2), number(4)};
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
  write_version(bytes, version_at, header.version);
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
  write_version(bytes, minimum_version_at, header.minimum_version);
  write_bytes(bytes, next_key_at, header.next_key);
  return bytes;
}

}  // namespace layout
}  // namespace proleg::image
