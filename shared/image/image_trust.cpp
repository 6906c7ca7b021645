#include "shared/image/image_trust.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"

namespace proleg::image {
namespace {

using namespace layout;
using Bytes = std::span<const std::uint8_t>;

template <std::size_t Size>
std::array<std::uint8_t, Size> bytes_at(Bytes bytes, std::size_t at) {
  std::array<std::uint8_t, Size> value{};
  std::ranges::copy(bytes.subspan(at, Size), value.begin());
  return value;
}

constexpr std::uint32_t key_magic = 0x5945'4B50;  // "PKEY"
constexpr std::size_t public_key_at = 4;
constexpr std::size_t key_crc_at = key_message_size - 4;

PublicKey next_key(Bytes header) { return bytes_at<std::tuple_size_v<PublicKey>>(header, next_key_at); }

}  // namespace

std::uint32_t key_id(const PublicKey& key) {
  const Sha256::Hash hash = sha256(key);
  return std::uint32_t{hash[0]} << 24U | std::uint32_t{hash[1]} << 16U | std::uint32_t{hash[2]} << 8U | hash[3];
}

SignedBytes signed_bytes(Bytes header) {
  auto bytes = bytes_at<std::tuple_size_v<SignedBytes>>(header, 0);
  std::ranges::fill(std::span(bytes).subspan(signature_at, signature_end - signature_at), std::uint8_t{0});
  return bytes;
}

Error check_trust(const Trust& trust, Bytes header) {
  if (!trust.key) {
    return Error::none;
  }
  const std::uint32_t id = read_little_endian(header, key_at, 4);
  if (id == 0) {
    return Error::not_signed;
  }
  if (id != key_id(*trust.key)) {
    return Error::other_key;
  }
  if (!is_signed_by(*trust.key, bytes_at<std::tuple_size_v<Signature>>(header, signature_at), signed_bytes(header))) {
    return Error::wrong_signature;
  }
  if (read_version(header, version_at) < trust.minimum_version) {
    return Error::version_too_old;
  }
  const PublicKey next = next_key(header);
  return next == PublicKey{} || may_be_trusted(next) ? Error::none : Error::unusable_key;
}

bool changes_trust(Bytes header) {
  return std::ranges::any_of(header.subspan(minimum_version_at, next_key_end - minimum_version_at),
                             [](std::uint8_t byte) { return byte != 0; });
}

Trust trust_after(const Trust& trust, Bytes header) {
  Trust after = trust;
  if (!trust.key) {
    return after;
  }
  if (const Version minimum = read_version(header, minimum_version_at); after.minimum_version < minimum) {
    after.minimum_version = minimum;
  }
  if (const PublicKey next = next_key(header); next != PublicKey{}) {
    after.key = next;
  }
  return after;
}

std::array<std::uint8_t, key_message_size> encode_key(const PublicKey& key) {
  std::array<std::uint8_t, key_message_size> bytes{};
  write_little_endian(bytes, 0, 4, key_magic);
  std::ranges::copy(key, bytes.begin() + public_key_at);
  write_little_endian(bytes, key_crc_at, 4, crc32(Bytes(bytes).first(key_crc_at)));
  return bytes;
}

std::optional<PublicKey> decode_key(Bytes bytes) {
  if (bytes.size() != key_message_size || read_little_endian(bytes, 0, 4) != key_magic ||
      read_little_endian(bytes, key_crc_at, 4) != crc32(bytes.first(key_crc_at))) {
    return std::nullopt;
  }
  return bytes_at<std::tuple_size_v<PublicKey>>(bytes, public_key_at);
}

bool may_be_trusted(const PublicKey& key) { return key_id(key) != 0 && is_usable(key); }

}  // namespace proleg::image
