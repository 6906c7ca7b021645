#include "shared/gait/matsuoka_pair.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

/// The potential u of a neuron after a step. All products have Q56.
std::int32_t potential(std::int32_t u, std::int32_t other_output, std::int32_t own_fatigue, std::int32_t fast_step,
                       std::int32_t fatigue, std::int32_t inhibition, std::int32_t input) {
  const std::int64_t inhibited = shift_right_rounding(multiply_wide(inhibition, other_output), 28);
  const std::int64_t tired = shift_right_rounding(multiply_wide(fatigue, own_fatigue), 28);
  const std::int32_t drive = saturate(input - inhibited - tired - u);
  return add_saturating(u, multiply(drive, fast_step, 30));
}

std::int32_t tiredness(std::int32_t v, std::int32_t own_output, std::int32_t slow_step) {
  return add_saturating(v, multiply(subtract_saturating(own_output, v), slow_step, 30));
}

}  // namespace

MatsuokaConstants make_matsuoka_constants(std::int32_t frequency, std::int32_t time_ratio, std::int32_t fatigue,
                                          std::int32_t inhibition, std::uint32_t tick_period_us) {
  constexpr std::int32_t one = raw(Unit::ratio, 1);
  // (omega T)^2 = (1 + T / tau) beta / w - 1
  const std::int64_t grown = shift_right_rounding((std::int64_t{one} + time_ratio) * fatigue, 28);
  const std::int64_t square = divide_nearest(grown << 24U, inhibition) - (1 << 24);
  const std::int64_t smallest = (1 << 24) / 100;
  const auto x = static_cast<std::int32_t>(square_root(static_cast<std::uint64_t>(std::max(square, smallest)) << 24U));

  // step / tau = omega step (T / tau) / (omega T)
  constexpr std::int64_t half_pi = 843314857;  // Q29: 2 pi / steps_in_a_tick
  static_assert(MatsuokaConstants::steps_in_a_tick == 4);
  // Turns in a tick are in Q30.
  const std::int64_t turns = divide_nearest((std::int64_t{frequency} * tick_period_us) << 6U, 1'000'000);
  const std::int64_t omega_step = shift_right_rounding(turns * half_pi, 29);
  const std::int64_t fast = divide_nearest(shift_right_rounding(omega_step * time_ratio, 4), std::int64_t{x});
  constexpr std::int64_t stable = 1 << 28;
  const auto fast_step = static_cast<std::int32_t>(std::min(fast, stable));
  const auto slow_step = static_cast<std::int32_t>(divide_nearest(std::int64_t{fast_step} << 28U, time_ratio));
  return {fast_step, slow_step, x};
}

void advance(MatsuokaPair& now, const std::int32_t* steps, std::int32_t fatigue, std::int32_t inhibition,
             std::int32_t input1, std::int32_t input2) {
  const std::int32_t fast_step = steps[0];
  const std::int32_t slow_step = steps[1];
  for (unsigned i = 0; i < MatsuokaConstants::steps_in_a_tick; ++i) {
    const std::int32_t y1 = now.y1();
    const std::int32_t y2 = now.y2();
    now.u1 = potential(now.u1, y2, now.v1, fast_step, fatigue, inhibition, input1);
    now.u2 = potential(now.u2, y1, now.v2, fast_step, fatigue, inhibition, input2);
    now.v1 = tiredness(now.v1, y1, slow_step);
    now.v2 = tiredness(now.v2, y2, slow_step);
  }
}

}  // namespace proleg
