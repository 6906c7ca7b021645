#include "tools/proleg/search/optimisation.hpp"

#include <gtest/gtest.h>

namespace proleg::tools {
namespace {

using std::chrono::milliseconds;

TEST(LogInterval, IsDueOnceInEachInterval) {
  const LogInterval::Time start{};
  LogInterval interval(start, milliseconds(10'000));
  EXPECT_FALSE(interval.is_due(start));
  EXPECT_FALSE(interval.is_due(start + milliseconds(9'999)));
  EXPECT_TRUE(interval.is_due(start + milliseconds(10'000)));
  EXPECT_FALSE(interval.is_due(start + milliseconds(10'000)));
  EXPECT_FALSE(interval.is_due(start + milliseconds(19'999)));
  EXPECT_TRUE(interval.is_due(start + milliseconds(35'000)));
  EXPECT_FALSE(interval.is_due(start + milliseconds(44'999))) << "no line is made up for";
  EXPECT_TRUE(interval.is_due(start + milliseconds(45'000)));
}

optimize::SearchProgress progress_of(std::uint64_t evaluations, std::uint64_t restored) {
  optimize::SearchProgress progress;
  progress.evaluations = evaluations;
  progress.restored = restored;
  progress.simulated_s = 3000.0;
  progress.score_sum = 50.0;
  return progress;
}

TEST(ProgressText, HasEvaluationsScoresSpeedAndRemainingTime) {
  optimize::SearchProgress progress = progress_of(100, 50);
  progress.best.emplace().scores = {1.25};
  EXPECT_EQ(progress_text("cmaes", "m", 400, progress, 20.0),
            "cmaes: 100 of 400, best 1.25 m, mean 0.5, 150 x real time, 2 min 0 s left");
  EXPECT_EQ(progress_text("cmaes", "", 0, progress, 20.0), "cmaes: 100, best 1.25, mean 0.5, 150 x real time");
}

TEST(ProgressText, OfASearchWithoutAScoreSaysSo) {
  EXPECT_EQ(progress_text("cmaes", "m", 0, progress_of(100, 0), 20.0), "cmaes: 100, all failed, 150 x real time");
}

TEST(ProgressText, OfASearchForAMapSaysHowMuchIsFilled) {
  optimize::Experiment experiment;
  experiment.objectives = {{"distance", {optimize::Term{}}}, {"x", {optimize::Term{}}}, {"y", {optimize::Term{}}}};
  experiment.axes = {{sim::Measure::height, 0.0, 1.0, 4}, {sim::Measure::slip, 0.0, 1.0, 2}};
  optimize::GaitMap map(experiment);
  map.add(0, std::vector{1.25, 0.5, 0.5});
  optimize::SearchProgress progress = progress_of(100, 100);
  progress.best.emplace().scores = {1.25, 0.5, 0.5};
  EXPECT_EQ(progress_text("map-elites", "m", 0, progress, 20.0, &map),
            "map-elites: 100, best 1.25 m, mean 0.5, 12.5 % filled, QD score 1.25, 150 x real time");
}

}  // namespace
}  // namespace proleg::tools
