#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "made_up.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

TEST(GaitMapFigure, HasAMarkForEachFilledCellAndCountsThem) {
  const Experiment experiment = map_experiment(2, 10);
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 30; ++i) {
    const auto cell = static_cast<double>(i % 6);
    evaluations.push_back(evaluation_at(i, {1.0 + static_cast<double>(i), 0.05 + 0.1 * cell, 0.55}));
  }
  Picture picture(draw_gait_map(experiment, evaluations));
  EXPECT_EQ(picture.marks("map"), 6U);
  for (const char* text : {"6 of 100 cells filled (6.0 %), QD score 165, 30 evaluations", "height (m)", "duty_factor",
                           "distance (m)", "filled cells (%)", "QD score"}) {
    EXPECT_TRUE(picture.has_text(text)) << text;
  }
}

TEST(GaitMapFigure, RepeatsThePlotForTheThirdAndTheFourthAxis) {
  const Experiment experiment = map_experiment(4, 3);
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 81; ++i) {
    const auto third = [&](std::uint64_t divisor) { return (static_cast<double>(i / divisor % 3) + 0.5) / 3.0; };
    evaluations.push_back(evaluation_at(i, {1.0, third(1), third(3), third(9), third(27)}));
  }
  Picture picture(draw_gait_map(experiment, evaluations));
  EXPECT_EQ(picture.marks("map"), 81U);
  EXPECT_TRUE(picture.has_text("height (m); columns: slip from 0 to 1"));
  EXPECT_TRUE(picture.has_text("duty_factor; rows: wave_count from 0 to 1"));
}

/// What is drawn as the cells of the map.
std::string map_group(const std::string& svg) {
  const std::size_t start = svg.find("class=\"map\"");
  return start == std::string::npos ? "" : svg.substr(start, svg.find("</g>", start) - start);
}

TEST(GaitMapFigure, HasARegionForEachFilledCellAroundACentroid) {
  Experiment experiment = map_experiment(2, 0);
  experiment.method = MapElitesSettings{.centroids = 12};
  const GaitMap map(experiment);
  std::vector<Evaluation> evaluations;
  for (std::size_t cell = 0; cell < 9; ++cell) {
    const std::vector<double> middle = map.middle(cell);
    evaluations.push_back(evaluation_at(cell, {1.0 + static_cast<double>(cell), middle[0], middle[1]}));
  }
  const std::string svg = draw_gait_map(experiment, evaluations);
  Picture picture(svg);
  const std::string regions = map_group(svg);
  std::size_t count = 0;
  for (std::size_t at = regions.find("<polygon"); at != std::string::npos; at = regions.find("<polygon", at + 1)) {
    ++count;
  }
  EXPECT_EQ(count, 9U);
  EXPECT_TRUE(picture.has_text("9 of 12 cells filled (75.0 %), QD score 45, 9 evaluations"));
}

TEST(GaitMapFigure, HasADotForEachFilledCellAroundACentroidOfFourAxesTheBestInFront) {
  Experiment experiment = map_experiment(4, 0);
  experiment.method = MapElitesSettings{.centroids = 40};
  const GaitMap map(experiment);
  std::vector<Evaluation> evaluations;
  for (std::size_t cell = 0; cell < 30; ++cell) {
    std::vector<double> scores = map.middle(cell);
    scores.insert(scores.begin(), 30.0 - static_cast<double>(cell));
    evaluations.push_back(evaluation_at(cell, scores));
  }
  const std::string svg = draw_gait_map(experiment, evaluations);
  Picture picture(svg);
  EXPECT_TRUE(picture.has_text("height (m); seen along: slip from 0 to 1"));
  const std::string dots = map_group(svg);
  std::vector<unsigned long> brightness;
  constexpr std::string_view fill = "fill=\"#";
  for (std::size_t at = dots.find(fill); at != std::string::npos; at = dots.find(fill, at + 1)) {
    const unsigned long colour = std::stoul(dots.substr(at + fill.size(), 6), nullptr, 16);
    brightness.push_back((colour >> 16U) + (colour >> 8U & 0xFFU) + (colour & 0xFFU));
  }
  EXPECT_EQ(brightness.size(), 30U);
  EXPECT_TRUE(std::ranges::is_sorted(brightness));
  EXPECT_LT(brightness.front(), brightness.back());
}

TEST(GaitMapFigure, IsDrawnWhateverTheEvaluationsAndStaysSmall) {
  for (const std::size_t axes : {std::size_t{2}, std::size_t{3}}) {
    const Experiment experiment = map_experiment(axes, 4);
    const std::vector<double> places(axes, 0.5);
    const auto with = [&](double score) {
      std::vector<double> scores{score};
      scores.insert(scores.end(), places.begin(), places.end());
      return scores;
    };
    for (const std::vector<Evaluation>& evaluations :
         std::vector<std::vector<Evaluation>>{{},
                                              {evaluation_at(0, with(0.0))},
                                              {evaluation_at(0, with(1.0))},
                                              {evaluation_at(0, with(1e308)), evaluation_at(1, with(-1e308))}}) {
      EXPECT_TRUE(Picture(draw_gait_map(experiment, evaluations)).has_text("QD score"));
    }
  }
  const Experiment large = map_experiment(2, 223);
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 223U * 223U; ++i) {
    evaluations.push_back(
        evaluation_at(i, {1.0 + static_cast<double>(i % 97), (static_cast<double>(i % 223) + 0.5) / 223.0,
                          (static_cast<double>(i / 223) + 0.5) / 223.0}));
  }
  EXPECT_LT(draw_gait_map(large, evaluations).size(), 1'500'000U);
}

TEST(GaitMapFigure, ShowsTheNumbersOfTrialsOnTheirCells) {
  const Experiment experiment = map_experiment(2, 10);
  const std::vector<GaitMap::Elite> cells{{7, 0, -1.5}, {42, 1, 3.25}, {99, 2, 0.5}};
  const std::vector<std::size_t> tried{42, 99, 42};
  Picture picture(draw_map_with_trials(experiment, cells, tried, 1, "after 3 trials"));
  EXPECT_EQ(picture.marks("map"), 3U);
  for (const char* text : {"after 3 trials", "1,3", "2", "expected distance (m)"}) {
    EXPECT_TRUE(picture.has_text(text)) << text;
  }
  Picture without(draw_map_with_trials(experiment, cells, {}, 0, "before the first trial"));
  EXPECT_EQ(without.marks("map"), 3U);
}

TEST(GaitMapTable, HasALineForEachFilledCellInTheirOrder) {
  const Experiment experiment = map_experiment(2, 10);
  const std::vector<Evaluation> evaluations{evaluation_at(0, {1.0, 0.95, 0.05}), evaluation_at(1, {2.0, 0.05, 0.05}),
                                            evaluation_at(2, {3.0, 0.95, 0.01}), evaluation_at(3, {0.0, 0.5, 0.5})};
  std::istringstream table(gait_map_table(experiment, evaluations));
  std::vector<std::string> lines;
  for (std::string line; std::getline(table, line);) {
    lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].rfind("cell:height\tcell:duty_factor\trun\tevaluation\tamplitude:J5 (deg)\t", 0), 0U) << lines[0];
  EXPECT_EQ(lines[1].rfind("1\t1\t0\t1\t", 0), 0U) << lines[1];
  EXPECT_EQ(lines[2].rfind("10\t1\t0\t2\t", 0), 0U) << lines[2];
}

}  // namespace
}  // namespace proleg::optimize
