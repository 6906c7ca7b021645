#pragma once

#include <cstdint>

namespace proleg {

/// Seeded integer noise, the same on every computer: PCG32 (M. E. O'Neill, "PCG: A Family of Simple Fast
/// Space-Efficient Statistically Good Algorithms for Random Number Generation", 2014; variant XSH RR 64/32). Generators
/// with one seed and different streams are independent. A joint uses its index as the stream, so that its noise does
/// not depend on how many numbers other joints draw.
class Pcg32 {
 public:
  Pcg32(std::uint64_t seed, std::uint64_t stream);

  /// Draws a number that is uniform over all 2^32 values.
  [[nodiscard]] std::uint32_t next();

  /// Draws a number that is uniform over 0..bound-1, without bias. bound > 0.
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);

  /// Draws a number, in Q16 and within +-6, that is approximately normal with mean 0 and standard deviation 1: the sum
  /// of twelve uniform values (Irwin-Hall), which has exactly that mean and deviation.
  [[nodiscard]] std::int32_t gaussian();

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

}  // namespace proleg
