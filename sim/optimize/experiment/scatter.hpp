#pragma once

#include <cstdint>

namespace proleg::optimize {

/// Scatters the 64 bits of a number, one to one: a bijection whose every output bit depends on every input bit (the
/// output function of SplitMix64: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014).
[[nodiscard]] constexpr std::uint64_t scatter(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15U;  // without this addition 0 would give 0
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

}  // namespace proleg::optimize
