#pragma once

#include <cstdint>

namespace proleg {

/// The largest integer whose square is at most `value`. Use it for constants that are derived once, not in every tick.
[[nodiscard]] constexpr std::uint32_t square_root(std::uint64_t value) {
  std::uint64_t rest = value;
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 62U; bit != 0; bit >>= 2U) {
    if (rest >= root + bit) {
      rest -= root + bit;
      root = (root >> 1U) + bit;
    } else {
      root >>= 1U;
    }
  }
  return static_cast<std::uint32_t>(root);
}

}  // namespace proleg
