#pragma once

#include <cstdint>

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Numbers of several worlds, one in each lane of a vector. Each operation acts on each lane by itself and is one of
/// IEEE 754: a lane gives the same bits in any company, with any width and on any processor.
template <int width>
struct Lanes {
  using Number [[gnu::vector_size(width * sizeof(double))]] = double;
  /// All bits of a lane are set or none: what a comparison of Numbers gives.
  using Mask [[gnu::vector_size(width * sizeof(double))]] = std::int64_t;

  static constexpr Number number(double value) { return Number{} + value; }
  static constexpr Mask none() { return Mask{}; }
  static constexpr Mask all() { return ~Mask{}; }
};

/// a where the mask is set, else b. (The conditional operator would compare the mask with 0 first.)
template <typename Mask, typename Number>
inline Number select(Mask mask, Number a, Number b) {
  return reinterpret_cast<Number>((reinterpret_cast<Mask>(a) & mask) | (reinterpret_cast<Mask>(b) & ~mask));
}
template <typename Number>
inline Number smaller(Number a, Number b) {
  return a < b ? a : b;
}
template <typename Number>
inline Number larger(Number a, Number b) {
  return a > b ? a : b;
}
/// low must not be above high.
template <typename Number>
inline Number bounded(Number value, Number low, Number high) {
  return smaller(larger(value, low), high);
}
template <typename Number>
inline Number magnitude(Number value) {
  return larger(value, -value);
}
/// Whether a mask is set in any lane.
template <typename Mask>
inline bool any(Mask mask) {
  std::int64_t bits = 0;
  for (unsigned lane = 0; lane < sizeof(Mask) / sizeof(std::int64_t); ++lane) {
    bits |= mask[lane];
  }
  return bits != 0;
}

/// A point or a direction in the plane in which the chains move.
template <typename Number>
struct Plane {
  Number x{};
  Number z{};

  Plane operator+(const Plane& other) const { return {x + other.x, z + other.z}; }
  Plane operator-(const Plane& other) const { return {x - other.x, z - other.z}; }
  Plane operator*(Number factor) const { return {x * factor, z * factor}; }
};

template <typename Mask, typename Number>
inline Plane<Number> select(Mask mask, const Plane<Number>& a, const Plane<Number>& b) {
  return {select(mask, a.x, b.x), select(mask, a.z, b.z)};
}
template <typename Number>
inline Number dot(const Plane<Number>& a, const Plane<Number>& b) {
  return a.x * b.x + a.z * b.z;
}
/// Positive if b points to the left of a: from x towards z.
template <typename Number>
inline Number cross(const Plane<Number>& a, const Plane<Number>& b) {
  return a.x * b.z - a.z * b.x;
}
/// A quarter turn from x towards z: the velocity of a point at r that turns at 1 rad/s.
template <typename Number>
inline Plane<Number> turned(const Plane<Number>& r) {
  return {-r.z, r.x};
}

}  // namespace
}  // namespace proleg::sim::reduced
