#pragma once

// Arithmetic modulo the prime p = 2^255 - 19: the field of the curve of Ed25519 (RFC 8032, section 5.1).
//
// An element of the field is given by any number of 256 bits that has the same remainder modulo p. So each element has
// two or three representations. The canonical one is below p. Results are in general not canonical.
//
// The code is small, and its time depends on the values. Use it for public values only, never with a secret key.
// Functions write their result into the first parameter, which may be an operand, too.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::image::field_25519 {

/// 0 to 2^256 - 1 in eight words, the lowest first.
using Number = std::array<std::uint32_t, 8>;
using Element = Number;

/// The number with these 64 hexadecimal digits, the highest first.
constexpr Number number_of(const char (&digits)[65]) {
  Number number{};
  for (std::size_t i = 0; i < 64; ++i) {
    const char digit = digits[63 - i];
    const auto value = static_cast<std::uint32_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
    number[i / 8] |= value << (4U * (i % 8));
  }
  return number;
}

inline constexpr Number prime = number_of("7fffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffed");

/// The number in 32 bytes, the lowest first.
[[nodiscard]] Number read_number(std::span<const std::uint8_t, 32> bytes);

/// Subtracts the modulus if the number is not below it. Returns whether it has subtracted.
bool reduce_once(Number& number, const Number& modulus);

void add(Element& sum, const Element& one, const Element& other);
void subtract(Element& difference, const Element& from, const Element& what);
void multiply(Element& product, const Element& one, const Element& other);

/// The power (p - 5) / 8 of an element, from which square roots are computed.
[[nodiscard]] Element root_power(const Element& base);
/// 0 has the inverse 0.
[[nodiscard]] Element invert(const Element& element);

/// Replaces the representation by the canonical one.
void make_canonical(Element& element);
/// Whether two representations are those of the same element.
[[nodiscard]] bool is_same(const Element& one, const Element& other);

}  // namespace proleg::image::field_25519
