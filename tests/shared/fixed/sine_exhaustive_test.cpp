// All 2^32 inputs of the sine. The true sine is symmetric about the crest and about half a turn, so it is evaluated
// for one quarter; the core is evaluated for all four. Double precision is off by 1e-16, a small part of the errors
// looked for (sine_test.cpp compares with long double).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <thread>

#include "shared/fixed/sine.hpp"

namespace proleg {
namespace {

constexpr std::int32_t one = 1 << 30;
constexpr std::uint32_t quarter = 0x40000000U;
constexpr std::uint32_t half = 0x80000000U;

struct Findings {
  double max_error = 0;
  double sum_of_errors = 0;
  double sum_of_absolute_errors = 0;
  std::int32_t max_step_back = 0;
  std::uint64_t asymmetric = 0;
  std::uint64_t beyond_crest = 0;
};

/// Checks inputs first..last of the rising quarter, and their images in the other three.
Findings sweep(std::uint32_t first, std::uint32_t last) {
  Findings found;
  std::int32_t highest = sine(first);
  for (std::uint32_t phase = first; phase <= last; ++phase) {
    const std::int32_t value = sine(phase);
    const double error =
        static_cast<double>(value) / one - std::sin(static_cast<double>(phase) * (std::numbers::pi / 2147483648.0));
    found.max_error = std::max(found.max_error, std::abs(error));
    found.sum_of_errors += error;
    found.sum_of_absolute_errors += std::abs(error);
    found.max_step_back = std::max(found.max_step_back, highest - value);
    highest = std::max(highest, value);
    found.asymmetric += sine(half - phase) != value ? 1U : 0U;
    found.asymmetric += sine(half + phase) != -value ? 1U : 0U;
    found.asymmetric += sine(0U - phase) != -value ? 1U : 0U;
    found.beyond_crest += value > one || value < 0 ? 1U : 0U;
  }
  return found;
}

TEST(SineExhaustive, KeepsItsPromisesForEveryInput) {
  Findings lower;
  Findings upper;
  // Both threads visit the middle, so that no step between neighbours is left out.
  std::thread other([&lower] { lower = sweep(0, quarter / 2); });
  upper = sweep(quarter / 2, quarter);
  other.join();

  const double max_error = std::max(lower.max_error, upper.max_error);
  const auto visited = static_cast<double>(quarter) + 2;
  std::cout << "largest error " << max_error << ", mean over the rising quarter "
            << (lower.sum_of_errors + upper.sum_of_errors) / visited << ", mean of the absolute error "
            << (lower.sum_of_absolute_errors + upper.sum_of_absolute_errors) / visited << ", largest step back "
            << std::max(lower.max_step_back, upper.max_step_back) << " lsb\n";
  EXPECT_LE(max_error, 7e-7);
  EXPECT_LE(max_error, 7.3e-9);
  EXPECT_LE(std::max(lower.max_step_back, upper.max_step_back), 1);
  EXPECT_EQ(lower.asymmetric + upper.asymmetric, 0U);
  EXPECT_EQ(lower.beyond_crest + upper.beyond_crest, 0U);
}

}  // namespace
}  // namespace proleg
