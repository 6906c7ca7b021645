#pragma once

#include <cstdint>

#include "shared/gait/declaration.hpp"

namespace proleg {

/// Two neurons that inhibit each other and tire (K. Matsuoka, Biol. Cybern. 52, 1985, and 56, 1987):
///   tau u1' = -u1 - w y2 - beta v1 + c + S1,   T v1' = -v1 + y1,   y1 = max(0, u1),
/// and the same with 1 and 2 exchanged. All quantities are ratios in Q28.
struct MatsuokaPair {
  std::int32_t u1;  ///< membrane potentials
  std::int32_t u2;
  std::int32_t v1;  ///< fatigue
  std::int32_t v2;

  [[nodiscard]] std::int32_t y1() const { return u1 > 0 ? u1 : 0; }
  [[nodiscard]] std::int32_t y2() const { return u2 > 0 ? u2 : 0; }
};

/// Constants of a pair, derived from parameters that are easy to choose.
struct MatsuokaConstants {
  /// Number of Euler steps in a tick. An input from outside is held over a tick.
  static constexpr unsigned steps_in_a_tick = 4;
  /// Number of derived constants that fast_step and slow_step take up.
  static constexpr unsigned derived_size = 2;

  std::int32_t fast_step;  ///< step / tau in Q30, at most 1/4
  std::int32_t slow_step;  ///< step / T in Q30
  std::int32_t x;          ///< omega T in Q24, omega: the natural frequency

  /// Writes fast_step and slow_step into derived constants, where advance() reads them.
  void store(std::int32_t* derived) const {
    derived[0] = fast_step;
    derived[1] = slow_step;
  }
};

/// Time constants of a pair that oscillates at `frequency` (Q24 Hz), from K. Matsuoka, Biol. Cybern. 104 (2011):
///   omega = (1 / T) sqrt(((tau + T) beta - tau w) / (tau w))
/// time_ratio: T / tau; fatigue: beta; inhibition: w; all in Q28 and positive. The period is right to 1 % for
/// w <= 1 + 0.6 beta. A pair oscillates for 1 + tau / T < w < 1 + beta. Where the root does not exist, 0.01 stands for
/// its argument.
[[nodiscard]] MatsuokaConstants make_matsuoka_constants(std::int32_t frequency, std::int32_t time_ratio,
                                                        std::int32_t fatigue, std::int32_t inhibition,
                                                        std::uint32_t tick_period_us);

/// Computes one tick. steps: where MatsuokaConstants::store has written. input1, input2: c + S of each neuron in Q28.
/// All values saturate at -8 and 8.
void advance(MatsuokaPair& pair, const std::int32_t* steps, std::int32_t fatigue, std::int32_t inhibition,
             std::int32_t input1, std::int32_t input2);

/// The internal values that both generators with such pairs have.
namespace matsuoka_values {

inline constexpr InternalValue u1{"u1", Unit::ratio, raw(Unit::ratio, 1, 20),
                                  "membrane potential of the extensor neuron"};
inline constexpr InternalValue u2{"u2", Unit::ratio, raw(Unit::ratio, 1, 20),
                                  "membrane potential of the flexor neuron"};
inline constexpr InternalValue v1{"v1", Unit::ratio, 0, "fatigue of the extensor neuron"};
inline constexpr InternalValue v2{"v2", Unit::ratio, 0, "fatigue of the flexor neuron"};

}  // namespace matsuoka_values

/// The parameters that both generators with such pairs have.
namespace matsuoka_parameters {

inline constexpr Parameter frequency{
    "frequency", Unit::hertz,         raw(Unit::hertz, 1),
    0,           raw(Unit::hertz, 5), "How many times the joint swings in a second. Sets both time constants."};
inline constexpr Parameter time_ratio{
    "time_ratio",        Unit::ratio,
    raw(Unit::ratio, 2), raw(Unit::ratio, 1),
    raw(Unit::ratio, 7), "How slowly a neuron tires. T / tau: time constant of the fatigue in those of the neuron."};
inline constexpr Parameter fatigue{
    "fatigue",           Unit::ratio,         raw(Unit::ratio, 2),
    raw(Unit::ratio, 1), raw(Unit::ratio, 6), "How much a neuron tires while it is active. beta in the equations."};
inline constexpr Parameter inhibition{
    "inhibition",
    Unit::ratio,
    raw(Unit::ratio, 2),
    raw(Unit::ratio, 1),
    raw(Unit::ratio, 5),
    "How strongly the two neurons of a joint hold each other back. w; they oscillate for w "
    "between 1 + 1 / time_ratio and 1 + fatigue."};

}  // namespace matsuoka_parameters

}  // namespace proleg
