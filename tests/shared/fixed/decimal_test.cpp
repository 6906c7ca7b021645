#include "shared/fixed/decimal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace proleg {
namespace {

__extension__ typedef __int128 Wide;

constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t highest = std::numeric_limits<std::int32_t>::max();
constexpr Unit all_units[] = {Unit::degree,     Unit::phase_degree, Unit::hertz,
                              Unit::per_second, Unit::ratio,        Unit::count};

/// The scale of a unit, from its documentation and not from scale_of(): steps = value * numerator / denominator.
struct Worth {
  Wide numerator;
  Wide denominator;
  int binary_places;  ///< a step is a multiple of 2^-binary_places of the unit
};

Worth worth_of(Unit unit) {
  switch (unit) {
    case Unit::degree:
    case Unit::phase_degree:
      return {Wide{1} << 30, 90, 29};
    case Unit::hertz:
    case Unit::per_second:
      return {Wide{1} << 24, 1, 24};
    case Unit::ratio:
      return {Wide{1} << 28, 1, 28};
    case Unit::count:
      break;
  }
  return {1, 1, 0};
}

Wide power_of(int base, int exponent) {
  Wide result = 1;
  for (int i = 0; i < exponent; ++i) {
    result *= base;
  }
  return result;
}

/// numerator / denominator to the nearest integer, ties to even; both positive.
Wide nearest_even(Wide numerator, Wide denominator) {
  Wide quotient = numerator / denominator;
  const Wide twice = 2 * (numerator % denominator);
  if (twice > denominator || (twice == denominator && quotient % 2 != 0)) {
    ++quotient;
  }
  return quotient;
}

std::string digits_of(Wide value) {
  std::string text;
  do {
    text.insert(text.begin(), static_cast<char>('0' + static_cast<int>(value % 10)));
    value /= 10;
  } while (value > 0);
  return text;
}

/// `value` / 10^places as text.
std::string with_point(Wide value, int places) {
  std::string text = digits_of(value);
  while (text.size() <= static_cast<std::size_t>(places)) {
    text.insert(text.begin(), '0');
  }
  if (places > 0) {
    text.insert(text.size() - static_cast<std::size_t>(places), ".");
  }
  return text;
}

std::optional<std::int32_t> expected_raw(bool negative, Wide steps, Unit unit) {
  const Wide value = negative ? -steps : steps;
  if (unit == Unit::phase_degree) {
    constexpr Wide largest = Wide{1} << 48;  // 2^16 turns
    return value < largest && value > -largest
               ? std::optional(static_cast<std::int32_t>(static_cast<std::uint32_t>(value)))
               : std::nullopt;
  }
  if (value > highest || value < lowest) {
    return std::nullopt;
  }
  return static_cast<std::int32_t>(value);
}

void expect_parse(const std::string& text, Unit unit, std::optional<std::int32_t> expected) {
  const DecimalResult result = parse_decimal(text, unit);
  if (expected) {
    ASSERT_EQ(result.error, DecimalError::none) << text << " as unit " << static_cast<int>(unit);
    ASSERT_EQ(result.raw, *expected) << text << " as unit " << static_cast<int>(unit);
  } else {
    ASSERT_EQ(result.error, DecimalError::out_of_range) << text << " as unit " << static_cast<int>(unit);
    ASSERT_EQ(result.raw, 0);
  }
}

TEST(ParseDecimal, EqualsExactRationalArithmeticForRandomTexts) {
  std::mt19937_64 random(42);
  for (int i = 0; i < 100'000; ++i) {
    const Unit unit = all_units[random() % std::size(all_units)];
    const int digit_count = 1 + static_cast<int>(random() % 14);
    const Wide digits = static_cast<std::int64_t>(random() >> 2U) % power_of(10, digit_count);
    const int places = static_cast<int>(random() % 13);
    const int exponent = static_cast<int>(random() % 9) - 4;
    const bool negative = random() % 2 == 0;
    const bool with_exponent = random() % 2 == 0;

    std::string text = (negative ? "-" : (random() % 4 == 0 ? "+" : "")) + with_point(digits, places);
    int shift = -places;
    if (with_exponent) {
      text += (random() % 2 == 0 ? "e" : "E") + std::string(exponent >= 0 && random() % 2 == 0 ? "+" : "") +
              std::to_string(exponent);
      shift += exponent;
    }
    const Worth worth = worth_of(unit);
    const Wide steps = nearest_even(digits * worth.numerator * power_of(10, std::max(shift, 0)),
                                    worth.denominator * power_of(10, std::max(-shift, 0)));
    expect_parse(text, unit, expected_raw(negative, steps, unit));
  }
}

// Half a step is a finite decimal number in every unit, because a step is a whole number over a power of two.
TEST(ParseDecimal, RoundsExactTiesToEvenAndTheSlightestExcessAwayFromTheTie) {
  std::mt19937_64 random(7);
  for (const Unit unit : all_units) {
    const Worth worth = worth_of(unit);
    const int places = worth.binary_places + 1;
    const Wide unit_times_power = worth.denominator == 90 ? Wide{45} : Wide{1};
    for (int i = 0; i < 2000; ++i) {
      const std::int64_t below = i < 4 ? i : static_cast<std::int64_t>(random() % 2'000'000'000);
      // (below + 1/2) steps = (2 below + 1) * unit_times_power / 2^places, and 1/2^p = 5^p / 10^p.
      const Wide tie = (2 * Wide{below} + 1) * unit_times_power * power_of(5, places);
      const auto even = static_cast<std::int32_t>(below % 2 == 0 ? below : below + 1);
      const auto lower = static_cast<std::int32_t>(below);
      const std::string at = with_point(tie, places);
      const std::string above = at + "000000000001";
      const std::string under = with_point(tie - 1, places) + "999999999999";
      expect_parse(at, unit, even);
      expect_parse("-" + at, unit, -even);
      expect_parse(above, unit, lower + 1);
      expect_parse("-" + above, unit, -lower - 1);
      expect_parse(under, unit, lower);
      expect_parse("-" + under, unit, -lower);
    }
  }
}

TEST(ParseDecimal, ReadsTheSameNumberHoweverItIsWritten) {
  for (const char* text : {"55", "+55", "55.", "55.000", "0055", "5.5e1", "5.5E+1", "0.55e2", "550e-1", ".55e02",
                           "5500000000000000000000000000000000000000e-38"}) {
    expect_parse(text, Unit::phase_degree, 0x271C71C7);
  }
}

TEST(ParseDecimal, ReadsWhatRoundsToTheEndOfTheRangeAndRefusesTheNextStep) {
  expect_parse("2147483647", Unit::count, highest);
  expect_parse("2147483647.4999", Unit::count, highest);
  expect_parse("2147483647.5", Unit::count, std::nullopt);
  expect_parse("2147483648", Unit::count, std::nullopt);
  expect_parse("-2147483648", Unit::count, lowest);
  expect_parse("-2147483648.5", Unit::count, lowest);
  expect_parse("-2147483648.51", Unit::count, std::nullopt);
  expect_parse("127.99999994", Unit::hertz, highest);
  expect_parse("128", Unit::hertz, std::nullopt);
  expect_parse("-128", Unit::hertz, lowest);
  expect_parse("8", Unit::ratio, std::nullopt);
  expect_parse("-8", Unit::ratio, lowest);
  expect_parse("1e60", Unit::ratio, std::nullopt);
  expect_parse("-1e60", Unit::count, std::nullopt);
  expect_parse("1e-60", Unit::count, 0);
}

TEST(ParseDecimal, WrapsTurnsOfPhaseAndRefusesThemAsAnAngle) {
  expect_parse("180", Unit::phase_degree, lowest);
  expect_parse("-180", Unit::phase_degree, lowest);
  expect_parse("180.00000001", Unit::phase_degree, lowest);
  expect_parse("180.0000001", Unit::phase_degree, lowest + 1);
  expect_parse("235", Unit::phase_degree, parse_decimal("-125", Unit::phase_degree).raw);
  expect_parse("-400", Unit::phase_degree, parse_decimal("-40", Unit::phase_degree).raw);
  expect_parse("720", Unit::phase_degree, 0);
  expect_parse("23592959", Unit::phase_degree, parse_decimal("-1", Unit::phase_degree).raw);
  expect_parse("23592960", Unit::phase_degree, std::nullopt);
  expect_parse("180", Unit::degree, std::nullopt);
  expect_parse("-180", Unit::degree, lowest);
  expect_parse("179.9999999", Unit::degree, highest);
}

TEST(ParseDecimal, RefusesWhatIsNotADecimalNumber) {
  for (const char* text :
       {"",     " ",   "+",   "-",     ".",   "+.", "e",     "e5",       ".e1",   "1e",  "1e+", "1e-",  "1e1.5",
        "0x10", "nan", "inf", "-inf",  "NaN", " 1", "1 ",    "1\n",      "1,5",   "--1", "+-1", "1..5", "1.2.3",
        "1e5e", "1d5", "1f",  "1'000", "1_0", "½",  "1 000", "infinity", "1e--1", "1-",  "0b1", "1e0x1"}) {
    const DecimalResult result = parse_decimal(text, Unit::ratio);
    EXPECT_EQ(result.error, DecimalError::not_a_number) << '"' << text << '"';
    EXPECT_EQ(result.raw, 0) << '"' << text << '"';
  }
  EXPECT_EQ(parse_decimal(std::string_view("1\0", 2), Unit::ratio).error, DecimalError::not_a_number);
}

TEST(ParseDecimal, TakesSixtySignificantDigitsAndRefusesMore) {
  const std::string sixty(60, '1');
  expect_parse("0." + sixty, Unit::count, 0);
  expect_parse(sixty, Unit::count, std::nullopt);
  EXPECT_EQ(parse_decimal(sixty + "1", Unit::count).error, DecimalError::too_many_digits);
  EXPECT_EQ(parse_decimal(std::string(100, '9'), Unit::ratio).error, DecimalError::too_many_digits);
  EXPECT_EQ(parse_decimal("0." + std::string(61, '0'), Unit::ratio).error, DecimalError::too_many_digits);
  expect_parse(std::string(100, '0') + "7", Unit::count, 7);
}

TEST(ParseDecimal, RefusesExponentsBeyondSixty) {
  expect_parse("0e60", Unit::count, 0);
  for (const char* text : {"1e61", "1e-61", "1e99999999999999999999", "1e-99999999999999999999"}) {
    EXPECT_EQ(parse_decimal(text, Unit::ratio).error, DecimalError::too_many_digits) << text;
  }
}

// The largest intermediate numbers: 60 digits shifted by 60 places, up and down.
TEST(ParseDecimal, KeepsItsHeadAtTheLongestNumbers) {
  const std::string nines(60, '9');
  expect_parse(nines + "e60", Unit::degree, std::nullopt);
  expect_parse("-" + nines + "e60", Unit::ratio, std::nullopt);
  expect_parse("0." + nines + "e-60", Unit::degree, 0);
  expect_parse(nines + "e-60", Unit::count, 1);
  expect_parse("0." + std::string(59, '0') + "1e60", Unit::count, 1);
  expect_parse("0." + std::string(59, '0') + "9e60", Unit::phase_degree, raw(Unit::phase_degree, 9));
}

std::vector<std::int32_t> telling_values() {
  std::vector<std::int32_t> values = {lowest, lowest + 1, -1, 0, 1, highest - 1, highest, 1 << 30, -(1 << 30), 1 << 24};
  std::mt19937 random(99);
  for (int i = 0; i < 3000; ++i) {
    values.push_back(static_cast<std::int32_t>(random() >> (random() % 32)) * (random() % 2 == 0 ? 1 : -1));
  }
  return values;
}

TEST(FormatDecimal, IsReadBackAsTheSameStepInEveryUnit) {
  for (const Unit unit : all_units) {
    for (const std::int32_t value : telling_values()) {
      const DecimalText text = format_decimal(value, unit);
      const DecimalResult back = parse_decimal(text.view(), unit);
      ASSERT_EQ(back.error, DecimalError::none) << text.view();
      ASSERT_EQ(back.raw, value) << text.view() << " as unit " << static_cast<int>(unit);
    }
  }
}

// With one digit less, neither the number below nor the number above means the same step.
TEST(FormatDecimal, IsTheShortestTextOfItsStep) {
  for (const Unit unit : all_units) {
    for (const std::int32_t value : telling_values()) {
      const std::string text(format_decimal(value, unit).view());
      const std::size_t point = text.find('.');
      if (point == std::string::npos) {
        continue;
      }
      const int places = static_cast<int>(text.size() - point) - 1;
      Wide digits = 0;
      for (const char c : text) {
        digits = c >= '0' && c <= '9' ? digits * 10 + (c - '0') : digits;
      }
      for (const Wide shorter : {digits / 10, digits / 10 + 1}) {
        const std::string candidate = (value < 0 ? "-" : "") + with_point(shorter, places - 1);
        const DecimalResult back = parse_decimal(candidate, unit);
        ASSERT_FALSE(back.error == DecimalError::none && back.raw == value) << candidate << " instead of " << text;
      }
    }
  }
}

TEST(FormatDecimal, WritesRoundNumbersAsAPersonWould) {
  EXPECT_EQ(format_decimal(raw(Unit::degree, 40), Unit::degree).view(), "40");
  EXPECT_EQ(format_decimal(raw(Unit::phase_degree, 55), Unit::phase_degree).view(), "55");
  EXPECT_EQ(format_decimal(raw(Unit::phase_degree, -8873, 100), Unit::phase_degree).view(), "-88.73");
  EXPECT_EQ(format_decimal(lowest, Unit::phase_degree).view(), "-180");
  EXPECT_EQ(format_decimal(raw(Unit::hertz, 1, 2), Unit::hertz).view(), "0.5");
  EXPECT_EQ(format_decimal(0, Unit::ratio).view(), "0");
  EXPECT_EQ(format_decimal(lowest, Unit::count).view(), "-2147483648");
}

}  // namespace
}  // namespace proleg
