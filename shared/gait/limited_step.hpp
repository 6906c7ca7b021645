#pragma once

#include <cstdint>

namespace proleg {

/// The value a tick later that moves towards the target by at most `step`, which is not negative.
[[nodiscard]] inline std::int32_t step_towards(std::int32_t target, std::int32_t value, std::int32_t step) {
  const std::int64_t distance = std::int64_t{target} - value;
  // A clamp of the distance in 64 bits takes more instructions.
  if (distance > step) {
    return value + step;
  }
  return distance < -std::int64_t{step} ? value - step : target;
}

}  // namespace proleg
