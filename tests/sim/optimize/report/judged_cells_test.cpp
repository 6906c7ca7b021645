#include "sim/optimize/report/judged_cells.hpp"

#include <random>
#include <sstream>

#include "made_up.hpp"

namespace proleg::optimize {
namespace {

// The third is a textbook example, 1 - 6 * 194 / (10 * 99) = -29/165. In the fourth the ranks are 1, 2.5, 2.5, 4 and
// 1, 3, 2, 4; their correlation by Pearson's formula is 4.5 / sqrt(4.5 * 5).
TEST(RankCorrelation, IsThatOfTheDefinition) {
  EXPECT_DOUBLE_EQ(rank_correlation(std::vector{1.0, 2.0, 3.0, 4.0}, std::vector{10.0, 20.0, 25.0, 90.0}), 1.0);
  EXPECT_DOUBLE_EQ(rank_correlation(std::vector{1.0, 2.0, 3.0}, std::vector{3.0, 2.0, 1.0}), -1.0);
  EXPECT_NEAR(rank_correlation(std::vector{106.0, 100.0, 86.0, 101.0, 99.0, 103.0, 97.0, 113.0, 112.0, 110.0},
                               std::vector{7.0, 27.0, 2.0, 50.0, 28.0, 29.0, 20.0, 12.0, 6.0, 17.0}),
              -29.0 / 165.0, 1e-15);
  EXPECT_NEAR(rank_correlation(std::vector{1.0, 2.0, 2.0, 3.0}, std::vector{1.0, 3.0, 2.0, 4.0}), std::sqrt(0.9),
              1e-15);
}

TEST(RankCorrelation, OfEqualValuesOrOfTooFewIsNone) {
  EXPECT_TRUE(std::isnan(rank_correlation(std::vector{1.0, 1.0, 1.0}, std::vector{1.0, 2.0, 3.0})));
  EXPECT_TRUE(std::isnan(rank_correlation(std::vector{1.0}, std::vector{1.0})));
  EXPECT_TRUE(std::isnan(rank_correlation(std::vector<double>{}, std::vector<double>{})));
}

/// One evaluation in each of `count` cells of a row of 100.
std::vector<Evaluation> row_of_cells(std::size_t count) {
  std::vector<Evaluation> evaluations;
  for (std::size_t i = 0; i < count; ++i) {
    evaluations.push_back(evaluation_at(i, {1.0, (static_cast<double>(i) + 0.5) / 100.0, 0.0}));
  }
  return evaluations;
}

TEST(ChooseCells, DrawsOneOfEachPartOfTheMap) {
  Experiment experiment = map_experiment(2, 100);
  const std::vector<Evaluation> evaluations = row_of_cells(95);
  std::vector<int> drawn(95);
  for (experiment.seed = 0; experiment.seed < 2000; ++experiment.seed) {
    const std::vector<Evaluation> chosen = choose_cells(experiment, evaluations, 10);
    ASSERT_EQ(chosen.size(), 10U);
    for (std::size_t part = 0; part < chosen.size(); ++part) {
      EXPECT_GE(chosen[part].number, part * 95 / 10);
      EXPECT_LT(chosen[part].number, (part + 1) * 95 / 10);
      ++drawn[chosen[part].number];
    }
  }
  // About 2000 / 9.5 = 211 draws of each; five standard deviations of 14 are 70.
  EXPECT_GT(std::ranges::min(drawn), 140);
  EXPECT_LT(std::ranges::max(drawn), 290);
}

TEST(ChooseCells, DrawsTheSameForASeedAndAllOfASmallMap) {
  const Experiment experiment = map_experiment(2, 100);
  const auto numbers = [&](std::size_t cells, std::size_t count) {
    std::vector<std::uint64_t> found;
    for (const Evaluation& evaluation : choose_cells(experiment, row_of_cells(cells), count)) {
      found.push_back(evaluation.number);
    }
    return found;
  };
  EXPECT_EQ(numbers(50, 7), numbers(50, 7));
  EXPECT_EQ(numbers(3, 20), (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_TRUE(numbers(0, 20).empty());
  EXPECT_TRUE(numbers(20, 0).empty());
}

/// A cell of the sample: scores in the map, and in the judging engine.
Confirmation judged(std::uint64_t number, std::vector<double> in_map, std::vector<double> fresh) {
  Confirmation confirmation;
  confirmation.evaluation = evaluation_at(number, std::move(in_map));
  confirmation.fresh = evaluation_at(number, std::move(fresh));
  return confirmation;
}

std::vector<Confirmation> sample() {
  std::vector<Confirmation> sample{
      judged(3, {2.0, 0.05, 0.55}, {1.0, 0.05, 0.55}), judged(4, {4.0, 0.15, 0.55}, {3.0, 0.25, 0.45}),
      judged(5, {6.0, 0.25, 0.55}, {5.0, 0.55, 0.55}), judged(6, {5.0, 0.35, 0.55}, {0.0, 0.0, 0.0})};
  sample.back().fresh.failure = "the robot flew apart";
  sample.back().fresh.measures = {};
  return sample;
}

TEST(MapAgreement, ComparesScoresMeasuresAndCellsOfTheRunsThatSucceed) {
  const Experiment experiment = map_experiment(2, 10);
  const MapAgreement agreement = agreement_of(experiment, sample());
  EXPECT_EQ(agreement.cells, 4U);
  EXPECT_EQ(agreement.with_place, 3U);
  EXPECT_EQ(agreement.in_the_cell, 1U);
  EXPECT_EQ(agreement.near_it, 2U) << "a corner counts";
  ASSERT_EQ(agreement.objectives.size(), 3U);
  EXPECT_EQ(agreement.objectives[0].name, "distance");
  EXPECT_DOUBLE_EQ(agreement.score_ratio().value(), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(agreement.objectives[0].mean_difference, 1.0);
  EXPECT_DOUBLE_EQ(agreement.objectives[0].rank_correlation, 1.0);
  EXPECT_NEAR(agreement.objectives[1].mean_difference, 0.4 / 3.0, 1e-15);
  EXPECT_TRUE(std::isnan(agreement.objectives[2].rank_correlation)) << "all are equal in the map";
}

TEST(MapAgreement, OfNothingHasNoRatio) {
  const Experiment experiment = map_experiment(3, 10);
  const MapAgreement agreement = agreement_of(experiment, {});
  EXPECT_EQ(agreement.cells, 0U);
  EXPECT_FALSE(agreement.score_ratio());
  EXPECT_EQ(agreement.objectives.size(), 4U);
}

TEST(JudgedTable, HasTheCellInBothEnginesAndNoneOfARunThatFailed) {
  Experiment experiment = map_experiment(2, 10);
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  std::istringstream table(judged_table(experiment, sample()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(table, line);) {
    lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0].rfind("cell:height\tcell:duty_factor\tevaluation\tamplitude:J5 (deg)\t", 0), 0U) << lines[0];
  EXPECT_TRUE(
      lines[0].ends_with("distance (m) (reduced)\tdistance (m) (ode)\theight (m) (reduced)\theight (m) (ode)\t"
                         "duty_factor (reduced)\tduty_factor (ode)\tjudged:height\tjudged:duty_factor"))
      << lines[0];
  EXPECT_EQ(lines[2].rfind("2\t6\t4\t", 0), 0U) << lines[2];
  EXPECT_TRUE(lines[2].ends_with("\t4\t3\t0.15\t0.25\t0.55\t0.45\t3\t5")) << lines[2];
  EXPECT_TRUE(lines[4].ends_with("\t\t")) << lines[4];
}

}  // namespace
}  // namespace proleg::optimize
