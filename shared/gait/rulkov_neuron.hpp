#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/fixed/arithmetic.hpp"

namespace proleg::rulkov {

// A bursting neuron as a map (N. F. Rulkov, Phys. Rev. E 65, 2002, 041922), with a synaptic current I as in the
// published library of the authors of the push-pull network:
//   x <- f(x, y + 0.1 I),  y <- y + mu (-(x + 1) + sigma + 0.5 I),
//   f(x, u) = alpha / (1 - x) + u  for x <= 0,  alpha + u  for 0 < x < alpha + u,  -1 otherwise
// with alpha = 15 and sigma = -0.33: slow bursts. x on the right side is always the old one. Quantities are in Q26 and
// saturate at -16 and 16. Inside a burst the map is chaotic: two arithmetics diverge spike by spike, their bursts
// agree.

struct Neuron {
  std::int32_t x;  ///< fast variable, the membrane potential
  std::int32_t y;  ///< slow variable
};

inline constexpr std::int32_t unit = 1 << 26;
inline constexpr std::int32_t largest = 16 * unit - 1;

/// alpha / (1 - x) for x <= 0, exact to 2e-5 of its value. It takes two divisions of 32 bits; 64 bits would need a
/// library call.
[[nodiscard]] constexpr std::int32_t recovery(std::int32_t x) {
  constexpr std::uint32_t alpha = 15U * unit;
  const std::uint32_t divisor = (static_cast<std::uint32_t>(unit - x) + 1024U) >> 11U;  // Q15, at least 1
  const std::uint32_t coarse = alpha / divisor;                                         // Q11
  const std::uint32_t fine = ((alpha % divisor) << 11U) / divisor;
  return static_cast<std::int32_t>(((coarse << 11U) + fine) << 4U);
}

/// Synapses that reach a neuron, as conductances g in Q28, at most 3 (inhibition) and 1 (excitation): I = inhibition
/// (-7 - x) + excitation (1 - x).
struct Synapses {
  std::int32_t inhibition;
  std::int32_t excitation;
};

/// The current I through open synapses, in Q24, at most 85 in size.
[[nodiscard]] inline std::int32_t current_through(const Synapses& open, std::int32_t x) {
  const std::int32_t reversal = (open.excitation >> 4U) - 7 * (open.inhibition >> 4U);
  return reversal - multiply(open.inhibition + open.excitation, x, 30);
}

/// Computes one iteration. mu: Q31.
[[nodiscard]] inline Neuron iterate(Neuron old, const Synapses& open, std::int32_t mu) {
  constexpr std::int32_t alpha = 15 * unit;
  constexpr std::int32_t four_tenths = 429496730;     // Q30: 0.1 for a current with two fraction bits less
  constexpr std::int32_t sigma_less_one = -89254789;  // -0.33 - 1
  const std::int32_t current = current_through(open, old.x);
  const std::int32_t u = std::clamp(old.y + multiply(current, four_tenths, 30), -largest, largest);
  std::int32_t x = -unit;
  if (old.x <= 0) {
    x = std::clamp(recovery(old.x) + u, -largest, largest);
  } else if (old.x < alpha + u) {
    x = std::min(alpha + u, largest);
  }
  const std::int64_t change = multiply_wide(sigma_less_one - old.x, mu) + 2 * multiply_wide(current, mu);
  const std::int32_t y = old.y + static_cast<std::int32_t>(shift_right_rounding(change, 31));
  return {x, std::clamp(y, -largest, largest)};
}

/// Share r of open receptors, in 16 bits, after an iteration (A. Destexhe et al., Neural Computation 6, 1994):
///   r <- r + 0.3 (1 - r) - 0.01 r  while transmitter is released,  r - 0.01 r  otherwise
[[nodiscard]] constexpr std::uint32_t receptors(std::uint32_t r, bool released) {
  const std::uint32_t opening = released ? ((65'535U - r) * 19'661U) >> 16U : 0U;
  return r + opening - ((r * 655U) >> 16U);
}

}  // namespace proleg::rulkov
