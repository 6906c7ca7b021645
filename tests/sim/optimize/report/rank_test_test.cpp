#include "sim/optimize/report/method_runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace proleg::optimize {
namespace {

using Values = std::vector<double>;

/// The p-value by its definition: all ways to choose the first group are tried.
double by_enumeration(const Values& a, const Values& b) {
  Values all = a;
  all.insert(all.end(), b.begin(), b.end());
  const auto rank = [&](double value) {
    double below = 0.0;
    double equal = 0.0;
    for (const double other : all) {
      below += other < value ? 1.0 : 0.0;
      equal += other == value ? 1.0 : 0.0;
    }
    return below + (equal + 1.0) / 2.0;
  };
  const double expected = static_cast<double>(a.size() * (all.size() + 1)) / 2.0;
  double found = 0.0;
  for (const double value : a) {
    found += rank(value);
  }
  std::vector<bool> chosen(all.size(), false);
  std::fill_n(chosen.begin(), a.size(), true);
  double ways = 0.0;
  double as_far = 0.0;
  do {
    double sum = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      sum += chosen[i] ? rank(all[i]) : 0.0;
    }
    ways += 1.0;
    as_far += std::abs(sum - expected) >= std::abs(found - expected) - 1e-9 ? 1.0 : 0.0;
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return as_far / ways;
}

TEST(RankSumTest, HasTheTabulatedValues) {
  // Complete separation: 2 of the binomial(n, n1) choices are as extreme.
  EXPECT_NEAR(rank_sum_test(Values{1, 2, 3}, Values{4, 5, 6}), 2.0 / 20.0, 1e-12);
  EXPECT_NEAR(rank_sum_test(Values{1, 2, 3, 4, 5}, Values{6, 7, 8, 9, 10}), 2.0 / 252.0, 1e-12);
  // The critical value of tables for n = 10 and 10, two-sided 5 %, is U = 23; at 24 the test does not reject.
  // The first group has the ranks 1 to 10, raised until U is as wanted.
  const auto with_u = [](int u) {
    Values first(10);
    std::iota(first.begin(), first.end(), 1.0);
    for (std::size_t i = 10; i-- > 0 && u > 0;) {
      const int raised = std::min(u, 10);
      first[i] += raised;
      u -= raised;
    }
    Values second;
    for (double rank = 1.0; rank <= 20.0; rank += 1.0) {
      if (std::ranges::count(first, rank) == 0) {
        second.push_back(rank);
      }
    }
    return rank_sum_test(first, second);
  };
  EXPECT_LE(with_u(23), 0.05);
  EXPECT_GT(with_u(24), 0.05);
}

TEST(RankSumTest, IsTheShareOfAllChoicesThatAreAsFar) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const std::size_t first = 1 + random() % 5;
    const std::size_t second = 1 + random() % 6;
    const bool has_ties = round % 2 == 0;
    const auto draw = [&](std::size_t count) {
      Values values;
      for (std::size_t i = 0; i < count; ++i) {
        values.push_back(static_cast<double>(has_ties ? random() % 4 : random()));
      }
      return values;
    };
    const Values a = draw(first);
    const Values b = draw(second);
    ASSERT_NEAR(rank_sum_test(a, b), by_enumeration(a, b), 1e-12) << "round " << round;
    ASSERT_NEAR(rank_sum_test(a, b), rank_sum_test(b, a), 1e-12);
  }
}

TEST(RankSumTest, RejectsByChanceAsOftenAsItsLevelSays) {
  // 15 against 15 is exact, 60 against 60 approximate.
  for (const std::size_t size : {15U, 60U}) {
    std::mt19937 random(11);
    int rejected = 0;
    constexpr int rounds = 400;
    for (int round = 0; round < rounds; ++round) {
      Values a;
      Values b;
      for (std::size_t i = 0; i < size; ++i) {
        a.push_back(static_cast<double>(random()));
        b.push_back(static_cast<double>(random()));
      }
      rejected += rank_sum_test(a, b) < 0.05 ? 1 : 0;
    }
    EXPECT_GT(rejected, rounds / 50);
    EXPECT_LT(rejected, rounds / 11);
  }
}

TEST(RankSumTest, ShowsNothingWithoutValuesOrDifferences) {
  EXPECT_EQ(rank_sum_test({}, Values{1.0}), 1.0);
  EXPECT_EQ(rank_sum_test(Values(20, 3.0), Values(30, 3.0)), 1.0);
  EXPECT_EQ(rank_sum_test(Values(200, 3.0), Values(30, 3.0)), 1.0);
}

TEST(ShareAbove, CountsPairsAndHalvesEqualOnes) {
  EXPECT_DOUBLE_EQ(share_above(Values{2, 3}, Values{1, 2, 4}), 3.5 / 6.0);
  EXPECT_TRUE(std::isnan(share_above({}, Values{1.0})));
}

TEST(CorrectForSeveral, IsHolms) {
  const Values corrected = correct_for_several(Values{0.04, 0.01, 0.03, 0.9});
  EXPECT_DOUBLE_EQ(corrected[1], 0.04);
  EXPECT_DOUBLE_EQ(corrected[2], 0.09);
  EXPECT_DOUBLE_EQ(corrected[0], 0.09) << "not below that of a smaller p-value";
  EXPECT_DOUBLE_EQ(corrected[3], 0.9);
}

}  // namespace
}  // namespace proleg::optimize
