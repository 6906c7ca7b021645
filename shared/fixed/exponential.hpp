#pragma once

#include <cstdint>

namespace proleg {

/// exp(-x) for x in Q24, 0 <= x < 128. Result in Q30; largest error 2 lsb. Negative x counts as 0.
///
/// Use it for constants that are derived once when a parameter changes (the decay of a filter over one tick), not in
/// every tick. Method: x = n ln 2 + r, a Taylor series for exp(-r), n halvings.
[[nodiscard]] std::int32_t exponential_decay(std::int32_t x);

}  // namespace proleg
