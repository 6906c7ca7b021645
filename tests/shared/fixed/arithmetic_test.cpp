#include "shared/fixed/arithmetic.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "shared/fixed/unit.hpp"

namespace proleg {
namespace {

__extension__ typedef __int128 Wide;

constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();

// The helpers serve in declarations, so all of them work at compile time.
static_assert(shift_right_rounding(3, 1) == 2);
static_assert(saturate(std::int64_t{1} << 40) == highest);
static_assert(add_saturating(highest, 1) == highest);
static_assert(subtract_saturating(lowest, 1) == lowest);
static_assert(multiply(1 << 30, 1 << 29, 30) == 1 << 29);
static_assert(add_wrapping(highest, 1) == lowest);
static_assert(subtract_wrapping(lowest, 1) == highest);
static_assert(divide_nearest(7, 2) == 4);

const std::vector<std::int32_t>& telling_values() {
  static const std::vector<std::int32_t> values = {
      lowest, lowest + 1, -(1 << 30) - 1, -(1 << 30),    -(1 << 30) + 1, -65536,        -3,          -2,     -1, 0, 1,
      2,      3,          65536,          (1 << 30) - 1, 1 << 30,        (1 << 30) + 1, highest - 1, highest};
  return values;
}

/// floor(value / 2^bits + 1/2) by division instead of by shifts.
Wide nearest_half_up(Wide value, unsigned bits) {
  const Wide divisor = Wide{1} << bits;
  const Wide shifted = value + divisor / 2;
  const Wide quotient = shifted / divisor;
  return shifted % divisor < 0 ? quotient - 1 : quotient;
}

Wide clamped(Wide value) { return value > highest ? Wide{highest} : (value < lowest ? Wide{lowest} : value); }

TEST(ShiftRightRounding, RoundsTiesTowardsPlusInfinity) {
  EXPECT_EQ(shift_right_rounding(1, 1), 1);
  EXPECT_EQ(shift_right_rounding(-1, 1), 0);
  EXPECT_EQ(shift_right_rounding(-3, 1), -1);
  EXPECT_EQ(shift_right_rounding(8, 4), 1);
  EXPECT_EQ(shift_right_rounding(7, 4), 0);
  EXPECT_EQ(shift_right_rounding(-8, 4), 0);
  EXPECT_EQ(shift_right_rounding(-9, 4), -1);
}

TEST(ShiftRightRounding, EqualsExactDivisionForEveryShift) {
  std::mt19937_64 random(20130601);
  for (unsigned bits = 1; bits <= 62; ++bits) {
    // Half-way cases and their neighbours, and what the documented range allows at its ends.
    const std::int64_t half = std::int64_t{1} << (bits - 1);
    const std::int64_t end = std::numeric_limits<std::int64_t>::max() - half;
    std::vector<std::int64_t> values = {0, 1, -1, half, half - 1, -half, -half - 1, -half + 1, end, -end};
    for (int i = 0; i < 100; ++i) {
      values.push_back(static_cast<std::int64_t>(random()) % end);
    }
    for (const std::int64_t value : values) {
      ASSERT_EQ(Wide{shift_right_rounding(value, bits)}, nearest_half_up(value, bits)) << value << " >> " << bits;
    }
  }
}

TEST(Saturate, KeepsWhatFitsAndCutsTheRest) {
  EXPECT_EQ(saturate(highest), highest);
  EXPECT_EQ(saturate(std::int64_t{highest} + 1), highest);
  EXPECT_EQ(saturate(lowest), lowest);
  EXPECT_EQ(saturate(std::int64_t{lowest} - 1), lowest);
  EXPECT_EQ(saturate(std::numeric_limits<std::int64_t>::max()), highest);
  EXPECT_EQ(saturate(std::numeric_limits<std::int64_t>::min()), lowest);
  EXPECT_EQ(saturate(-5), -5);
}

TEST(AddSaturating, EqualsTheClampedExactSum) {
  for (const std::int32_t a : telling_values()) {
    for (const std::int32_t b : telling_values()) {
      ASSERT_EQ(Wide{add_saturating(a, b)}, clamped(Wide{a} + b)) << a << " + " << b;
    }
  }
}

TEST(SubtractSaturating, EqualsTheClampedExactDifference) {
  for (const std::int32_t a : telling_values()) {
    for (const std::int32_t b : telling_values()) {
      ASSERT_EQ(Wide{subtract_saturating(a, b)}, clamped(Wide{a} - b)) << a << " - " << b;
    }
  }
}

TEST(MultiplyByHalves, EqualsTheProductThatTheProcessorForms) {
  constexpr std::uint32_t edges[] = {0,       1,           2,           0x7FFF,      0x8000,      0xFFFF,
                                     0x10000, 0x10001,     0x7FFFFFFF,  0x80000000U, 0x80000001U, 0xFFFF0000U,
                                     0xFFFF,  0xFFFFFFFEU, 0xFFFFFFFFU, 0x0001FFFF};
  for (const std::uint32_t a : edges) {
    for (const std::uint32_t b : edges) {
      EXPECT_EQ(multiply_by_halves(a, b), std::uint64_t{a} * b) << a << " * " << b;
    }
  }
  std::mt19937 random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    const auto a = static_cast<std::uint32_t>(random());
    const auto b = static_cast<std::uint32_t>(random());
    ASSERT_EQ(multiply_by_halves(a, b), std::uint64_t{a} * b) << a << " * " << b;
  }
}

TEST(MultiplyWide, IsTheExactProductOfSignedAndUnsignedNumbers) {
  constexpr std::int32_t edges[] = {std::numeric_limits<std::int32_t>::min(), -1, 0, 1,
                                    std::numeric_limits<std::int32_t>::max()};
  for (const std::int32_t a : edges) {
    for (const std::int32_t b : edges) {
      EXPECT_EQ(multiply_wide(a, b), std::int64_t{a} * b) << a << " * " << b;
    }
  }
  EXPECT_EQ(multiply_wide(0xFFFFFFFFU, 0xFFFFFFFFU), 0xFFFFFFFE00000001U);
}

TEST(Multiply, EqualsTheRoundedExactProductWhereItFits) {
  for (const std::int32_t a : telling_values()) {
    for (const std::int32_t b : telling_values()) {
      for (const unsigned bits : {1U, 16U, 28U, 30U, 31U}) {
        const Wide exact = nearest_half_up(Wide{a} * b, bits);
        if (exact == clamped(exact)) {
          ASSERT_EQ(Wide{multiply(a, b, bits)}, exact) << a << " * " << b << " >> " << bits;
        }
      }
    }
  }
}

TEST(WrappingSums, AreExactModuloTwoToThe32) {
  const auto congruent = [](Wide a, Wide b) { return (a - b) % (Wide{1} << 32) == 0; };
  for (const std::int32_t a : telling_values()) {
    for (const std::int32_t b : telling_values()) {
      ASSERT_TRUE(congruent(add_wrapping(a, b), Wide{a} + b)) << a << " + " << b;
      ASSERT_TRUE(congruent(subtract_wrapping(a, b), Wide{a} - b)) << a << " - " << b;
    }
  }
  EXPECT_EQ(subtract_wrapping(0, lowest), lowest) << "an exact half turn is negative";
}

TEST(DivideNearest, RoundsTiesAwayFromZero) {
  EXPECT_EQ(divide_nearest(5, 2), 3);
  EXPECT_EQ(divide_nearest(-5, 2), -3);
  EXPECT_EQ(divide_nearest(4, 3), 1);
  EXPECT_EQ(divide_nearest(5, 3), 2);
  EXPECT_EQ(divide_nearest(-4, 3), -1);
  EXPECT_EQ(divide_nearest(-5, 3), -2);
  EXPECT_EQ(divide_nearest(0, 7), 0);
  EXPECT_EQ(divide_nearest(std::int64_t{1} << 60, 1), std::int64_t{1} << 60);
}

TEST(DivideNearest, IsNeverFurtherThanHalfADivisorFromTheNumerator) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 10000; ++i) {
    const auto numerator = static_cast<std::int64_t>(random()) / 4;
    const auto denominator = static_cast<std::int64_t>(random() % 1'000'000'000) + 1;
    const Wide remainder = Wide{numerator} - Wide{divide_nearest(numerator, denominator)} * denominator;
    ASSERT_LE(2 * (remainder < 0 ? -remainder : remainder), Wide{denominator}) << numerator << " / " << denominator;
  }
}

TEST(Raw, GivesTheDocumentedStepsOfEveryUnit) {
  EXPECT_EQ(raw(Unit::degree, 90), 1 << 30);
  EXPECT_EQ(raw(Unit::phase_degree, 90), 1 << 30);
  EXPECT_EQ(raw(Unit::phase_degree, 55), 0x271C71C7);
  EXPECT_EQ(raw(Unit::phase_degree, 8873, 100), 0x3F18CDB6);
  EXPECT_EQ(raw(Unit::phase_degree, 120), 0x55555555);
  EXPECT_EQ(raw(Unit::hertz, 1), 1 << 24);
  EXPECT_EQ(raw(Unit::per_second, 1, 2), 1 << 23);
  EXPECT_EQ(raw(Unit::ratio, -1), -(1 << 28));
  EXPECT_EQ(raw(Unit::count, 7), 7);
}

TEST(SquareRoot, IsTheLargestIntegerWhoseSquareFits) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t value = random() >> (random() % 64U);
    const std::uint64_t root = square_root(value);
    ASSERT_LE(root * root, value);
    ASSERT_TRUE(root == 0xFFFF'FFFFU || (root + 1) * (root + 1) > value) << value;
  }
}

TEST(SquareRoot, IsExactForSquaresAndAtTheEnds) {
  EXPECT_EQ(square_root(0), 0U);
  EXPECT_EQ(square_root(1), 1U);
  EXPECT_EQ(square_root(144), 12U);
  EXPECT_EQ(square_root(0xFFFF'FFFF'FFFF'FFFFU), 0xFFFF'FFFFU);
  EXPECT_EQ(square_root(0xFFFF'FFFE'0000'0001U), 0xFFFF'FFFFU);
  EXPECT_EQ(square_root(0xFFFF'FFFE'0000'0000U), 0xFFFF'FFFEU);
}

}  // namespace
}  // namespace proleg
