#include "sim/optimize/evaluation/evaluator.hpp"

#include <gtest/gtest.h>

#include <set>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

/// A search whose next candidate depends on the scores so far, with right and wrong predictions.
struct MadeUpSearch {
  const Experiment& experiment;
  std::uint32_t predictions_seed;   ///< 0: expects nothing
  std::uint32_t candidates = 1000;  ///< how many different ones there are

  [[nodiscard]] Candidate choose(std::uint64_t number, double last_score) const {
    const auto draw = static_cast<std::uint32_t>(number * 7919 + static_cast<std::uint64_t>(last_score * 1e6));
    std::mt19937 random(draw % candidates);
    return random_candidate(experiment, random);
  }

  void run(FitnessSource& source, std::uint64_t evaluations) const {
    std::mt19937 predictions(predictions_seed);
    double last_score = 0.0;
    for (std::uint64_t number = 0; number < evaluations; ++number) {
      const Candidate candidate = choose(number, last_score);
      if (predictions_seed != 0 && predictions() % 4 != 0) {
        std::vector<Candidate> next;
        for (std::uint32_t i = draw(predictions, 7); i > 0; --i) {
          next.push_back(random_candidate(experiment, predictions));
        }
        if (!next.empty() && predictions() % 2 == 0) {
          next[predictions() % next.size()] = candidate;
        }
        source.expect(next);
      }
      last_score = source.fitness(candidate).front();
      source.set_needed_score(last_score);
    }
  }
};

/// The same without workers, predictions and reuse: the oracle.
class PlainSource final : public FitnessSource {
 public:
  PlainSource(const Experiment& experiment, RunTask run) : experiment_(experiment), run_(std::move(run)) {}
  void expect(std::span<const Candidate> /*next*/) override {}
  [[nodiscard]] std::size_t lookahead() const override { return 1; }
  void set_needed_score(std::optional<double> score) override {
    hopeless_below_.reset();
    if (experiment_.racing.on() && score > 0.0) {
      hopeless_below_ = *score * experiment_.racing.keep;
    }
  }
  std::vector<double> fitness(const Candidate& candidate) override {
    std::vector<TrialResult> trials;
    for (std::uint32_t trial = 0; trial < experiment_.trials.count; ++trial) {
      trials.push_back(run_(experiment_, {3, evaluations_.size(), trial, candidate, hopeless_below_}));
    }
    Evaluation evaluation = rate(experiment_, 3, evaluations_.size(), candidate, trials);
    if (experiment_.reuse && !differs_between_evaluations(experiment_) &&
        !known_.emplace(candidate, hopeless_below_).second) {
      evaluation.reused = true;
      evaluation.simulated_s = 0.0;
    }
    evaluations_.push_back(exact(evaluation));
    return evaluation.scores;
  }
  [[nodiscard]] const std::vector<std::string>& evaluations() const { return evaluations_; }

 private:
  const Experiment& experiment_;
  RunTask run_;
  std::optional<double> hopeless_below_;
  std::set<std::pair<Candidate, std::optional<double>>> known_;
  std::vector<std::string> evaluations_;
};

std::vector<std::string> evaluate(const Experiment& experiment, Workers& workers, const MadeUpSearch& search,
                                  std::uint64_t evaluations, SearchProgress* progress = nullptr) {
  std::vector<std::string> seen;
  Evaluator evaluator(
      experiment, 3, workers, nullptr,
      [&seen](const Evaluation& evaluation, const SearchProgress&) { seen.push_back(exact(evaluation)); }, {});
  search.run(evaluator, evaluations);
  if (progress != nullptr) {
    *progress = evaluator.progress();
  }
  return seen;
}

TEST(Evaluator, GivesTheSameForAllPredictionsAndNumbersOfWorkers) {
  std::vector<Experiment> experiments{small_experiment(),  noisy_experiment(1), noisy_experiment(3),
                                      small_experiment(),  small_experiment(),  small_experiment(),
                                      noisy_experiment(3), noisy_experiment(2)};
  experiments[2].trials.aggregate = Aggregate::worst;
  experiments[3].racing.after = 0.5;
  experiments[4].reuse = false;
  experiments[5].trials.count = 2;
  experiments[6].trials.random_numbers = RandomNumbers::common;
  experiments[7].scenario.environment.engine = sim::PhysicsEngine::reduced;  // batches
  std::random_device device;
  const std::uint32_t seed = device();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    const Experiment& experiment = experiments[i];
    PlainSource plain(experiment, made_up_trial);
    MadeUpSearch{experiment, 0, 30}.run(plain, 60);
    for (int repetition = 0; repetition < 20; ++repetition) {
      MadeUpWorkers workers(experiment, 1 + draw(random, 5), draw(random, 1'000'000));
      ASSERT_EQ(evaluate(experiment, workers, {experiment, 1 + draw(random, 1000), 30}, 60), plain.evaluations())
          << "experiment " << i;
    }
  }
}

TEST(Evaluator, GivesTheSameWithOneTwoAndThreeProcesses) {
  Experiment experiment = noisy_experiment(2, 0.1);
  experiment.racing.after = 0.5;
  PlainSource plain(experiment, run_trial);
  MadeUpSearch{experiment, 0}.run(plain, 8);
  for (const std::uint32_t count : {1U, 2U, 3U}) {
    LocalWorkers workers(experiment, count);
    EXPECT_EQ(evaluate(experiment, workers, {experiment, count}, 8), plain.evaluations()) << count << " workers";
  }
}

TEST(Evaluator, GivesTheSameInBatchesAndAlone) {
  for (Experiment experiment : {noisy_experiment(2, 0.1), small_experiment(0.1)}) {
    experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
    experiment.racing.after = 0.5;
    PlainSource plain(experiment, run_trial);
    MadeUpSearch{experiment, 0, 30}.run(plain, 20);
    for (const std::uint32_t count : {1U, 2U, 3U}) {
      LocalWorkers workers(experiment, count);
      EXPECT_EQ(evaluate(experiment, workers, {experiment, count, 30}, 20), plain.evaluations()) << count << " workers";
    }
  }
}

TEST(Evaluator, DividesWhatIsExpectedEvenlyInBatches) {
  const auto sizes = [](sim::PhysicsEngine engine, std::uint32_t workers_count, std::size_t candidates) {
    Experiment experiment = noisy_experiment();
    experiment.scenario.environment.engine = engine;
    MadeUpWorkers workers(experiment, workers_count, 1);
    Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
    const std::vector<Candidate> next(candidates, Candidate{1, 1, 1});
    evaluator.expect(next);
    for (const Candidate& candidate : next) {
      evaluator.fitness(candidate);
    }
    EXPECT_EQ(workers.started().size(), candidates);
    return workers.batch_sizes();
  };
  using Sizes = std::vector<std::size_t>;
  const auto reduced = sim::PhysicsEngine::reduced;
  EXPECT_EQ(sizes(reduced, 2, 20), (Sizes{10, 10}));
  EXPECT_EQ(sizes(reduced, 3, 20), (Sizes{7, 7, 6}));
  EXPECT_EQ(sizes(reduced, 5, 3), (Sizes{1, 1, 1}));
  EXPECT_EQ(sizes(reduced, 1, 100), (Sizes{64, 36}));
  EXPECT_EQ(sizes(sim::PhysicsEngine::ode, 2, 5), (Sizes{1, 1, 1, 1, 1}));
}

TEST(Evaluator, DoesNotSimulateACandidateAgainIfItMeetsTheSameWorlds) {
  for (const RandomNumbers numbers : {RandomNumbers::common, RandomNumbers::fresh}) {
    Experiment experiment = noisy_experiment(2);
    experiment.trials.random_numbers = numbers;
    MadeUpWorkers workers(experiment, 2, 1);
    Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
    const std::vector<double> first = evaluator.fitness({1, 2, 3});
    static_cast<void>(evaluator.fitness({3, 2, 1}));
    const bool is_common = numbers == RandomNumbers::common;
    EXPECT_EQ(evaluator.fitness({1, 2, 3}) == first, is_common);
    EXPECT_EQ(evaluator.progress().reused, is_common ? 1U : 0U);
    EXPECT_EQ(workers.started().size(), is_common ? 4U : 6U);
  }
}

TEST(Evaluator, CountsFailuresAndTakesNoneOfThemAsTheBest) {
  Experiment experiment = small_experiment();
  experiment.objectives.front().failed = 7.0;  // better than any run, by mistake of the user
  const RunTask run = [](const Experiment&, const Task& task) {
    TrialResult result;
    if (task.candidate[0] == 0) {
      result.failure = "broke at candidate " + std::to_string(task.candidate[1]);
    } else {
      result.measures[sim::Measure::distance] = 0.5 * task.candidate[0];
    }
    return result;
  };
  MadeUpWorkers workers(experiment, 2, 1, run);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  EXPECT_EQ(evaluator.fitness({0, 3, 0}).front(), 7.0);
  EXPECT_FALSE(evaluator.progress().best.has_value());
  for (const Candidate& candidate : {Candidate{1, 0, 0}, {0, 1, 0}, {2, 0, 0}}) {
    static_cast<void>(evaluator.fitness(candidate));
  }
  EXPECT_EQ(evaluator.progress().failed, 2U);
  EXPECT_EQ(evaluator.progress().first_failure, "broke at candidate 3");
  ASSERT_TRUE(evaluator.progress().best);
  EXPECT_EQ(evaluator.progress().best->number, 3U);
}

TEST(Evaluator, SimulatesEachTrialOnceIfAllPredictionsAreRight) {
  const Experiment experiment = noisy_experiment(2);
  MadeUpWorkers workers(experiment, 3, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  EXPECT_EQ(evaluator.lookahead(), 6U);
  std::mt19937 random(1);
  std::vector<Candidate> population(20);
  for (Candidate& candidate : population) {
    candidate = random_candidate(experiment, random);
  }
  evaluator.expect(population);
  for (const Candidate& candidate : population) {
    evaluator.fitness(candidate);
  }
  EXPECT_EQ(workers.started().size(), 40U);
  EXPECT_EQ(evaluator.progress().wasted, 0U);
  EXPECT_EQ(evaluator.progress().simulated, 20U);
  EXPECT_EQ(evaluator.progress().simulated_s, 40 * 0.25);
  // In the order in which they will be needed.
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(workers.started()[i].number, i / 2);
  }
}

TEST(Evaluator, GivesWorkersThePredictedCandidates) {
  const Experiment experiment = noisy_experiment();
  MadeUpWorkers workers(experiment, 4, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  const std::vector<Candidate> next{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
  evaluator.expect(next);
  EXPECT_GE(workers.started().size(), 4U);
}

TEST(Evaluator, LetsARobotMakeOnlyTrialsThatAreAskedFor) {
  Experiment experiment = noisy_experiment();
  put_on_robot(experiment, "");
  MadeUpWorkers workers(experiment, 1, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  evaluator.expect(std::vector<Candidate>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  EXPECT_TRUE(workers.started().empty());
  evaluator.fitness({2, 0, 0});
  ASSERT_EQ(workers.started().size(), 1U);
  EXPECT_EQ(workers.started().front().candidate, (Candidate{2, 0, 0}));
}

TEST(Evaluator, DropsOldPredictionsAndCountsWastedTrials) {
  const Experiment experiment = noisy_experiment();
  MadeUpWorkers workers(experiment, 1, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  evaluator.expect(std::vector<Candidate>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  evaluator.expect(std::vector<Candidate>{{3, 0, 0}, {4, 0, 0}});
  evaluator.fitness({3, 0, 0});
  evaluator.fitness({4, 0, 0});
  // The first one was begun (and perhaps more, before the second expect).
  EXPECT_EQ(workers.started().size(), 2 + evaluator.progress().wasted);
  EXPECT_GE(evaluator.progress().wasted, 1U);
}

TEST(Evaluator, ReusesOutcomesThatCannotDiffer) {
  const Experiment experiment = small_experiment();
  MadeUpWorkers workers(experiment, 2, 1);
  std::vector<Evaluation> seen;
  Evaluator evaluator(experiment, 0, workers, nullptr,
                      [&seen](const Evaluation& evaluation, const SearchProgress&) { seen.push_back(evaluation); }, {});
  const Candidate a{1, 1, 1};
  const Candidate b{2, 2, 2};
  evaluator.expect(std::vector<Candidate>{a, b, a});
  const std::vector<double> score = evaluator.fitness(a);
  evaluator.fitness(b);
  EXPECT_EQ(evaluator.fitness(a), score);
  evaluator.expect(std::vector<Candidate>{b, a, b});
  evaluator.fitness(b);
  EXPECT_EQ(workers.started().size(), 2U);
  EXPECT_TRUE(!seen[0].reused && !seen[1].reused && seen[2].reused && seen[3].reused);
  EXPECT_EQ(seen[2].number, 2U);
  EXPECT_EQ(seen[2].simulated_s, 0.0);
  EXPECT_EQ(seen[2].failure, seen[0].failure);
  EXPECT_EQ(evaluator.progress().reused, 2U);
  EXPECT_EQ(evaluator.progress().simulated, 2U);
}

TEST(Evaluator, UsesATrialOfAnotherNumberIfItCannotDiffer) {
  const Experiment experiment = small_experiment();
  MadeUpWorkers workers(experiment, 4, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  const Candidate a{1, 1, 1};
  const Candidate b{2, 2, 2};
  evaluator.expect(std::vector<Candidate>{a, b});
  evaluator.fitness({3, 3, 3});
  evaluator.fitness(b);
  evaluator.fitness(a);
  EXPECT_EQ(workers.started().size(), 3U);
  EXPECT_EQ(evaluator.progress().wasted, 0U);
  EXPECT_EQ(evaluator.progress().simulated, 3U);
}

TEST(Evaluator, SimulatesAgainIfTheExperimentSaysSo) {
  Experiment experiment = small_experiment();
  experiment.reuse = false;
  MadeUpWorkers workers(experiment, 2, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  evaluator.fitness({1, 1, 1});
  evaluator.fitness({1, 1, 1});
  EXPECT_EQ(workers.started().size(), 2U);
}

TEST(Evaluator, MarksTheFirstEvaluationAfterARestartAlsoIfItsOutcomeIsKnown) {
  const Experiment experiment = small_experiment();
  MadeUpWorkers workers(experiment, 1, 1);
  std::vector<bool> marks;
  Evaluator evaluator(
      experiment, 0, workers, nullptr,
      [&](const Evaluation& evaluation, const SearchProgress&) { marks.push_back(evaluation.after_restart); }, {});
  evaluator.fitness({1, 1, 1});
  evaluator.mark_restart();
  evaluator.fitness({1, 1, 1});
  evaluator.fitness({2, 1, 1});
  evaluator.mark_restart();
  evaluator.fitness({3, 1, 1});
  evaluator.fitness({3, 1, 1});
  EXPECT_EQ(marks, (std::vector<bool>{false, true, false, true, false}));
}

TEST(Evaluator, GivesTasksTheScoreThatTheyNeed) {
  Experiment experiment = small_experiment();
  experiment.racing = {0.5, 0.75};
  MadeUpWorkers workers(experiment, 1, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  evaluator.set_needed_score(2.0);
  evaluator.fitness({1, 1, 1});
  evaluator.set_needed_score(-2.0);
  evaluator.fitness({2, 1, 1});
  evaluator.set_needed_score(std::nullopt);
  evaluator.fitness({3, 1, 1});
  experiment.racing.after = 0.0;
  evaluator.set_needed_score(2.0);
  evaluator.fitness({4, 1, 1});
  ASSERT_EQ(workers.started().size(), 4U);
  EXPECT_EQ(workers.started()[0].hopeless_below, 1.5);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(workers.started()[i].hopeless_below, std::nullopt) << i;
  }
}

TEST(Evaluator, ReportsTheBestAndTheSum) {
  const Experiment experiment = small_experiment();
  MadeUpWorkers workers(experiment, 2, 1);
  double best = -1.0;
  double sum = 0.0;
  Evaluator evaluator(experiment, 0, workers, nullptr,
                      [&](const Evaluation& evaluation, const SearchProgress& progress) {
                        best = std::max(best, evaluation.scores[0]);
                        sum += evaluation.scores[0];
                        EXPECT_EQ(progress.best->scores[0], best);
                        EXPECT_EQ(progress.score_sum, sum);
                        EXPECT_EQ(progress.evaluations, evaluation.number + 1);
                      },
                      {});
  MadeUpSearch{experiment, 5}.run(evaluator, 30);
  EXPECT_EQ(evaluator.progress().evaluations, 30U);
}

TEST(Evaluator, NeverStartsMoreThanTheBudget) {
  Experiment experiment = noisy_experiment();
  experiment.evaluations = 5;
  MadeUpWorkers workers(experiment, 3, 1);
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  const std::vector<Candidate> next(10, Candidate{1, 1, 1});
  evaluator.expect(next);
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(evaluator.budget_spent());
    evaluator.fitness(next[0]);
    evaluator.expect(next);
  }
  EXPECT_TRUE(evaluator.budget_spent());
  EXPECT_THROW(evaluator.fitness(next[0]), SearchEnded);
  EXPECT_EQ(workers.started().size(), 5U);
  EXPECT_FALSE(evaluator.stopped());
}

TEST(Evaluator, StopsWhileItWaitsAndBefore) {
  const Experiment experiment = small_experiment();
  LocalWorkers workers(experiment, 1, [](const Experiment&, std::span<const Task>) -> std::vector<TrialResult> {
    while (true) {
      pause();
    }
  });
  int asked = 0;
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, [&asked] { return ++asked > 2; });
  EXPECT_THROW(evaluator.fitness({1, 1, 1}), SearchEnded);
  EXPECT_TRUE(evaluator.stopped());
  EXPECT_FALSE(evaluator.budget_spent());
  EXPECT_THROW(evaluator.fitness({1, 1, 1}), SearchEnded);
  EXPECT_EQ(evaluator.progress().evaluations, 0U);
}

TEST(Evaluator, IgnoresTasksOfAnEarlierOne) {
  const Experiment experiment = noisy_experiment();
  MadeUpWorkers workers(experiment, 3, 1);
  {
    Evaluator abandoned(experiment, 2, workers, nullptr, {}, {});
    abandoned.expect(std::vector<Candidate>{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  }
  PlainSource plain(experiment, made_up_trial);
  const MadeUpSearch search{experiment, 1};
  search.run(plain, 10);
  EXPECT_EQ(evaluate(experiment, workers, search, 10), plain.evaluations());
}

}  // namespace
}  // namespace proleg::optimize
