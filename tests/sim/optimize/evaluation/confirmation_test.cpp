#include "sim/optimize/evaluation/confirmation.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

Evaluation evaluation_of(std::uint64_t number, const Candidate& candidate, double score) {
  Evaluation evaluation;
  evaluation.number = number;
  evaluation.candidate = candidate;
  evaluation.scores = {score};
  evaluation.measures[sim::Measure::distance] = score;
  return evaluation;
}

std::vector<std::uint64_t> numbers(const std::vector<Evaluation>& evaluations) {
  std::vector<std::uint64_t> numbers;
  for (const Evaluation& evaluation : evaluations) {
    numbers.push_back(evaluation.number);
  }
  return numbers;
}

std::string exact(const std::vector<Confirmation>& confirmations) {
  std::string text;
  for (const Confirmation& confirmation : confirmations) {
    text += std::to_string(confirmation.evaluation.number) + ":";
    for (const double score : confirmation.scores) {
      text += " " + std::to_string(std::bit_cast<std::uint64_t>(score));
    }
    text += "\n";
  }
  return text;
}

TEST(NeedsConfirmation, OnlyAResultThatDependsOnRandomNumbers) {
  EXPECT_FALSE(needs_confirmation(small_experiment()));
  Experiment noisy = noisy_experiment();
  EXPECT_TRUE(needs_confirmation(noisy));
  noisy.confirmation.runs = 0;
  EXPECT_FALSE(needs_confirmation(noisy));
}

Experiment judged_experiment() {
  Experiment experiment = small_experiment();
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  return experiment;
}

TEST(NeedsConfirmation, AResultOfAnEngineThatIsNotTheJudgingOne) {
  Experiment experiment = judged_experiment();
  EXPECT_TRUE(needs_confirmation(experiment));
  EXPECT_EQ(fresh_runs(experiment).candidates, 10U);
  EXPECT_EQ(fresh_runs(experiment).runs, 1U) << "ten equal runs say no more";
  experiment.confirmation = {12, 0};
  EXPECT_EQ(fresh_runs(experiment).candidates, 12U);
  EXPECT_EQ(fresh_runs(experiment).runs, 1U);
  experiment.trials.spread.friction = 0.1;
  EXPECT_EQ(fresh_runs(experiment).runs, 1U) << "at least one";
  experiment.confirmation.runs = 7;
  EXPECT_EQ(fresh_runs(experiment).runs, 7U);
}

TEST(Finalists, AreTheBestDifferentCandidatesAndTheBaseline) {
  Experiment experiment = noisy_experiment();
  experiment.confirmation.candidates = 3;
  experiment.has_baseline = true;
  std::vector<Evaluation> evaluations{evaluation_of(0, {3, 1, 1}, 0.1), evaluation_of(1, {1, 1, 1}, 0.8),
                                      evaluation_of(2, {2, 1, 1}, 0.7), evaluation_of(3, {1, 1, 1}, 0.9),
                                      evaluation_of(4, {4, 1, 1}, 0.5), evaluation_of(5, {5, 1, 1}, 0.3),
                                      evaluation_of(6, {0, 1, 1}, 2.0), evaluation_of(7, {0, 2, 1}, 3.0)};
  evaluations[6].failure = "broke";
  evaluations[7].given_up = true;  // its score is extrapolated
  EXPECT_EQ(numbers(choose_finalists(experiment, evaluations)), (std::vector<std::uint64_t>{3, 2, 4, 0}));
  evaluations[0].scores = {1.0};
  EXPECT_EQ(numbers(choose_finalists(experiment, evaluations)), (std::vector<std::uint64_t>{0, 3, 2})) << "not twice";
  experiment.objectives.front().goal = Goal::minimise;
  EXPECT_EQ(numbers(choose_finalists(experiment, evaluations)), (std::vector<std::uint64_t>{5, 4, 2, 0}));
}

TEST(Confirm, RatesInFreshWorldsThatAreTheSameForAllFinalists) {
  for (const RandomNumbers random_numbers : {RandomNumbers::common, RandomNumbers::fresh}) {
    Experiment experiment = noisy_experiment(2);
    experiment.trials.random_numbers = random_numbers;
    experiment.confirmation.runs = 7;
    const std::vector<Evaluation> finalists{evaluation_of(5, {1, 2, 3}, 1.0), evaluation_of(9, {3, 2, 1}, 0.9)};
    MadeUpWorkers workers(experiment, 2, 1);
    static_cast<void>(confirm(experiment, finalists, workers, nullptr, {}));
    std::map<std::uint64_t, std::set<std::uint64_t>> seeds;  // by the number of the finalist
    for (const Task& task : workers.started()) {
      seeds[task.number].insert(seed_of(experiment, task));
    }
    ASSERT_EQ(seeds[5].size(), 7U);
    EXPECT_EQ(seeds[5], seeds[9]);
    for (std::uint32_t trial = 0; trial < 2; ++trial) {
      EXPECT_FALSE(seeds[5].contains(seed_of(experiment, {0, 5, trial, {1, 2, 3}, {}}))) << "a world of the search";
    }
  }
}

TEST(Confirm, RatesInTheJudgingEngineWhateverTheSearchHad) {
  const Experiment judged = judged_experiment();
  const Experiment reference = small_experiment();
  const std::vector<Evaluation> finalists{evaluation_of(5, {1, 2, 3}, 1.0), evaluation_of(9, {3, 2, 1}, 0.9)};
  MadeUpWorkers workers(judged, 2, 1, run_trial);
  const std::vector<Confirmation> confirmations = confirm(judged, finalists, workers, nullptr, {});
  ASSERT_EQ(confirmations.size(), 2U);
  for (const Confirmation& confirmation : confirmations) {
    const Task in_ode{0, 0, 0, confirmation.evaluation.candidate, {}};
    EXPECT_EQ(confirmation.mean, run_trial(reference, in_ode).measures[sim::Measure::distance]);
    EXPECT_NE(confirmation.mean, run_trial(judged, in_ode).measures[sim::Measure::distance]) << "of the search";
    EXPECT_EQ(confirmation.mean, run_own_world(judged, confirmation.evaluation).measures[sim::Measure::distance]);
  }
  EXPECT_GE(confirmations[0].mean, confirmations[1].mean);
  EXPECT_EQ(workers.batch_sizes(), (std::vector<std::size_t>{1, 1})) << "the judging engine has no batches";
}

TEST(Confirm, TheBestMeanOfTheFreshRunsWins) {
  Experiment experiment = noisy_experiment(2);
  experiment.confirmation.runs = 4;
  // Candidate 1 is good on average; candidate 2 has a better worst run. Trials 2 to 5 are the fresh ones.
  const std::map<std::uint32_t, std::vector<double>> scores{{1, {0.2, 1.0, 1.0, 1.0}}, {2, {0.5, 0.6, 0.7, 0.8}}};
  const RunTask run = [&](const Experiment&, const Task& task) {
    TrialResult result;
    result.measures[sim::Measure::distance] = scores.at(task.candidate[0]).at(task.trial - 2);
    return result;
  };
  const std::vector<Evaluation> finalists{evaluation_of(5, {2, 0, 0}, 3.0), evaluation_of(9, {1, 0, 0}, 2.0)};
  MadeUpWorkers workers(experiment, 3, 1, run);
  const std::vector<Confirmation> by_mean = confirm(experiment, finalists, workers, nullptr, {});
  ASSERT_EQ(by_mean.size(), 2U);
  EXPECT_EQ(by_mean[0].evaluation.number, 9U);
  EXPECT_DOUBLE_EQ(by_mean[0].mean, 0.8);
  EXPECT_DOUBLE_EQ(by_mean[0].standard_deviation, 0.4) << "sqrt((0.36 + 3 * 0.04) / 3)";
  EXPECT_EQ(by_mean[0].worst, 0.2);
  EXPECT_EQ(by_mean[0].scores, scores.at(1));
  experiment.trials.aggregate = Aggregate::worst;
  EXPECT_EQ(confirm(experiment, finalists, workers, nullptr, {})[0].evaluation.number, 5U);
}

TEST(Confirm, GivesTheSameForAnyNumberOfWorkersAndFromTheStore) {
  Experiment experiment = noisy_experiment();
  const TemporaryFolder folder;
  std::vector<Evaluation> finalists;
  for (std::uint32_t i = 0; i < 5; ++i) {
    finalists.push_back(evaluation_of(i, {i, 1, 1}, 1.0));
  }
  MadeUpWorkers one(experiment, 1, 1);
  const std::string expected = exact(confirm(experiment, finalists, one, nullptr, {}));
  MadeUpWorkers many(experiment, 7, 2);
  {
    Store store(folder.path() / "store.sqlite", experiment, "build", Store::Opening::fresh);
    EXPECT_EQ(exact(confirm(experiment, finalists, many, &store, {})), expected);
  }
  Store store(folder.path() / "store.sqlite", experiment, "build", Store::Opening::resume);
  MadeUpWorkers none(experiment, 2, 3);
  EXPECT_EQ(exact(confirm(experiment, finalists, none, &store, {})), expected);
  EXPECT_TRUE(none.started().empty()) << "all is in the store";
}

TEST(Confirm, EndsWhenItIsStopped) {
  const Experiment experiment = noisy_experiment();
  const std::vector<Evaluation> finalists{evaluation_of(0, {1, 1, 1}, 1.0)};
  MadeUpWorkers workers(experiment, 1, 1);
  int questions = 0;
  std::vector<std::size_t> done;
  const auto stop = [&](std::size_t so_far, std::size_t all) {
    EXPECT_EQ(all, experiment.confirmation.runs);
    done.push_back(so_far);
    return ++questions == 3;
  };
  EXPECT_THROW(static_cast<void>(confirm(experiment, finalists, workers, nullptr, stop)), SearchEnded);
  EXPECT_EQ(done.front(), 0U);
  EXPECT_TRUE(std::ranges::is_sorted(done));
}

}  // namespace
}  // namespace proleg::optimize
