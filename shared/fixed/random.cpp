#include "shared/fixed/random.hpp"

namespace proleg {

Pcg32::Pcg32(std::uint64_t seed, std::uint64_t stream) : increment_((stream << 1U) | 1U) {
  static_cast<void>(next());
  state_ += seed;
  static_cast<void>(next());
}

std::uint32_t Pcg32::next() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005U + increment_;
  const auto xorshifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotation = static_cast<std::uint32_t>(old >> 59U);
  return (xorshifted >> rotation) | (xorshifted << ((32U - rotation) & 31U));
}

std::uint32_t Pcg32::below(std::uint32_t bound) {
  // Values below 2^32 mod bound would make small results more likely, so they are rejected.
  const std::uint32_t threshold = (0U - bound) % bound;
  for (;;) {
    const std::uint32_t value = next();
    if (value >= threshold) {
      return value % bound;
    }
  }
}

std::int32_t Pcg32::gaussian() {
  std::int32_t sum = 0;
  for (int i = 0; i < 6; ++i) {
    const std::uint32_t pair = next();
    sum += static_cast<std::int32_t>(pair >> 16U) + static_cast<std::int32_t>(pair & 0xFFFFU);
  }
  return sum - 6 * 65535;
}

}  // namespace proleg
