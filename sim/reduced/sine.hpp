#pragma once

#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

template <typename Number>
struct SineCosine {
  Number sine;
  Number cosine;
};

/// Sine and cosine without the system's library, whose last bits depend on its version and on the processor. The angle
/// is reduced to an eighth of a turn about 0, where Taylor polynomials of degrees 15 and 16 are exact up to rounding.
/// angle: rad, at most 10^6 in magnitude; the error is below 3e-16.
template <int width>
inline SineCosine<typename Lanes<width>::Number> sine_cosine(typename Lanes<width>::Number angle) {
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  constexpr double to_integer = 6755399441055744.0;  // 1.5 * 2^52: a sum with it has no fraction
  constexpr double quarter_turns_per_radian = 0.63661977236758134;
  const Number shifted = angle * quarter_turns_per_radian + to_integer;
  Mask quadrant;  // in the lowest two bits
  __builtin_memcpy(&quadrant, &shifted, sizeof quadrant);
  const Number turns = shifted - to_integer;
  // pi / 2 in three parts; the first two have 33 bits, so their products with a whole number are exact.
  const Number x = ((angle - turns * 1.57079632673412561417) - turns * 6.07710050630396597660e-11) -
                   turns * 2.02226624879595063154e-21;
  const Number square = x * x;
  Number s = square * (-1.0 / 1307674368000.0) + (1.0 / 6227020800.0);
  s = s * square - (1.0 / 39916800.0);
  s = s * square + (1.0 / 362880.0);
  s = s * square - (1.0 / 5040.0);
  s = s * square + (1.0 / 120.0);
  s = s * square - (1.0 / 6.0);
  s = x + x * (square * s);
  Number c = square * (1.0 / 20922789888000.0) - (1.0 / 87178291200.0);
  c = c * square + (1.0 / 479001600.0);
  c = c * square - (1.0 / 3628800.0);
  c = c * square + (1.0 / 40320.0);
  c = c * square - (1.0 / 720.0);
  c = c * square + (1.0 / 24.0);
  c = 1.0 - square * 0.5 + square * (square * c);
  const Mask is_odd = (quadrant & 1) != 0;
  const Number sine = select(is_odd, c, s);
  const Number cosine = select(is_odd, s, c);
  const Mask is_sine_negative = (quadrant & 2) != 0;
  const Mask is_cosine_negative = ((quadrant + 1) & 2) != 0;
  return {select(is_sine_negative, -sine, sine), select(is_cosine_negative, -cosine, cosine)};
}

}  // namespace
}  // namespace proleg::sim::reduced
