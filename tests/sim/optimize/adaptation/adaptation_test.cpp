#include "sim/optimize/adaptation/adaptation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <vector>

namespace proleg::optimize {
namespace {

/// A map of 20 by 20 cells. value: what the map expects at a place.
std::vector<AdaptationCell> map_of(const std::function<double(double, double)>& value) {
  std::vector<AdaptationCell> cells;
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      const double u = (x + 0.5) / 20.0;
      const double v = (y + 0.5) / 20.0;
      cells.push_back({{u, v}, value(u, v)});
    }
  }
  return cells;
}

double hill(double u, double v, double u0, double v0, double height) {
  return height * std::exp(-((u - u0) * (u - u0) + (v - v0) * (v - v0)) / 0.02);
}

/// Makes trials until they end; true_value: what the robot does at a place.
void run(Adaptation& adaptation, const std::vector<AdaptationCell>& cells,
         const std::function<double(double, double)>& true_value) {
  while (const std::optional<std::size_t> cell = adaptation.next()) {
    adaptation.tell(*cell, true_value(cells[*cell].point[0], cells[*cell].point[1]));
  }
}

TEST(Adaptation, TriesTheBestOfTheMapFirstAndIsDoneIfItIsAsExpected) {
  const auto value = [](double u, double v) { return hill(u, v, 0.3, 0.7, 2.0); };
  const std::vector<AdaptationCell> cells = map_of(value);
  Adaptation adaptation(cells, {});
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::none);
  EXPECT_EQ(adaptation.best(), nullptr);
  const std::size_t first = *adaptation.next();
  EXPECT_NEAR(cells[first].point[0], 0.3, 0.026);
  EXPECT_NEAR(cells[first].point[1], 0.7, 0.026);
  adaptation.tell(first, cells[first].prior);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::good_enough);
  EXPECT_EQ(adaptation.next(), std::nullopt);
  EXPECT_EQ(adaptation.best()->value, cells[first].prior);
  EXPECT_EQ(adaptation.best()->expected.mean, cells[first].prior) << "of the time before the trial";
}

TEST(Adaptation, FindsTheHillThatIsLeftWhenTheHighestIsDamaged) {
  const auto map = [](double u, double v) { return hill(u, v, 0.2, 0.2, 1.0) + hill(u, v, 0.8, 0.8, 0.8); };
  const auto robot = [](double u, double v) { return hill(u, v, 0.8, 0.8, 0.8); };  // nothing works around 0.2, 0.2
  const std::vector<AdaptationCell> cells = map_of(map);
  Adaptation adaptation(cells, {.length = 0.3});
  run(adaptation, cells, robot);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::good_enough);
  EXPECT_LE(adaptation.trials().size(), 6U);
  EXPECT_GE(adaptation.best()->value, 0.9 * 0.8 * 0.94) << "the middle of the best cell has 0.94 of the hill";
  EXPECT_NEAR(cells[adaptation.best()->cell].point[0], 0.8, 0.1);
}

TEST(Adaptation, LearnsNothingOfCellsThatAreFarAway) {
  const std::vector<AdaptationCell> cells{{{0.0, 0.0}, 1.0}, {{0.05, 0.0}, 1.0}, {{1.0, 1.0}, 0.7}};
  Adaptation adaptation(cells, {.length = 0.1});
  adaptation.tell(0, 0.0);
  EXPECT_LT(adaptation.expected()[1].mean, 0.4) << "the neighbour of a gait that fails";
  EXPECT_NEAR(adaptation.expected()[2].mean, 0.7, 1e-6);
  EXPECT_EQ(*adaptation.next(), 2U);
}

TEST(Adaptation, StopsAtAlphaTimesTheBestThatIsExpected) {
  const std::vector<AdaptationCell> cells{{{0.0}, 1.0}, {{100.0}, 0.8}};  // too far apart to learn of each other
  for (const auto& [value, ending] : {std::pair{0.7201, AdaptationEnding::good_enough},  // 0.9 of 0.8
                                      std::pair{0.7199, AdaptationEnding::none}}) {
    Adaptation adaptation(cells, {.noise = 0.0});
    adaptation.tell(0, value);
    EXPECT_EQ(adaptation.ending(), ending) << value;
  }
  Adaptation strict(cells, {.alpha = 1.0, .noise = 0.0});
  strict.tell(0, 0.79);
  EXPECT_EQ(strict.ending(), AdaptationEnding::none);
  Adaptation lax(cells, {.alpha = 0.5, .noise = 0.0});
  lax.tell(0, 0.41);
  EXPECT_EQ(lax.ending(), AdaptationEnding::good_enough);
}

TEST(Adaptation, HasTheSameRuleForValuesBelowZero) {
  const std::vector<AdaptationCell> cells{{{0.0}, -1.0}, {{100.0}, -1.0}};  // costs
  for (const auto& [value, ending] :
       {std::pair{-1.09, AdaptationEnding::good_enough}, std::pair{-1.11, AdaptationEnding::none}}) {
    Adaptation adaptation(cells, {.noise = 0.0});
    adaptation.tell(0, value);
    EXPECT_EQ(adaptation.ending(), ending) << value;
  }
}

TEST(Adaptation, EndsWithTheLargestNumberOfTrials) {
  const std::vector<AdaptationCell> cells = map_of([](double u, double) { return 1.0 + u; });
  Adaptation adaptation(cells, {.length = 0.05, .trials = 7});
  run(adaptation, cells, [](double, double) { return 0.0; });
  EXPECT_EQ(adaptation.trials().size(), 7U);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::trials_used_up);
  std::set<std::size_t> tried;
  for (const Adaptation::Trial& trial : adaptation.trials()) {
    EXPECT_TRUE(tried.insert(trial.cell).second) << "a cell that has failed is not tried again";
  }
}

TEST(Adaptation, PrefersWhatIsUncertainTheMoreTheGreaterKappaIs) {
  const std::vector<AdaptationCell> cells{{{0.0}, 1.0}, {{0.02}, 1.0}, {{100.0}, 0.6}};
  for (const auto& [kappa, next] : {std::pair{0.0, std::size_t{1}}, std::pair{1.0, std::size_t{2}}}) {
    Adaptation adaptation(cells, {.alpha = 1.0, .kappa = kappa});
    adaptation.tell(0, 0.7);  // its neighbour is now expected to have a little more than that
    EXPECT_EQ(*adaptation.next(), next) << kappa;
  }
}

TEST(Adaptation, ForgetsNoScaleBecauseOfARunThatFailed) {
  // A run that fails has a score of its own for each measure, such as 10^6 for a cost.
  const std::vector<AdaptationCell> cells = map_of([](double u, double v) { return -2.0 + u * v; });
  Adaptation adaptation(cells, {.length = 0.3});
  const std::size_t first = *adaptation.next();
  adaptation.tell(first, -1e6);
  EXPECT_EQ(adaptation.trials().front().value, -1e6);
  for (const Estimate& estimate : adaptation.expected()) {
    EXPECT_GT(estimate.mean, -6.0);
  }
}

TEST(Adaptation, IsTheSameForTheSameNumbers) {
  const auto map = [](double u, double v) { return std::sin(5.0 * u) + std::cos(7.0 * v); };
  const auto robot = [](double u, double v) { return std::sin(5.0 * u) * std::cos(3.0 * v); };
  const std::vector<AdaptationCell> cells = map_of(map);
  Adaptation one(cells, {.alpha = 1.0});
  Adaptation other(cells, {.alpha = 1.0});
  run(one, cells, robot);
  for (const Adaptation::Trial& trial : one.trials()) {  // what was told is enough to continue
    EXPECT_EQ(other.next(), trial.cell);
    other.tell(trial.cell, trial.value);
  }
  EXPECT_EQ(one.ending(), other.ending());
}

TEST(Adaptation, CanHaveOneCellAndAMapOfZeros) {
  Adaptation adaptation({{{0.5}, 0.0}}, {});
  EXPECT_EQ(adaptation.next(), 0U);
  adaptation.tell(0, 0.0);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::good_enough);
}

}  // namespace
}  // namespace proleg::optimize
