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

/// Some gaits and what is expected of them.
struct Map {
  std::vector<std::vector<double>> points;
  std::vector<double> values;

  [[nodiscard]] Adaptation adaptation(const AdaptationSettings& settings) const {
    return {points, {{.values = values}}, settings};
  }
};

/// 20 by 20 gaits. value: what the map expects at a place.
Map map_of(const std::function<double(double, double)>& value) {
  Map map;
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      map.points.push_back({(x + 0.5) / 20.0, (y + 0.5) / 20.0});
      map.values.push_back(value(map.points.back()[0], map.points.back()[1]));
    }
  }
  return map;
}

double hill(double u, double v, double u0, double v0, double height) {
  return height * std::exp(-((u - u0) * (u - u0) + (v - v0) * (v - v0)) / 0.02);
}

/// Makes trials until they end; true_value: what the robot does at a place.
void run(Adaptation& adaptation, const Map& map, const std::function<double(double, double)>& true_value) {
  while (const std::optional<std::size_t> gait = adaptation.next()) {
    adaptation.tell(*gait, true_value(map.points[*gait][0], map.points[*gait][1]));
  }
}

TEST(Adaptation, TriesTheBestOfTheMapFirstAndIsDoneIfItIsAsExpected) {
  const Map map = map_of([](double u, double v) { return hill(u, v, 0.3, 0.7, 2.0); });
  Adaptation adaptation = map.adaptation({.kappa = 0.05});
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::none);
  EXPECT_EQ(adaptation.best(), nullptr);
  const std::size_t first = *adaptation.next();
  EXPECT_NEAR(map.points[first][0], 0.3, 0.026);
  EXPECT_NEAR(map.points[first][1], 0.7, 0.026);
  adaptation.tell(first, map.values[first]);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::good_enough);
  EXPECT_EQ(adaptation.next(), std::nullopt);
  EXPECT_EQ(adaptation.best()->value, map.values[first]);
  EXPECT_EQ(adaptation.best()->expected.mean, map.values[first]) << "of the time before the trial";
}

TEST(Adaptation, FindsTheHillThatIsLeftWhenTheHighestIsDamaged) {
  const Map map = map_of([](double u, double v) { return hill(u, v, 0.2, 0.2, 1.0) + hill(u, v, 0.8, 0.8, 0.8); });
  const auto robot = [](double u, double v) { return hill(u, v, 0.8, 0.8, 0.8); };  // nothing works around 0.2, 0.2
  Adaptation adaptation = map.adaptation({.kappa = 0.05, .length = 0.3});
  run(adaptation, map, robot);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::good_enough);
  EXPECT_LE(adaptation.trials().size(), 6U);
  EXPECT_GE(adaptation.best()->value, 0.9 * 0.8 * 0.94) << "the middle of the best cell has 0.94 of the hill";
  EXPECT_NEAR(map.points[adaptation.best()->gait][0], 0.8, 0.1);
}

TEST(Adaptation, MeasuresAllInSharesOfTheBestGaitAlsoIfValuesAreCosts) {
  for (const double sign : {1.0, -1.0}) {
    const Map map{{{0.0}, {100.0}}, {sign * 7.0, sign * 7.0 - 16.0}};
    const Adaptation adaptation = map.adaptation({});
    EXPECT_DOUBLE_EQ(adaptation.expected()[0].deviation, 7.0);
    EXPECT_DOUBLE_EQ(adaptation.expected()[1].deviation, 7.0);
  }
}

TEST(Adaptation, LearnsNothingOfGaitsThatAreFarAway) {
  const Map map{{{0.0, 0.0}, {0.05, 0.0}, {1.0, 1.0}}, {1.0, 1.0, 0.7}};
  Adaptation adaptation = map.adaptation({.kappa = 0.05, .length = 0.1});
  adaptation.tell(0, 0.0);
  EXPECT_LT(adaptation.expected()[1].mean, 0.4) << "the neighbour of a gait that fails";
  EXPECT_NEAR(adaptation.expected()[2].mean, 0.7, 1e-6);
  EXPECT_EQ(*adaptation.next(), 2U);
}

TEST(Adaptation, StopsAtAlphaTimesTheMostThatAnyGaitPromises) {
  const Map map{{{0.0}, {100.0}}, {1.0, 0.8}};  // too far apart to learn of each other
  for (const auto& [value, ending] : {std::pair{0.7201, AdaptationEnding::good_enough},  // 0.9 of 0.8
                                      std::pair{0.7199, AdaptationEnding::none}}) {
    Adaptation adaptation = map.adaptation({.kappa = 0.0, .noise = 0.0});
    adaptation.tell(0, value);
    EXPECT_EQ(adaptation.ending(), ending) << value;
  }
  Adaptation strict = map.adaptation({.alpha = 1.0, .kappa = 0.0, .noise = 0.0});
  strict.tell(0, 0.79);
  EXPECT_EQ(strict.ending(), AdaptationEnding::none);
  Adaptation lax = map.adaptation({.alpha = 0.5, .kappa = 0.0, .noise = 0.0});
  lax.tell(0, 0.41);
  EXPECT_EQ(lax.ending(), AdaptationEnding::good_enough);
  for (const auto& [value, ending] : {std::pair{0.9901, AdaptationEnding::good_enough},  // 0.9 of 0.8 + 0.3 * 1
                                      std::pair{0.9899, AdaptationEnding::none}}) {
    Adaptation hopeful = map.adaptation({.kappa = 0.3, .noise = 0.0});
    hopeful.tell(0, value);
    EXPECT_EQ(hopeful.ending(), ending) << "the other gait may be better than it is expected to be, " << value;
  }
}

TEST(Adaptation, HasTheSameRuleForValuesBelowZero) {
  const Map map{{{0.0}, {100.0}}, {-1.0, -1.0}};  // costs
  for (const auto& [value, ending] :
       {std::pair{-1.09, AdaptationEnding::good_enough}, std::pair{-1.11, AdaptationEnding::none}}) {
    Adaptation adaptation = map.adaptation({.kappa = 0.0, .noise = 0.0});
    adaptation.tell(0, value);
    EXPECT_EQ(adaptation.ending(), ending) << value;
  }
}

TEST(Adaptation, EndsWithTheLargestNumberOfTrials) {
  const Map map = map_of([](double u, double) { return 1.0 + u; });
  Adaptation adaptation = map.adaptation({.length = 0.05, .trials = 7});
  run(adaptation, map, [](double, double) { return 0.0; });
  EXPECT_EQ(adaptation.trials().size(), 7U);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::trials_used_up);
  std::set<std::size_t> tried;
  for (const Adaptation::Trial& trial : adaptation.trials()) {
    EXPECT_TRUE(tried.insert(trial.gait).second) << "a gait that has failed is not tried again";
  }
}

TEST(Adaptation, PrefersWhatIsUncertainTheMoreTheGreaterKappaIs) {
  const Map map{{{0.0}, {0.02}, {100.0}}, {1.0, 1.0, 0.6}};
  for (const auto& [kappa, next] : {std::pair{0.0, std::size_t{1}}, std::pair{1.0, std::size_t{2}}}) {
    Adaptation adaptation = map.adaptation({.alpha = 1.0, .kappa = kappa});
    adaptation.tell(0, 0.7);  // its neighbour is now expected to have a little more than that
    EXPECT_EQ(*adaptation.next(), next) << kappa;
  }
}

TEST(Adaptation, ForgetsNoScaleBecauseOfARunThatFailed) {
  // A run that fails has a score of its own for each measure, such as 10^6 for a cost.
  const Map map = map_of([](double u, double v) { return -2.0 + u * v; });
  Adaptation adaptation = map.adaptation({.length = 0.3});
  const std::size_t first = *adaptation.next();
  adaptation.tell(first, -1e6);
  EXPECT_EQ(adaptation.trials().front().value, -1e6);
  for (const Estimate& estimate : adaptation.expected()) {
    EXPECT_GT(estimate.mean, -6.0);
  }
}

TEST(Adaptation, IsTheSameForTheSameNumbers) {
  const Map map = map_of([](double u, double v) { return std::sin(5.0 * u) + std::cos(7.0 * v); });
  const auto robot = [](double u, double v) { return std::sin(5.0 * u) * std::cos(3.0 * v); };
  Adaptation one = map.adaptation({.alpha = 1.0});
  Adaptation other = map.adaptation({.alpha = 1.0});
  run(one, map, robot);
  for (const Adaptation::Trial& trial : one.trials()) {  // what was told is enough to continue
    EXPECT_EQ(other.next(), trial.gait);
    other.tell(trial.gait, trial.value);
  }
  EXPECT_EQ(one.ending(), other.ending());
}

TEST(Adaptation, CanHaveOneGaitAndAMapOfZeros) {
  Adaptation adaptation({{0.5}}, {{.values = {0.0}}}, {});
  EXPECT_EQ(adaptation.next(), 0U);
  adaptation.tell(0, 0.0);
  EXPECT_EQ(adaptation.ending(), AdaptationEnding::all_tried);
  EXPECT_EQ(adaptation.next(), std::nullopt);
}

TEST(AdaptationOfSeveralHypotheses, HasTheirProbabilitiesByBayes) {
  // One trial; each hypothesis has a normal distribution of its value with the variance deviation^2 + noise^2.
  Adaptation adaptation({{0.0}, {100.0}}, {{{1.0, 0.5}, 0.1, 0.5}, {{1.0, 0.5}, 0.3, 0.2}, {{0.2, 0.8}, 0.1, 0.3}},
                        {.noise = 0.05});
  EXPECT_NEAR(adaptation.probabilities()[0], 0.5, 1e-12);
  EXPECT_NEAR(adaptation.probabilities()[1], 0.2, 1e-12);
  adaptation.tell(0, 0.3);
  const auto density = [](double value, double mean, double variance) {
    return std::exp(-(value - mean) * (value - mean) / (2.0 * variance)) / std::sqrt(variance);
  };
  const double intact = 0.5 * density(0.3, 1.0, 0.01 + 0.0025);
  const double unknown = 0.2 * density(0.3, 1.0, 0.09 + 0.0025);
  const double damaged = 0.3 * density(0.3, 0.2, 0.01 + 0.0025);
  const double sum = intact + unknown + damaged;
  EXPECT_NEAR(adaptation.probabilities()[0], intact / sum, 1e-12);
  EXPECT_NEAR(adaptation.probabilities()[1], unknown / sum, 1e-12);
  EXPECT_NEAR(adaptation.probabilities()[2], damaged / sum, 1e-12);
}

TEST(AdaptationOfSeveralHypotheses, ExpectsMeanAndDeviationOfTheMixture) {
  const Adaptation adaptation({{0.0}}, {{{1.0}, 0.1, 3.0}, {{0.4}, 0.2, 1.0}}, {});
  EXPECT_NEAR(adaptation.expected()[0].mean, 0.75 * 1.0 + 0.25 * 0.4, 1e-12);
  const double of_square = 0.75 * (1.0 + 0.01) + 0.25 * (0.16 + 0.04);
  EXPECT_NEAR(adaptation.expected()[0].deviation, std::sqrt(of_square - 0.85 * 0.85), 1e-12);
}

TEST(AdaptationOfSeveralHypotheses, FindsInTwoTrialsTheGaitThatOnlyTheRightOneExpects) {
  // Around 0.2, 0.2 the intact robot is good; with the damage only a gait far from there is, which the intact robot
  // moves badly with.
  const Map intact = map_of([](double u, double v) { return hill(u, v, 0.2, 0.2, 1.0); });
  const auto robot = [](double u, double v) { return 0.05 + hill(u, v, 0.9, 0.1, 0.4); };
  const Map damaged = map_of(robot);
  const Map other_damage = map_of([](double u, double v) { return 0.3 + hill(u, v, 0.1, 0.9, 0.3); });
  Adaptation adaptation(intact.points,
                        {{intact.values, 0.1, 0.3},
                         {intact.values, 0.3, 0.1},
                         {other_damage.values, 0.1, 0.3},
                         {damaged.values, 0.1, 0.3}},
                        {});
  run(adaptation, intact, robot);
  EXPECT_LE(adaptation.trials().size(), 4U);
  EXPECT_GT(adaptation.best()->value, 0.4);
  EXPECT_GT(adaptation.probabilities()[3], 0.9);

  Adaptation alone = intact.adaptation({});
  run(alone, intact, robot);
  EXPECT_EQ(alone.trials().size(), 12U) << "without hypotheses it searches";
}

TEST(AdaptationOfSeveralHypotheses, IsNotMisledIfNoneIsTrue) {
  const Map intact = map_of([](double u, double v) { return hill(u, v, 0.2, 0.2, 1.0) + hill(u, v, 0.8, 0.8, 0.8); });
  const Map suspected = map_of([](double u, double v) { return hill(u, v, 0.2, 0.8, 0.9); });
  const auto robot = [](double u, double v) { return hill(u, v, 0.8, 0.8, 0.8); };
  Adaptation adaptation(intact.points,
                        {{intact.values, 0.1, 0.45}, {intact.values, 0.3, 0.1}, {suspected.values, 0.1, 0.45}}, {});
  run(adaptation, intact, robot);
  EXPECT_GE(adaptation.best()->value, 0.9 * 0.8 * 0.94);
  EXPECT_GT(adaptation.probabilities()[1], 0.5) << "the damage is unknown";
}

TEST(AdaptationOfSeveralHypotheses, StaysFiniteWhateverARunThatFailsHasAsItsScore) {
  Adaptation adaptation({{0.0}, {1.0}}, {{{1.0, 0.5}, 0.1, 1.0}, {{-1e6, -1e6}, 0.1, 1.0}}, {});
  adaptation.tell(0, -1e6);
  adaptation.tell(1, 0.5);
  for (const Estimate& estimate : adaptation.expected()) {
    EXPECT_TRUE(std::isfinite(estimate.mean));
    EXPECT_TRUE(std::isfinite(estimate.deviation));
  }
  EXPECT_NEAR(adaptation.probabilities()[0] + adaptation.probabilities()[1], 1.0, 1e-12);
}

}  // namespace
}  // namespace proleg::optimize
