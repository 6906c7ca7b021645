#include <limits>
#include <random>

#include "made_up.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<Evaluation> climbing(std::size_t count) {
  std::mt19937 random(1);
  std::vector<Evaluation> evaluations;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    evaluations.push_back(evaluation_of(i, 2.0 * share - 0.5 * static_cast<double>(random() % 1000) / 1000.0));
  }
  return evaluations;
}

TEST(LearningCurve, NamesWhatItShows) {
  const std::vector<Evaluation> evaluations{evaluation_of(0, 0.25), evaluation_of(1, 1.5), evaluation_of(2, 0.75)};
  Picture picture(draw_learning_curve(distance_experiment(), evaluations));
  for (const char* text : {"made_up", "great-deluge", "3 evaluations", "best 1.5 m after 2 evaluations", "distance (m)",
                           "evaluations", "best so far", "mean of"}) {
    EXPECT_TRUE(picture.has_text(text)) << text;
  }
  EXPECT_FALSE(picture.has_text("failed"));
  EXPECT_FALSE(picture.has_text("given up"));
  EXPECT_EQ(picture.marks("evaluations"), 3U);
  EXPECT_EQ(picture.lines("best"), 1U);
}

TEST(LearningCurve, HasTheBaselineAsALevel) {
  Experiment experiment = distance_experiment();
  std::vector<Evaluation> evaluations{evaluation_of(0, 1.25), evaluation_of(1, 1.5), evaluation_of(2, 0.75)};
  EXPECT_FALSE(Picture(draw_learning_curve(experiment, evaluations)).has_text("baseline"));
  experiment.has_baseline = true;
  Picture picture(draw_learning_curve(experiment, evaluations));
  EXPECT_TRUE(picture.has_text("baseline 1.25"));
  EXPECT_EQ(picture.lines("baseline"), 1U);
  evaluations[0] = failed_evaluation(0, 0.0);
  EXPECT_FALSE(Picture(draw_learning_curve(experiment, evaluations)).has_text("baseline"));
}

TEST(LearningCurve, DoesNotTakeAnExtrapolatedScoreAsTheBest) {
  std::vector<Evaluation> evaluations{evaluation_of(0, 1.25), evaluation_of(1, 1.5)};
  evaluations[1].given_up = true;
  EXPECT_TRUE(
      Picture(draw_learning_curve(distance_experiment(), evaluations)).has_text("best 1.25 m after 1 evaluation"));
}

TEST(LearningCurve, TheBestOfAnObjectiveToMinimiseIsTheLowest) {
  const Experiment experiment = experiment_of({objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<Evaluation> evaluations;
  for (const double cost : {9.0, 4.5, 7.0}) {
    evaluations.push_back(evaluation_of(evaluations.size(), cost));
    evaluations.back().measures[sim::Measure::cost_of_transport] = cost;
  }
  EXPECT_TRUE(Picture(draw_learning_curve(experiment, evaluations)).has_text("best 4.5 m/s^2 after 2 evaluations"));
}

TEST(LearningCurve, MarksTheRestartsOfTheSearch) {
  std::vector<Evaluation> evaluations = climbing(40);
  EXPECT_FALSE(Picture(draw_learning_curve(distance_experiment(), evaluations)).has_text("restart"));
  evaluations[12].after_restart = true;
  evaluations[30].after_restart = true;
  Picture picture(draw_learning_curve(distance_experiment(), evaluations));
  EXPECT_EQ(picture.lines("restarts"), 2U);
  EXPECT_TRUE(picture.has_text("restart"));
  EXPECT_TRUE(picture.has_text("2 restarts"));
}

TEST(LearningCurve, MarksWhatWasGivenUpAndWhatFailed) {
  std::vector<Evaluation> evaluations = climbing(40);
  evaluations[3].given_up = true;
  evaluations[5].given_up = true;
  evaluations[30] = failed_evaluation(30, 0.0);
  Picture picture(draw_learning_curve(distance_experiment(), evaluations));
  EXPECT_EQ(picture.marks("evaluations"), 37U);
  EXPECT_EQ(picture.marks("given up"), 2U);
  EXPECT_EQ(picture.marks("failed"), 1U);
  EXPECT_TRUE(picture.has_text("1 failed"));
}

TEST(LearningCurve, IsScaledForMostScoresIfFewAreFarOff) {
  const Experiment experiment = experiment_of({objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double cost = i % 50 == 20 ? 1e8 : 5.0 + static_cast<double>(i % 10);
    evaluations.push_back(evaluation_of(i, cost));
    evaluations.back().measures[sim::Measure::cost_of_transport] = cost;
  }
  Picture picture(draw_learning_curve(experiment, evaluations));
  EXPECT_TRUE(picture.has_text("4 outside the axis"));
  EXPECT_TRUE(picture.has_text("10"));
  EXPECT_FALSE(picture.has_text("00000"));
}

TEST(LearningCurve, IsDrawnWhateverTheEvaluations) {
  const Experiment experiment = distance_experiment();
  std::vector<std::vector<Evaluation>> cases{{}, {evaluation_of(0, 1.0)}, {failed_evaluation(0, 0.0)}};
  cases.emplace_back(50, evaluation_of(0, 0.0));
  cases.emplace_back(50, evaluation_of(0, -1e-300));
  cases.emplace_back(50, failed_evaluation(0, 0.0));
  cases.push_back({evaluation_of(0, nan), evaluation_of(1, 1.0), evaluation_of(2, nan)});
  cases.push_back({evaluation_of(0, 1.7e308), evaluation_of(1, -1.7e308), evaluation_of(2, 1.0)});
  cases.push_back({evaluation_of(0, std::numeric_limits<double>::infinity())});
  for (const std::vector<Evaluation>& evaluations : cases) {
    const Picture picture(draw_learning_curve(experiment, evaluations));
    EXPECT_TRUE(picture.has_text("made_up"));
  }
}

TEST(LearningCurve, IsWellFormedWhateverTheNames) {
  Experiment experiment = distance_experiment();
  experiment.path = "a/<&\">\x01\xff.optimise.xml";
  experiment.objectives.front().name = "]]><b a='";
  experiment.method.emplace<PagmoSettings>().algorithm = "<cmaes>";
  EXPECT_TRUE(Picture(draw_learning_curve(experiment, climbing(20))).has_text("]]><b a='"));
}

TEST(LearningCurve, DoesNotGrowWithTheNumberOfEvaluations) {
  std::vector<Evaluation> evaluations = climbing(100'000);
  for (std::size_t i = 0; i < evaluations.size(); i += 3) {
    evaluations[i].given_up = true;
  }
  EXPECT_LT(draw_learning_curve(distance_experiment(), evaluations).size(), 1'000'000U);
}

}  // namespace
}  // namespace proleg::optimize
