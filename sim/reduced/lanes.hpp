#pragma once

#include <cstdint>

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

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

/// The lanes in which a mask is set: bit k for lane k.
template <typename Mask>
inline unsigned bits_of(Mask mask) {
  unsigned bits = 0;
  for (unsigned lane = 0; lane < sizeof(Mask) / sizeof(std::int64_t); ++lane) {
    bits |= mask[lane] != 0 ? 1U << lane : 0U;
  }
  return bits;
}
/// IEEE 754 rounds it in one way, like a division.
template <typename Number>
inline Number square_root(Number value) {
  for (unsigned lane = 0; lane < sizeof(Number) / sizeof(double); ++lane) {
    value[lane] = __builtin_sqrt(value[lane]);
  }
  return value;
}

}  // namespace
}  // namespace proleg::sim::reduced
