#include "sim/optimize/method/gait_problem.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "fake_source.hpp"

namespace proleg::optimize {
namespace {

struct GaitProblemOfFour : testing::Test {
  Experiment experiment = make_experiment({5, 1, 161, 2}, GreatDelugeSettings{});
  FakeSource source{[](const Candidate&) { return std::vector<double>{0.5}; }};
  GaitEvaluator evaluator{experiment.space, experiment.objectives, source};
};

TEST_F(GaitProblemOfFour, HasAVariableForEachDimensionWithAChoice) {
  const pagmo::problem problem{GaitProblem{evaluator}};
  EXPECT_EQ(problem.get_lb(), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(problem.get_ub(), (std::vector<double>{4, 160, 1}));
  EXPECT_EQ(problem.get_nobj(), 1U);
}

TEST_F(GaitProblemOfFour, RoundsToTheNearestCandidateAndKeepsInside) {
  EXPECT_EQ(evaluator.candidate({1.49, 80.5, 0.5}), (Candidate{1, 0, 81, 1}));
  EXPECT_EQ(evaluator.candidate({-3.0, 160.49, 1.7}), (Candidate{0, 0, 160, 1}));
  EXPECT_EQ(evaluator.candidate({1e300, 0.4, -0.0}), (Candidate{4, 0, 0, 0}));
  EXPECT_EQ(evaluator.candidate({std::numeric_limits<double>::quiet_NaN(), 3, 1}), (Candidate{0, 0, 3, 1}));
  EXPECT_EQ(evaluator.candidate(evaluator.numbers({2, 0, 77, 1})), (Candidate{2, 0, 77, 1}));
}

TEST_F(GaitProblemOfFour, HasCopiesThatAskTheSameSource) {
  const pagmo::problem problem{GaitProblem{evaluator}};
  const pagmo::population population(problem, 6U, 1U);
  pagmo::population copy(population);
  copy.push_back({1, 2, 1});
  EXPECT_EQ(source.asked.size(), 7U);
  EXPECT_EQ(source.asked.back(), (Candidate{1, 0, 2, 1}));
}

TEST(GaitProblem, MakesCostsOfScores) {
  Experiment experiment = make_experiment({5}, PagmoSettings{}, Goal::maximise, 2);
  experiment.objectives[1].goal = Goal::minimise;
  FakeSource source{[](const Candidate&) { return std::vector<double>{0.5, 7.0}; }};
  GaitEvaluator evaluator(experiment.space, experiment.objectives, source);
  const pagmo::problem problem{GaitProblem{evaluator}};
  EXPECT_EQ(problem.get_nobj(), 2U);
  EXPECT_EQ(problem.fitness({1.0}), (std::vector<double>{-0.5, 7.0}));
  EXPECT_EQ(evaluator.costs({-0.5, 7.0}), (std::vector<double>{0.5, 7.0}));
}

}  // namespace
}  // namespace proleg::optimize
