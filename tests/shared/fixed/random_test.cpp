#include "shared/fixed/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace proleg {
namespace {

// Output of the reference implementation (pcg-c-basic, pcg32-demo) for seed 42, stream 54.
TEST(Pcg32, GivesThePublishedReferenceOutput) {
  Pcg32 random(42, 54);
  const std::array<std::uint32_t, 6> published = {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U,
                                                  0x83d2f293U, 0xbfa4784bU, 0xcbed606eU};
  for (const std::uint32_t expected : published) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(Pcg32, RepeatsItselfForTheSameSeedAndStreamOnly) {
  Pcg32 first(1, 2);
  Pcg32 same(1, 2);
  Pcg32 other_seed(3, 2);
  Pcg32 other_stream(1, 4);
  int equal_to_other_seed = 0;
  int equal_to_other_stream = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t value = first.next();
    EXPECT_EQ(value, same.next());
    equal_to_other_seed += value == other_seed.next() ? 1 : 0;
    equal_to_other_stream += value == other_stream.next() ? 1 : 0;
  }
  EXPECT_LE(equal_to_other_seed, 1);
  EXPECT_LE(equal_to_other_stream, 1);
}

TEST(Pcg32, DrawsUniformlyBelowABound) {
  for (const std::uint32_t bound : {1U, 2U, 6U, 100U}) {
    Pcg32 random(2013, bound);
    const unsigned draws = 20000 * bound;
    std::vector<double> histogram(bound, 0);
    for (unsigned i = 0; i < draws; ++i) {
      const std::uint32_t value = random.below(bound);
      ASSERT_LT(value, bound);
      histogram[value] += 1;
    }
    double chi_squared = 0;
    for (const double count : histogram) {
      chi_squared += (count - 20000) * (count - 20000) / 20000;
    }
    // The statistic has the mean bound - 1 and the deviation sqrt(2 (bound - 1)); five deviations are allowed.
    EXPECT_LE(chi_squared, bound - 1 + 5 * std::sqrt(2.0 * (bound - 1))) << "bound " << bound;
  }
}

// The remainder alone would hit the lower third of this range twice as often.
TEST(Pcg32, DrawsWithoutBiasBelowALargeBound) {
  constexpr std::uint32_t bound = 3U << 30U;
  Pcg32 random(5, 5);
  int in_lower_third = 0;
  constexpr int draws = 100000;
  for (int i = 0; i < draws; ++i) {
    in_lower_third += random.below(bound) < bound / 3 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(in_lower_third) / draws, 1.0 / 3, 0.01);
}

TEST(Pcg32, DrawsGaussianNoiseOfMeanZeroAndDeviationOne) {
  Pcg32 random(30, 6);
  constexpr int draws = 1'000'000;
  double sum = 0;
  double sum_of_squares = 0;
  int within_one = 0;
  int within_two = 0;
  std::int32_t furthest = 0;
  for (int i = 0; i < draws; ++i) {
    const std::int32_t sample = random.gaussian();
    const double value = sample / 65536.0;
    sum += value;
    sum_of_squares += value * value;
    within_one += std::abs(value) < 1 ? 1 : 0;
    within_two += std::abs(value) < 2 ? 1 : 0;
    furthest = std::max(furthest, std::abs(sample));
  }
  EXPECT_NEAR(sum / draws, 0, 0.005);
  EXPECT_NEAR(std::sqrt(sum_of_squares / draws), 1, 0.005);
  // The normal distribution has 68.3 % and 95.4 %.
  EXPECT_NEAR(static_cast<double>(within_one) / draws, 0.683, 0.01);
  EXPECT_NEAR(static_cast<double>(within_two) / draws, 0.954, 0.01);
  EXPECT_LE(furthest, 6 * 65536);
  EXPECT_GE(furthest, 4 * 65536) << "a million draws reach beyond four deviations";
}

}  // namespace
}  // namespace proleg
