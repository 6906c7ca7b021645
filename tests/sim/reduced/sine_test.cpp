#include "sim/reduced/sine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/from_environment.hpp"

// Oracle: sinl and cosl, whose 64 bits of mantissa leave errors far below those that are allowed here.

namespace proleg::sim::reduced {
namespace {

constexpr double max_angle = 1e6;  // rad

/// Of both signs, small and large; and near the multiples of pi / 4, where the reduction changes and values are near 0.
std::vector<double> angles() {
  const std::uint32_t seed = from_environment("PROLEG_SEED", 17);
  testing::Test::RecordProperty("seed", static_cast<int>(seed));
  SCOPED_TRACE(seed);
  std::vector<double> result{0.0, -0.0, max_angle, -max_angle};
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100'000; ++i) {
    for (const double range : {1.0, 10.0, 1e3, max_angle}) {
      result.push_back(std::uniform_real_distribution(-range, range)(random));
    }
    const double eighth = std::numbers::pi / 4 * std::uniform_int_distribution(-1'273'000, 1'273'000)(random);
    result.insert(result.end(), {eighth, std::nextafter(eighth, -1e9), std::nextafter(eighth, 1e9), eighth + 1e-9});
  }
  return result;
}

TEST(Sine, IsWithinThreeTenThousandMillionMillionths) {
  for (const double angle : angles()) {
    const SineCosine<Lanes<2>::Number> result = sine_cosine<2>(Lanes<2>::number(angle));
    ASSERT_LT(std::abs(result.sine[0] - sinl(static_cast<long double>(angle))), 3e-16L) << std::hexfloat << angle;
    ASSERT_LT(std::abs(result.cosine[0] - cosl(static_cast<long double>(angle))), 3e-16L) << std::hexfloat << angle;
  }
}

/// The bits of all sines and cosines, width angles at a time.
template <int width>
std::vector<std::uint64_t> bits_of(const std::vector<double>& angles) {
  std::vector<std::uint64_t> bits;
  for (std::size_t first = 0; first + width <= angles.size(); first += width) {
    typename Lanes<width>::Number lanes{};
    for (int lane = 0; lane < width; ++lane) {
      lanes[lane] = angles[first + static_cast<std::size_t>(lane)];
    }
    const auto result = sine_cosine<width>(lanes);
    for (int lane = 0; lane < width; ++lane) {
      for (const double value : {result.sine[lane], result.cosine[lane]}) {
        std::memcpy(&bits.emplace_back(), &value, sizeof value);
      }
    }
  }
  return bits;
}

TEST(Sine, HasTheSameBitsInLanesOfAnyWidth) {
  std::vector<double> all = angles();
  all.resize(all.size() / 8 * 8);
  const std::vector<std::uint64_t> expected = bits_of<2>(all);
  EXPECT_EQ(bits_of<4>(all), expected);
  EXPECT_EQ(bits_of<8>(all), expected);
}

}  // namespace
}  // namespace proleg::sim::reduced
