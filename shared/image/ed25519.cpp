#include "shared/image/ed25519.hpp"

#include "shared/image/field_25519.hpp"
#include "shared/image/sha512.hpp"

namespace proleg::image {
namespace {

using namespace field_25519;

// Constants of the curve -x^2 + y^2 = 1 + d x^2 y^2 (RFC 8032, section 5.1).

/// d = -121665 / 121666.
constexpr Element curve_d = number_of("52036cee2b6ffe738cc740797779e89800700a4d4141d8ab75eb4dca135978a3");
/// 2 to the power (p - 1) / 4.
constexpr Element root_of_minus_1 = number_of("2b8324804fc1df0b2b4d00993dfbd7a72f431806ad2fe478c4ee1b274a0ea0b0");
/// L, the order of the base point.
constexpr Number order = number_of("1000000000000000000000000000000014def9dea2f79cd65812631a5cf5d3ed");
constexpr unsigned order_bits = 253;

constexpr Element one{1};

/// A point (x/z, y/z) with t = x y / z (RFC 8032, section 5.1.4).
struct Point {
  Element x;
  Element y;
  Element z;
  Element t;
};

/// The base point: y is 4/5, and x is even. t is their product.
constexpr Point base_point{number_of("216936d3cd6e53fec0a4e231fdd6dc5c692cc7609525a7b2c9562d608f25d51a"),
                           number_of("6666666666666666666666666666666666666666666666666666666666666658"), one,
                           number_of("67875f0fd78b766566ea4e8e64abe37d20f09f80775152f56dde8ab3a5b7dda3")};

/// Adds a point to another, or to itself. The formula of RFC 8032, section 5.1.4, is right for all points: d is no
/// square.
void add_point(Point& sum, const Point& other) {
  Element a;
  Element b;
  Element c;
  Element d;
  subtract(a, sum.y, sum.x);
  subtract(b, other.y, other.x);
  multiply(a, a, b);
  add(b, sum.y, sum.x);
  add(c, other.y, other.x);
  multiply(b, b, c);
  multiply(c, sum.t, other.t);
  multiply(c, c, curve_d);
  add(c, c, c);
  multiply(d, sum.z, other.z);
  add(d, d, d);
  Element& e = sum.x;
  Element& h = sum.y;
  subtract(e, b, a);
  add(h, b, a);
  subtract(a, d, c);  // f
  add(b, d, c);       // g
  multiply(sum.t, e, h);
  multiply(sum.z, a, b);
  multiply(sum.x, e, a);
  multiply(sum.y, h, b);
}

/// Whether the order of a point is 1, 2, 4 or 8. The point becomes four times itself.
bool has_small_order(Point& point) {
  for (unsigned i = 0; i < 2; ++i) {
    add_point(point, point);
  }
  // Only the points of the orders 1 and 2 have x = 0.
  return is_same(point.x, Element{});
}

/// Decodes the opposite -A of the point of a key (RFC 8032, section 5.1.3). Returns whether the key encodes a point.
bool decode_opposite(Point& opposite, const PublicKey& key) {
  Element& x = opposite.x;
  Element& y = opposite.y;
  y = read_number(key);
  const std::uint32_t sign = y.back() >> 31U;
  y.back() &= 0x7FFF'FFFF;
  if (reduce_once(y, prime)) {
    return false;
  }
  // x^2 = (y^2 - 1) / (d y^2 + 1), whose divisor is never 0. The power (p + 3) / 8 is a root of x^2 or of -x^2, if
  // there is one.
  Element square;
  Element check;
  multiply(square, y, y);
  multiply(check, square, curve_d);
  add(check, check, one);
  subtract(square, square, one);
  check = invert(check);
  multiply(square, square, check);
  x = root_power(square);
  multiply(x, x, square);
  multiply(check, x, x);
  if (!is_same(check, square)) {
    multiply(x, x, root_of_minus_1);
    multiply(check, x, x);
    if (!is_same(check, square)) {
      return false;
    }
  }
  make_canonical(x);
  if ((x.front() & 1U) == sign) {  // the opposite has the other sign
    subtract(x, Element{}, x);
  }
  opposite.z = one;
  multiply(opposite.t, x, y);
  return true;
}

/// Decodes the opposite of a key's point. Returns whether the key is usable.
bool decode_usable(Point& opposite, const PublicKey& key) {
  if (!decode_opposite(opposite, key)) {
    return false;
  }
  Point multiple = opposite;
  return !has_small_order(multiple);
}

/// The hash of the first bytes of a signature (R), the key and the message, modulo L. Inlined, its memory would add to
/// that of the points.
[[gnu::noinline]] Number challenge(const PublicKey& key, std::span<const std::uint8_t, 32> point,
                                   std::span<const std::uint8_t> message) {
  Sha512 sum;
  sum.add(point);
  sum.add(key);
  sum.add(message);
  const Sha512::Hash hash = sum.finish();
  Number remainder{};
  for (unsigned bit = 8 * std::tuple_size_v<Sha512::Hash>; bit-- > 0;) {
    std::uint32_t carry = hash[bit / 8] >> (bit % 8) & 1U;
    for (std::uint32_t& word : remainder) {
      const std::uint32_t high = word >> 31U;
      word = word << 1U | carry;
      carry = high;
    }
    reduce_once(remainder, order);
  }
  return remainder;
}

std::uint32_t bit_of(const Number& number, unsigned bit) { return number[bit / 32] >> (bit % 32) & 1U; }

}  // namespace

bool is_usable(const PublicKey& key) {
  Point opposite;
  return decode_usable(opposite, key);
}

bool is_signed_by(const PublicKey& key, const Signature& signature, std::span<const std::uint8_t> message) {
  const std::span<const std::uint8_t, 32> encoded = std::span(signature).first<32>();
  Number s = read_number(std::span(signature).last<32>());
  Point opposite;
  if (reduce_once(s, order) || !decode_usable(opposite, key)) {
    return false;
  }
  const Number h = challenge(key, encoded, message);
  // S B - h A, both products at once: bit by bit, the highest first.
  Point both = opposite;
  add_point(both, base_point);
  Point sum{{}, one, one, {}};  // the neutral point
  for (unsigned bit = order_bits; bit-- > 0;) {
    add_point(sum, sum);
    const bool adds_base = bit_of(s, bit) != 0;
    const bool adds_key = bit_of(h, bit) != 0;
    if (adds_base || adds_key) {
      add_point(sum, !adds_key ? base_point : adds_base ? both : opposite);
    }
  }
  // The encoding of the sum: y, and in the highest bit whether x is odd.
  Element x;
  Element y;
  const Element inverse = invert(sum.z);
  multiply(x, sum.x, inverse);
  multiply(y, sum.y, inverse);
  make_canonical(x);
  make_canonical(y);
  y.back() |= x.front() << 31U;
  return y == read_number(encoded) && !has_small_order(sum);
}

}  // namespace proleg::image
