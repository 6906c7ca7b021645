#include "sim/optimize/method/pagmo_algorithms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "fake_source.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

std::size_t objectives_for(const PagmoAlgorithm& algorithm) {
  return algorithm.declaration().objectives == ObjectiveCount::several ? 2 : 1;
}

Experiment experiment_for(const PagmoAlgorithm& algorithm, const std::vector<std::uint32_t>& sizes,
                          std::uint32_t population, std::uint32_t generations, std::size_t objectives) {
  PagmoSettings settings;
  settings.algorithm = std::string(algorithm.name);
  settings.population = population;
  settings.generations = generations;
  return make_experiment(sizes, settings, Goal::minimise, objectives);
}

/// The squared distances from as many places as there are objectives.
FakeSource::Function spheres(std::size_t objectives) {
  return [objectives](const Candidate& candidate) {
    std::vector<double> scores;
    for (std::size_t i = 0; i < objectives; ++i) {
      scores.push_back(sphere(candidate, 9.0 + 12.0 * static_cast<double>(i)));
    }
    return scores;
  };
}

class EachAlgorithm : public testing::TestWithParam<std::size_t> {
 protected:
  const PagmoAlgorithm& algorithm = pagmo_algorithms()[GetParam()];
};

INSTANTIATE_TEST_SUITE_P(Pagmo, EachAlgorithm, testing::Range<std::size_t>(0, pagmo_algorithms().size()),
                         [](const auto& each) { return std::string(pagmo_algorithms()[each.param].name); });

TEST_P(EachAlgorithm, RunsWithEveryPopulationThatIsNotRejected) {
  const std::size_t objectives = objectives_for(algorithm);
  for (std::uint32_t population = 0; population <= 24; ++population) {
    const Experiment experiment = experiment_for(algorithm, {31, 2, 161}, population, 2, objectives);
    FakeSource source(spheres(objectives), 8);
    if (population < algorithm.declaration().min_population ||
        population % algorithm.declaration().population_multiple != 0) {
      EXPECT_THROW(check_method(experiment), InputError) << population;
      continue;
    }
    ASSERT_NO_THROW(static_cast<void>(search(experiment, 0, source))) << population;
    EXPECT_GE(source.asked.size(), population);
  }
}

TEST_P(EachAlgorithm, StaysInsideSpacesOfOneParameterAndOfMany) {
  const std::size_t objectives = objectives_for(algorithm);
  const std::vector<std::vector<std::uint32_t>> spaces = {
      {2}, {1, 161, 1}, std::vector<std::uint32_t>(20, 3), {5, 5000}};
  for (const auto& sizes : spaces) {
    const Experiment experiment = experiment_for(algorithm, sizes, 24, 5, objectives);
    FakeSource source(spheres(objectives), 8);
    ASSERT_NO_THROW(static_cast<void>(search(experiment, 3, source)));
    for (const Candidate& candidate : source.asked) {
      ASSERT_EQ(candidate.size(), sizes.size());
      for (std::size_t i = 0; i < sizes.size(); ++i) {
        ASSERT_LT(candidate[i], sizes[i]);
      }
    }
  }
}

TEST_P(EachAlgorithm, SearchesForThreeObjectivesOrRejectsThemBeforeItEvaluates) {
  FakeSource source(spheres(3), 8);
  const Experiment experiment = experiment_for(algorithm, {31, 31}, 20, 5, 3);
  if (algorithm.declaration().objectives == ObjectiveCount::one) {
    EXPECT_THROW(static_cast<void>(search(experiment, 0, source)), InputError);
    EXPECT_TRUE(source.asked.empty());
  } else {
    ASSERT_NO_THROW(static_cast<void>(search(experiment, 0, source)));
    EXPECT_GE(source.asked.size(), 100U);
  }
}

/// The sum of the scores of a candidate: less is better.
double cost(const Candidate& candidate, const FakeSource::Function& function) {
  const std::vector<double> scores = function(candidate);
  return std::accumulate(scores.begin(), scores.end(), 0.0);
}

TEST_P(EachAlgorithm, FindsBetterCandidatesThanAsManyRandomOnesAre) {
  const std::size_t objectives = objectives_for(algorithm);
  const FakeSource::Function function = spheres(objectives);
  std::mt19937 random(1);
  double found = 0.0;
  double by_chance = 0.0;
  for (std::uint32_t run = 0; run < 6; ++run) {
    FakeSource source(function, 8);
    static_cast<void>(search(experiment_for(algorithm, {161, 161, 161, 161, 161}, 20, 20, objectives), run, source));
    double best = cost(source.asked.front(), function);
    double random_best = best;
    for (const Candidate& candidate : source.asked) {
      best = std::min(best, cost(candidate, function));
      Candidate random_candidate;
      for (int i = 0; i < 5; ++i) {
        random_candidate.push_back(static_cast<std::uint32_t>(random() % 161));
      }
      random_best = std::min(random_best, cost(random_candidate, function));
    }
    found += best;
    by_chance += random_best;
  }
  EXPECT_LT(found, by_chance);
}

TEST(PagmoAlgorithms, ForSeveralObjectivesAreThoseThatTheMessageForTheOthersNames) {
  std::set<std::string_view> several;
  for (const PagmoAlgorithm& each : pagmo_algorithms()) {
    if (each.declaration().objectives != ObjectiveCount::one) {
      several.insert(each.name);
    }
  }
  EXPECT_EQ(several, (std::set<std::string_view>{"ihs", "maco", "moead", "nsga2", "nspso"}));
  try {
    check_method(experiment_for(*find_pagmo_algorithm("cmaes"), {31, 31}, 20, 5, 2));
    ADD_FAILURE() << "two objectives were not rejected";
  } catch (const InputError& error) {
    for (const std::string_view name : several) {
      EXPECT_NE(std::string_view(error.what()).find(name), std::string_view::npos) << name;
    }
  }
}

TEST_P(EachAlgorithm, RepeatsToTheBitWhateverIsPredicted) {
  const std::size_t objectives = objectives_for(algorithm);
  const Experiment experiment = experiment_for(algorithm, {41, 41, 161}, 16, 8, objectives);
  FakeSource first(spheres(objectives), 0);
  const std::string ending = search(experiment, 1, first);
  for (const std::size_t ahead : {1U, 4U, 100U}) {
    FakeSource other(spheres(objectives), ahead);
    EXPECT_EQ(search(experiment, 1, other), ending);
    EXPECT_EQ(other.asked, first.asked);
    EXPECT_EQ(other.needed, first.needed);
  }
  FakeSource other_run(spheres(objectives), 4);
  static_cast<void>(search(experiment, 2, other_run));
  EXPECT_NE(other_run.asked, first.asked);
}

TEST_P(EachAlgorithm, HasMostOfItsRequestsPredicted) {
  const std::size_t objectives = objectives_for(algorithm);
  const Experiment experiment = experiment_for(algorithm, {161, 161, 161, 161, 161}, 20, 20, objectives);
  FakeSource source(
      [objectives](const Candidate& candidate) {
        std::vector<double> scores(objectives, 3.0 - rugged(candidate));
        scores.back() += 0.01 * sphere(candidate, 70.0);
        return scores;
      },
      8);
  static_cast<void>(search(experiment, 0, source));
  const std::size_t asked = source.asked.size();
  const std::size_t wrong = source.count(FakeSource::Prediction::wrong);
  const std::size_t none = source.count(FakeSource::Prediction::none);
  RecordProperty("asked", static_cast<int>(asked));
  RecordProperty("wrong", static_cast<int>(wrong));
  RecordProperty("none", static_cast<int>(none));
  // These use a fitness before the end of a generation, or run over its end in one call.
  static const std::set<std::string_view> unpredictable = {
      "bee_colony", "compass_search", "gwo", "ihs", "moead", "pso", "pso_gen", "sea", "simulated_annealing"};
  if (!unpredictable.contains(algorithm.name)) {
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(none, 21U);  // the first of each generation, and of the population before
  }
  // While annealing is hot it accepts almost everything, and the prediction that nothing gets better is wrong.
  const std::size_t max_unpredicted = algorithm.name == "simulated_annealing" ? 2 * asked / 3 : asked / 3;
  EXPECT_LT(wrong + none, max_unpredicted);
}

TEST_P(EachAlgorithm, EndsWithItsSource) {
  const std::size_t objectives = objectives_for(algorithm);
  const Experiment experiment = experiment_for(algorithm, {41, 41}, 8, 4, objectives);
  for (const std::uint64_t budget : {0U, 1U, 7U, 8U, 9U, 13U, 16U, 17U}) {
    FakeSource source(spheres(objectives), 4, budget);
    EXPECT_THROW(static_cast<void>(search(experiment, 0, source)), SearchEnded);
    EXPECT_EQ(source.asked.size(), budget);
  }
}

}  // namespace
}  // namespace proleg::optimize
