#include "shared/gait/critical_filter.hpp"

#include <algorithm>

#include "shared/fixed/exponential.hpp"

namespace proleg {

CriticalFilter make_critical_filter(std::int32_t rate, std::uint32_t tick_period_us) {
  const std::int64_t half_rate = divide_nearest((std::int64_t{rate} * tick_period_us) << 5U, 1'000'000);
  const auto limited = static_cast<std::int32_t>(std::min(half_rate, std::int64_t{1} << 30U));
  // exp(-x) takes Q24. For the bits of Q30 below that, 1 - x is used for exp(-x).
  const std::int32_t coarse = exponential_decay(limited >> 6);
  const std::int32_t decay = coarse - multiply(coarse, limited & 63, 30);
  // Two roundings in a tick of half a step each can stop e and u up to 4 / (h dt) steps away from 0.
  const std::int32_t arrived = saturate(64 + (std::int64_t{1} << 32U) / std::max<std::int32_t>(limited, 1));
  return {limited, decay, arrived};
}

[[gnu::noinline]] void follow(const CriticalFilter& filter, std::int32_t target, const std::int32_t* state,
                              std::int32_t* next) {
  std::int32_t rate = state[1];
  next[0] = approach(filter, target, state[0], rate);
  next[1] = rate;
}

}  // namespace proleg
