#include "shared/fixed/crc32.hpp"

#include <array>

namespace proleg {
namespace {

/// Remainders of all values of four bits. A byte needs two look-ups, and the table takes 64 bytes of flash instead of
/// 1024.
constexpr std::array<std::uint32_t, 16> make_table() {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t remainder = i;
    for (int bit = 0; bit < 4; ++bit) {
      remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    table[i] = remainder;
  }
  return table;
}

constexpr std::array<std::uint32_t, 16> table = make_table();

}  // namespace

void Crc32::add(std::uint8_t byte) {
  remainder_ ^= byte;
  remainder_ = (remainder_ >> 4U) ^ table[remainder_ & 15U];
  remainder_ = (remainder_ >> 4U) ^ table[remainder_ & 15U];
}

void Crc32::add(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    add(byte);
  }
}

void Crc32::add_little_endian(std::uint64_t value, unsigned size) {
  for (unsigned i = 0; i < size; ++i) {
    add(static_cast<std::uint8_t>(value >> (8U * i)));
  }
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace proleg
