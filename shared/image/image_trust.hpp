#pragma once

// Which images a module trusts. The one rule for bootloaders and hosts.
//
// The signature of an image is one of Ed25519 (ed25519.hpp) of the first 508 bytes of its header, all but the CRC, with
// the 64 bytes of the signature as 0. The header contains the SHA-256 of the body, so the signature covers the body,
// too: the image is checked before its signature (image::check_image()).

#include <optional>

#include "shared/image/ed25519.hpp"
#include "shared/image/image_header.hpp"

namespace proleg::image {

/// What a module trusts.
struct Trust {
  std::optional<PublicKey> key;  ///< nothing: the module takes any image
  Version minimum_version;       ///< with a key: the lowest version that it takes

  friend bool operator==(const Trust&, const Trust&) = default;
};

/// Id of a key: the first four bytes of its SHA-256, the first byte highest. An image whose key has the id 0 counts as
/// not signed.
[[nodiscard]] std::uint32_t key_id(const PublicKey& key);

using SignedBytes = std::array<std::uint8_t, layout::header_crc_at>;
/// The bytes of a header that are signed. header: header_size bytes at least.
[[nodiscard]] SignedBytes signed_bytes(std::span<const std::uint8_t> header);

/// Whether an image is trusted: `not_signed` to `unusable_key`, or `none`. header: the bytes of the header of an image
/// that is right. It takes long, up to 0.3 s of the chip, if the image names the right key.
[[nodiscard]] Error check_trust(const Trust& trust, std::span<const std::uint8_t> header);

/// Whether a header says something about later images: a lowest version or a key.
[[nodiscard]] bool changes_trust(std::span<const std::uint8_t> header);

/// What a module trusts when an image that it trusts has proven itself: the lowest version only rises, and the key is
/// the next one that the header names. Without a key nothing changes.
[[nodiscard]] Trust trust_after(const Trust& trust, std::span<const std::uint8_t> header);

// The first key of a module comes to its bootloader as an image does (shared/broadcast), but as these bytes:
//   0  u32       the characters PKEY
//   4  32 bytes  the public key
//  36  u32       CRC-32 of the 36 bytes before
inline constexpr std::size_t key_message_size = 40;

[[nodiscard]] std::array<std::uint8_t, key_message_size> encode_key(const PublicKey& key);
/// The key; nothing if the bytes are anything else.
[[nodiscard]] std::optional<PublicKey> decode_key(std::span<const std::uint8_t> bytes);

/// Whether a module may be given this key, so that signatures can be valid.
[[nodiscard]] bool may_be_trusted(const PublicKey& key);

}  // namespace proleg::image
