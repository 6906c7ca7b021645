#pragma once

// Critically damped second-order filter with double pole at -a/2, r'' = a (a/4 (R - r) - r'), in its exact step over a
// tick (no integration error, stable for every a). With e = r - R, h = a/2, q = exp(-h dt) and the rate kept as u =
// r'/h, an angle like e, the step is:
//   step = h dt (e + u):  e <- (e + step) q,  u <- (u - step) q
// A rate kept as r' dt would have too few steps in slow filters. With u, a change of a during a motion changes its
// speed and never makes it overshoot. Source of the filter: A. J. Ijspeert et al., Science 315 (2007).

#include <cstdint>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

struct CriticalFilter {
  /// Number of derived constants that a filter takes up.
  static constexpr unsigned derived_size = 3;

  std::int32_t half_rate;  ///< h dt in Q30, at most 1
  std::int32_t decay;      ///< q in Q30
  std::int32_t arrived;    ///< distance below which the roundings are greater than the motion

  /// Writes the filter into derived constants, from which load() reads it in the tick.
  void store(std::int32_t* derived) const {
    derived[0] = half_rate;
    derived[1] = decay;
    derived[2] = arrived;
  }
  [[nodiscard]] static CriticalFilter load(const std::int32_t* derived) { return {derived[0], derived[1], derived[2]}; }
};

/// Derives a filter. rate: a in Q24 1/s, not negative. Rates above 2 / tick act as 2 / tick.
[[nodiscard]] CriticalFilter make_critical_filter(std::int32_t rate, std::uint32_t tick_period_us);

/// Computes one tick of the filter. distance: value - target, as the caller's quantity wraps or saturates. Returns the
/// new distance. With distance and rate both below `arrived` (64 + 4 / (h dt) steps) the filter arrives, so that it
/// ends exactly on the target.
[[nodiscard]] inline std::int32_t advance(const CriticalFilter& filter, std::int32_t distance, std::int32_t& rate) {
  if (distance == 0 && rate == 0) {
    return 0;  // at rest, as the filters are nearly always
  }
  const std::int32_t step = multiply(filter.half_rate, add_saturating(distance, rate), 30);
  // Rounded as in shift_right_rounding(); in this order a processor adds each product to its sum while it multiplies.
  constexpr std::int64_t half = std::int64_t{1} << 29U;
  const std::int64_t decayed_step = multiply_wide(step, filter.decay);
  const std::int32_t next_distance = saturate((half + decayed_step + multiply_wide(distance, filter.decay)) >> 30U);
  rate = saturate((half - decayed_step + multiply_wide(rate, filter.decay)) >> 30U);
  if (next_distance > -filter.arrived && next_distance < filter.arrived && rate > -filter.arrived &&
      rate < filter.arrived) {
    rate = 0;
    return 0;
  }
  return next_distance;
}

/// Computes one tick of a value and its rate, which stand next to each other in a state, in that order. Not inline:
/// most generators filter two or three values, and the image is small.
void follow(const CriticalFilter& filter, std::int32_t target, const std::int32_t* state, std::int32_t* next);

/// Computes one tick of a filtered value that saturates.
[[nodiscard]] inline std::int32_t approach(const CriticalFilter& filter, std::int32_t target, std::int32_t value,
                                           std::int32_t& rate) {
  return add_saturating(target, advance(filter, subtract_saturating(value, target), rate));
}

}  // namespace proleg
