#include "sim/optimize/evaluation/task.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

TrialResult trial(double distance, double energy) {
  TrialResult result;
  result.measures[sim::Measure::distance] = distance;
  result.measures[sim::Measure::mechanical_energy] = energy;
  result.wall_s = 2.0;
  result.simulated_s = 3.0;
  return result;
}

TrialResult failed(const std::string& why) {
  TrialResult result;
  result.failure = why;
  return result;
}

class Rating : public testing::Test {
 protected:
  Rating() {
    experiment_.objectives.push_back({"energy", {{sim::Measure::mechanical_energy, 1.0}}, Goal::minimise, 1e6});
  }
  [[nodiscard]] Evaluation rated(const std::vector<TrialResult>& trials) const {
    return rate(experiment_, 1, 2, {0, 0, 0}, trials);
  }
  Experiment experiment_ = small_experiment();
};

TEST_F(Rating, OfOneTrialIsThatTrial) {
  const Evaluation evaluation = rated({trial(0.1, 7.0)});
  EXPECT_EQ(evaluation.run, 1U);
  EXPECT_EQ(evaluation.number, 2U);
  EXPECT_EQ(evaluation.scores, (std::vector<double>{0.1, 7.0}));
  EXPECT_EQ(evaluation.measures[sim::Measure::distance], 0.1);
  EXPECT_TRUE(std::isnan(evaluation.measures[sim::Measure::slip]));
  EXPECT_EQ(evaluation.wall_s, 2.0);
  EXPECT_EQ(evaluation.simulated_s, 3.0);
}

TEST_F(Rating, TakesTheMean) {
  const Evaluation evaluation = rated({trial(1.0, 7.0), trial(2.0, 8.0), trial(6.0, 3.0)});
  EXPECT_EQ(evaluation.scores, (std::vector<double>{3.0, 6.0}));
  EXPECT_EQ(evaluation.wall_s, 6.0);
}

TEST_F(Rating, TakesTheWorstByTheGoalOfEachObjective) {
  experiment_.trials.aggregate = Aggregate::worst;
  EXPECT_EQ(rated({trial(2.0, 7.0), trial(1.0, 3.0), trial(6.0, 8.0)}).scores, (std::vector<double>{1.0, 8.0}));
}

TEST_F(Rating, CountsAFailedTrialInTheScoreAndNotInTheMeasures) {
  TrialResult given_up = trial(4.0, 4.0);
  given_up.given_up = true;
  const Evaluation evaluation = rated({failed("first"), trial(2.0, 2.0), failed("second"), given_up});
  EXPECT_EQ(evaluation.scores, (std::vector<double>{1.5, (2e6 + 6.0) / 4.0}));
  EXPECT_EQ(evaluation.measures[sim::Measure::distance], 3.0);
  EXPECT_EQ(evaluation.failure, "first");
  EXPECT_TRUE(evaluation.given_up);
}

TEST_F(Rating, OfFailuresOnlyHasNoMeasures) {
  const Evaluation evaluation = rated({failed("first"), failed("second")});
  EXPECT_EQ(evaluation.scores, (std::vector<double>{0.0, 1e6}));
  EXPECT_TRUE(std::isnan(evaluation.measures[sim::Measure::distance]));
}

TEST_F(Rating, HasItsOwnScoreIfNoTrialFailedAndTheRunDefinesTheMeasures) {
  EXPECT_TRUE(has_own_score(experiment_, rated({trial(1.0, 2.0)}), 0));
  EXPECT_FALSE(has_own_score(experiment_, rated({trial(1.0, 2.0), failed("it broke")}), 0));
  EXPECT_EQ(why_without_score(experiment_, rated({trial(1.0, 2.0), failed("it broke")})), "it broke");
  const Evaluation undefined = rated({trial(NAN, 2.0)});
  EXPECT_FALSE(has_own_score(experiment_, undefined, 0));
  EXPECT_TRUE(has_own_score(experiment_, undefined, 1));
  EXPECT_EQ(why_without_score(experiment_, undefined), "the run does not define distance");
}

TEST_F(Rating, IsBetterOnlyWithAScoreThatARunCanRepeat) {
  const Evaluation good = rated({trial(2.0, 1.0)});
  const Evaluation bad = rated({trial(1.0, 1.0)});
  EXPECT_TRUE(is_better(experiment_, good, &bad));
  EXPECT_FALSE(is_better(experiment_, bad, &good));
  EXPECT_FALSE(is_better(experiment_, good, &good));
  EXPECT_TRUE(is_better(experiment_, bad, nullptr));
  EXPECT_FALSE(is_better(experiment_, rated({failed("it broke")}), nullptr));
  TrialResult extrapolated = trial(9.0, 1.0);
  extrapolated.given_up = true;
  EXPECT_FALSE(is_better(experiment_, rated({extrapolated}), &bad));
}

TEST_F(Rating, TheBaselineIsTheFirstEvaluationOfAnExperimentThatHasOne) {
  const std::vector<Evaluation> evaluations{rated({trial(1.0, 2.0)})};
  EXPECT_EQ(baseline_of(experiment_, evaluations), nullptr);
  experiment_.has_baseline = true;
  EXPECT_EQ(baseline_of(experiment_, evaluations), evaluations.data());
  EXPECT_EQ(baseline_of(experiment_, {}), nullptr);
}

}  // namespace
}  // namespace proleg::optimize
