#include "shared/image/field_25519.hpp"

#include "shared/fixed/little_endian.hpp"

namespace proleg::image::field_25519 {
namespace {

constexpr std::size_t words = std::tuple_size_v<Number>;
constexpr std::uint32_t wrap = 38;  // 2^256 modulo p

/// Adds `carry` times 2^256 to an element.
void add_carry(Element& element, std::int64_t carry) {
  while (carry != 0) {
    carry *= wrap;
    for (std::size_t i = 0; i < words && carry != 0; ++i) {
      carry += element[i];
      element[i] = static_cast<std::uint32_t>(carry);
      carry >>= 32U;
    }
  }
}

/// Adds `factor` times a number to another. Returns what belongs into the word behind.
std::uint32_t add_multiple(std::span<std::uint32_t, words> sum, std::span<const std::uint32_t, words> number,
                           std::uint32_t factor) {
  std::uint32_t carry = 0;
  for (std::size_t i = 0; i < words; ++i) {
    const std::uint64_t value = std::uint64_t{factor} * number[i] + sum[i] + carry;  // 2^64 - 1 at most
    sum[i] = static_cast<std::uint32_t>(value);
    carry = static_cast<std::uint32_t>(value >> 32U);
  }
  return carry;
}

}  // namespace

Number read_number(std::span<const std::uint8_t, 32> bytes) {
  Number number{};
  for (std::size_t i = 0; i < words; ++i) {
    number[i] = read_little_endian(bytes, 4 * i, 4);
  }
  return number;
}

bool reduce_once(Number& number, const Number& modulus) {
  Number difference;
  std::int64_t borrow = 0;
  for (std::size_t i = 0; i < words; ++i) {
    borrow += std::int64_t{number[i]} - modulus[i];
    difference[i] = static_cast<std::uint32_t>(borrow);
    borrow >>= 32U;
  }
  if (borrow != 0) {
    return false;
  }
  number = difference;
  return true;
}

void add(Element& sum, const Element& one, const Element& other) {
  std::int64_t carry = 0;
  for (std::size_t i = 0; i < words; ++i) {
    carry += std::int64_t{one[i]} + other[i];
    sum[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32U;
  }
  add_carry(sum, carry);
}

void subtract(Element& difference, const Element& from, const Element& what) {
  std::int64_t carry = 0;
  for (std::size_t i = 0; i < words; ++i) {
    carry += std::int64_t{from[i]} - what[i];
    difference[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32U;
  }
  add_carry(difference, carry);
}

void multiply(Element& product, const Element& one, const Element& other) {
  std::array<std::uint32_t, 2 * words> whole;  // the sum below writes the upper half before it reads it
  const std::span all(whole);
  for (std::size_t i = 0; i < words; ++i) {
    whole[i] = 0;
  }
  for (std::size_t i = 0; i < words; ++i) {
    whole[i + words] = add_multiple(all.subspan(i).first<words>(), one, other[i]);
  }
  const std::uint32_t carry = add_multiple(all.first<words>(), all.last<words>(), wrap);
  for (std::size_t i = 0; i < words; ++i) {
    product[i] = whole[i];
  }
  add_carry(product, carry);
}

Element root_power(const Element& base) {
  // (p - 5) / 8 = 2^252 - 3. In binary it has 250 ones, a 0 and a 1. The number of ones grows as the bits of 250 say: a
  // power with n ones gives the one with 2n ones by n squares and a multiplication.
  constexpr unsigned ones = 250;
  Element power = base;
  unsigned reached = 1;
  for (unsigned bit = 7; bit-- > 0;) {
    const Element half = power;
    for (unsigned i = 0; i < reached; ++i) {
      multiply(power, power, power);
    }
    multiply(power, power, half);
    reached *= 2;
    if ((ones >> bit & 1U) != 0) {
      multiply(power, power, power);
      multiply(power, power, base);
      ++reached;
    }
  }
  multiply(power, power, power);
  multiply(power, power, power);
  multiply(power, power, base);
  return power;
}

Element invert(const Element& element) {
  // The inverse is the power p - 2 = 8 (p - 5) / 8 + 3.
  Element power = root_power(element);
  multiply(power, power, power);
  for (unsigned i = 0; i < 2; ++i) {
    multiply(power, power, power);
    multiply(power, power, element);
  }
  return power;
}

void make_canonical(Element& element) {
  while (reduce_once(element, prime)) {
  }
}

bool is_same(const Element& one, const Element& other) {
  Element difference;
  subtract(difference, one, other);
  make_canonical(difference);
  return difference == Element{};
}

}  // namespace proleg::image::field_25519
