#include "shared/image/sha256.hpp"

#include <bit>

namespace proleg::image {
namespace {

/// Constants of the rounds (FIPS 180-4, section 4.2.2).
constexpr std::array<std::uint32_t, 64> round_constants{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

constexpr std::uint32_t choose(std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (x & y) ^ (~x & z); }
constexpr std::uint32_t majority(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return (x & y) ^ (x & z) ^ (y & z);
}
constexpr std::uint32_t upper_sigma_0(std::uint32_t x) { return std::rotr(x, 2) ^ std::rotr(x, 13) ^ std::rotr(x, 22); }
constexpr std::uint32_t upper_sigma_1(std::uint32_t x) { return std::rotr(x, 6) ^ std::rotr(x, 11) ^ std::rotr(x, 25); }
constexpr std::uint32_t lower_sigma_0(std::uint32_t x) { return std::rotr(x, 7) ^ std::rotr(x, 18) ^ (x >> 3U); }
constexpr std::uint32_t lower_sigma_1(std::uint32_t x) { return std::rotr(x, 17) ^ std::rotr(x, 19) ^ (x >> 10U); }

}  // namespace

void Sha256::add(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    add_byte(byte);
  }
}

void Sha256::add_byte(std::uint8_t byte) {
  block_[length_ % block_size] = byte;
  if (++length_ % block_size == 0) {
    add_block();
  }
}

void Sha256::add_block() {
  // The schedule of words in a ring of 16: word t replaces word t - 16.
  std::array<std::uint32_t, 16> words{};
  for (std::size_t i = 0; i < block_.size(); ++i) {
    words[i / 4] = words[i / 4] << 8U | block_[i];
  }
  std::array<std::uint32_t, 8> v = state_;
  for (std::size_t t = 0; t < round_constants.size(); ++t) {
    std::uint32_t& word = words[t % 16];
    if (t >= 16) {
      word += lower_sigma_1(words[(t - 2) % 16]) + words[(t - 7) % 16] + lower_sigma_0(words[(t - 15) % 16]);
    }
    const std::uint32_t first = v[7] + upper_sigma_1(v[4]) + choose(v[4], v[5], v[6]) + round_constants[t] + word;
    const std::uint32_t second = upper_sigma_0(v[0]) + majority(v[0], v[1], v[2]);
    v = {first + second, v[0], v[1], v[2], v[3] + first, v[4], v[5], v[6]};
  }
  for (std::size_t i = 0; i < state_.size(); ++i) {
    state_[i] += v[i];
  }
}

Sha256::Hash Sha256::finish() {
  const std::uint64_t bits = 8 * length_;
  constexpr std::size_t end = block_size - sizeof(bits);
  add_byte(0x80);
  while (length_ % block_size != end) {
    add_byte(0);
  }
  for (int shift = 56; shift >= 0; shift -= 8) {
    add_byte(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(shift)));
  }
  Hash hash{};
  for (std::size_t i = 0; i < hash.size(); ++i) {
    hash[i] = static_cast<std::uint8_t>(state_[i / 4] >> (24U - 8U * (i % 4)));
  }
  return hash;
}

Sha256::Hash sha256(std::span<const std::uint8_t> bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.finish();
}

}  // namespace proleg::image
