// Decimal numbers without rounding. The oracle for raw values is parse_decimal, which has its own tests against
// rational arithmetic.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shared/fixed/decimal.hpp"
#include "sim/optimize/experiment/value_set.hpp"

namespace proleg::optimize {
namespace {

Decimal decimal(const std::string& text) {
  const std::optional<Decimal> number = Decimal::parse(text);
  EXPECT_TRUE(number) << text;
  return number.value_or(Decimal());
}

TEST(DecimalNumber, IsWhatItsTextSays) {
  constexpr Decimal::Wide one = 1'000'000'000'000'000;
  EXPECT_EQ(decimal("0.25").quanta(), one / 4);
  EXPECT_EQ(decimal("-12").quanta(), -12 * one);
  EXPECT_EQ(decimal("+.5").quanta(), one / 2);
  EXPECT_EQ(decimal("7.").quanta(), 7 * one);
  EXPECT_EQ(decimal("1e3").quanta(), 1000 * one);
  EXPECT_EQ(decimal("25e-2").quanta(), one / 4);
  EXPECT_EQ(decimal("0.00000000025E+9").quanta(), one / 4);
  EXPECT_EQ(decimal("1e-15").quanta(), 1);
  EXPECT_EQ(decimal("9999999999.999999999999999").quanta(), 10'000'000'000 * one - 1);
  EXPECT_EQ(decimal("0e60").quanta(), 0);
}

TEST(DecimalNumber, IsNothingElse) {
  for (const char* text : {"",
                           "-",
                           ".",
                           "1e",
                           "1e+",
                           "e5",
                           "0x10",
                           "inf",
                           "nan",
                           " 1",
                           "1 ",
                           "1,5",
                           "--1",
                           "1.2.3",
                           "10000000000",
                           "-1e10",
                           "1e-16",
                           "0.1234567890123456",
                           "1e61",
                           "99999999999999999999999999999999999999999999999999999999999"}) {
    EXPECT_FALSE(Decimal::parse(text)) << text;
  }
}

TEST(DecimalNumber, HasTheShortestText) {
  for (const char* text : {"0", "1", "-1", "0.25", "-0.05", "40", "9999999999", "0.000000000000001", "12.3", "100"}) {
    EXPECT_EQ(decimal(text).text(), text);
  }
  EXPECT_EQ(decimal("-0").text(), "0");
  EXPECT_EQ(decimal("0.2500").text(), "0.25");
  EXPECT_EQ(decimal("4e1").text(), "40");
}

TEST(DecimalNumber, BecomesTheRawValueThatItsTextBecomes) {
  constexpr std::uint64_t seed = 20'130'401;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> digits(-2'000'000'000, 2'000'000'000);
  std::uniform_int_distribution<int> places(0, 15);
  int compared = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::string text = std::to_string(digits(random)) + "e-" + std::to_string(places(random));
    for (const Unit unit :
         {Unit::degree, Unit::phase_degree, Unit::hertz, Unit::per_second, Unit::ratio, Unit::count}) {
      if (const DecimalResult expected = parse_decimal(text, unit); expected.error == DecimalError::none) {
        ASSERT_EQ(decimal(text).raw(unit), expected.raw) << text << ", seed " << seed;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 50'000);
}

TEST(DecimalNumber, RoundsTiesToEven) {
  EXPECT_EQ(decimal("0.5").raw(Unit::count), 0);
  EXPECT_EQ(decimal("1.5").raw(Unit::count), 2);
  EXPECT_EQ(decimal("2.5").raw(Unit::count), 2);
  EXPECT_EQ(decimal("-1.5").raw(Unit::count), -2);
}

TEST(Range, OfTheThesisHas161ValuesThatAreThoseOfTheirTexts) {
  const DecimalRange range(decimal("0"), decimal("40"), decimal("0.25"));
  EXPECT_TRUE(range.step_fits());
  ASSERT_EQ(range.count(), 161U);
  for (unsigned n = 0; n < 161; ++n) {
    const std::string text = std::to_string(n * 25) + "e-2";
    EXPECT_EQ(range[n].raw(Unit::degree), parse_decimal(text, Unit::degree).raw) << text;
  }
}

TEST(Range, DoesNotDriftWhereBinaryFractionsDo) {
  const DecimalRange range(decimal("0"), decimal("1"), decimal("0.00001"));
  ASSERT_EQ(range.count(), 100'001U);
  for (unsigned n = 0; n <= 100'000; ++n) {
    EXPECT_EQ(range[n].quanta(), Decimal::Wide{n} * 10'000'000'000);
  }
  EXPECT_EQ(range[29'999].text(), "0.29999");
}

TEST(Range, TakesAStepThatFitsToOnePartInABillionAndThenEndsAtItsEnd) {
  const DecimalRange thirds(decimal("0"), decimal("1"), decimal("0.3333333333"));
  EXPECT_TRUE(thirds.step_fits());
  ASSERT_EQ(thirds.count(), 4U);
  EXPECT_EQ(thirds[2].text(), "0.6666666666");
  EXPECT_EQ(thirds[3].text(), "1");
  EXPECT_FALSE(DecimalRange(decimal("0"), decimal("1"), decimal("0.33333333")).step_fits());
}

TEST(Range, NamesTheEndsThatFit) {
  const DecimalRange range(decimal("-1"), decimal("40"), decimal("0.3"));
  EXPECT_FALSE(range.step_fits());
  EXPECT_EQ(range.fitting_below().text(), "39.8");
  EXPECT_EQ(range.fitting_above().text(), "40.1");
}

TEST(Range, MayBeOneValue) {
  const DecimalRange range(decimal("3"), decimal("3"), decimal("1"));
  EXPECT_TRUE(range.step_fits());
  EXPECT_EQ(range.count(), 1U);
  EXPECT_EQ(range[0].text(), "3");
}

TEST(Range, OfMoreValuesThanCanBeCountedIsNotFolded) {
  const DecimalRange range(decimal("-9999999999"), decimal("9999999999"), decimal("1e-15"));
  EXPECT_EQ(range.count(), std::numeric_limits<std::uint64_t>::max());
}

std::vector<Decimal> decimals(const std::vector<std::string>& texts) {
  std::vector<Decimal> numbers(texts.size());
  std::ranges::transform(texts, numbers.begin(), decimal);
  return numbers;
}

TEST(RawValues, AreEachThereOnce) {
  EXPECT_EQ(raw_values(decimals({"1", "1.2", "1.4", "2", "3"}), Unit::count), (std::vector<std::int32_t>{1, 2, 3}));
}

TEST(RawValues, OfAPhaseFollowEachOtherOverTheEndOfTheTurn) {
  constexpr std::int32_t quarter = 1 << 30;
  EXPECT_EQ(raw_values(decimals({"90", "180", "270", "360", "450"}), Unit::phase_degree),
            (std::vector<std::int32_t>{quarter, std::numeric_limits<std::int32_t>::min(), -quarter, 0}));
}

}  // namespace
}  // namespace proleg::optimize
