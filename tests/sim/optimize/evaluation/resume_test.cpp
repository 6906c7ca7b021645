#include <gtest/gtest.h>

#include <map>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/evaluation/local_workers.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

/// A search whose next candidate depends on the scores so far; it expects one right candidate and wrong ones.
void search(const Experiment& experiment, FitnessSource& source, std::uint64_t evaluations) {
  std::mt19937 random(4);
  double sum = 0.0;
  for (std::uint64_t number = 0; number < evaluations; ++number) {
    const auto pick = static_cast<std::uint32_t>(sum * 1e6);
    const Candidate candidate{pick % 6, pick % 4, pick / 4 % 4};
    source.expect(
        std::vector<Candidate>{candidate, random_candidate(experiment, random), random_candidate(experiment, random)});
    sum += source.fitness(candidate).front();
    source.set_needed_score(sum / static_cast<double>(number + 1));
  }
}

class Resume : public testing::Test {
 protected:
  struct Outcome {
    std::vector<std::string> evaluations;
    SearchProgress progress;
    std::size_t tasks = 0;
  };

  /// stop_after: evaluations; then the search is interrupted.
  [[nodiscard]] Outcome run(const Experiment& experiment, Store* store, std::uint64_t stop_after, std::uint32_t seed) {
    MadeUpWorkers workers(experiment, 3, seed);
    Outcome outcome;
    Evaluator evaluator(
        experiment, 0, workers, store,
        [&](const Evaluation& evaluation, const SearchProgress&) { outcome.evaluations.push_back(exact(evaluation)); },
        [&] { return outcome.evaluations.size() >= stop_after; });
    try {
      search(experiment, evaluator, 30);
    } catch (const SearchEnded&) {
      EXPECT_EQ(outcome.evaluations.size(), stop_after);
    }
    outcome.progress = evaluator.progress();
    outcome.tasks = workers.started().size();
    return outcome;
  }

  [[nodiscard]] std::vector<std::string> stored(const Experiment& experiment) const {
    Store store(path_, experiment, "build", Store::Opening::resume);
    std::vector<std::string> evaluations;
    for (const Evaluation& evaluation : store.evaluations(0)) {
      evaluations.push_back(exact(evaluation));
    }
    return evaluations;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "store.sqlite";
};

TEST_F(Resume, GivesTheSameAsAnUninterruptedSearch) {
  std::vector<Experiment> experiments{small_experiment(), noisy_experiment(2), noisy_experiment(1)};
  experiments[2].racing.after = 0.5;
  for (const Experiment& experiment : experiments) {
    std::filesystem::remove(path_);
    const Outcome whole = run(experiment, nullptr, 1000, 1);
    ASSERT_EQ(whole.evaluations.size(), 30U);
    {
      Store store(path_, experiment, "build", Store::Opening::fresh);
      EXPECT_EQ(run(experiment, &store, 10, 2).evaluations.size(), 10U);
    }
    EXPECT_EQ(stored(experiment), std::vector(whole.evaluations.begin(), whole.evaluations.begin() + 10));
    {
      Store store(path_, experiment, "build", Store::Opening::resume);
      EXPECT_EQ(run(experiment, &store, 20, 3).evaluations.size(), 20U);
    }
    Outcome last;
    {
      Store store(path_, experiment, "build", Store::Opening::resume);
      last = run(experiment, &store, 1000, 4);
    }
    EXPECT_EQ(last.evaluations, whole.evaluations);
    EXPECT_EQ(stored(experiment), whole.evaluations);
    EXPECT_EQ(last.progress.reused, whole.progress.reused);
    EXPECT_EQ(last.progress.simulated + last.progress.restored, whole.progress.simulated);
    EXPECT_GE(last.progress.restored + last.progress.reused, 20U);
  }
}

TEST_F(Resume, OfAFinishedSearchSimulatesNothing) {
  const Experiment experiment = small_experiment();
  {
    Store store(path_, experiment, "build", Store::Opening::fresh);
    static_cast<void>(run(experiment, &store, 1000, 1));
  }
  Store store(path_, experiment, "build", Store::Opening::resume);
  std::mt19937 random(1);
  MadeUpWorkers workers(experiment, 3, 1);
  std::vector<std::string> seen;
  Evaluator evaluator(experiment, 0, workers, &store,
                      [&](const Evaluation& evaluation, const SearchProgress&) {
                        EXPECT_TRUE(evaluation.restored != evaluation.reused);
                        seen.push_back(exact(evaluation));
                      },
                      {});
  double sum = 0.0;
  for (std::uint64_t number = 0; number < 30; ++number) {
    const auto pick = static_cast<std::uint32_t>(sum * 1e6);
    sum += evaluator.fitness({pick % 6, pick % 4, pick / 4 % 4}).front();
  }
  EXPECT_TRUE(workers.started().empty());
  EXPECT_EQ(evaluator.progress().simulated, 0U);
  EXPECT_EQ(evaluator.progress().simulated_s, 0.0);
  EXPECT_EQ(seen, run(experiment, nullptr, 1000, 1).evaluations);
}

TEST_F(Resume, AfterRealSimulationsIsTheSameToTheLastBit) {
  const Experiment experiment = noisy_experiment(1, 0.1);
  std::vector<std::string> first;
  const auto run_some = [&](Store::Opening opening) {
    LocalWorkers workers(experiment, 2);
    Store store(path_, experiment, "build", opening);
    std::vector<std::string> seen;
    Evaluator evaluator(experiment, 0, workers, &store,
                        [&](const Evaluation& evaluation, const SearchProgress&) { seen.push_back(exact(evaluation)); },
                        {});
    search(experiment, evaluator, 5);
    return std::pair(seen, evaluator.progress().restored);
  };
  const auto [seen, restored] = run_some(Store::Opening::fresh);
  const auto [seen_again, restored_again] = run_some(Store::Opening::resume);
  EXPECT_EQ(restored, 0U);
  EXPECT_EQ(restored_again, 5U);
  EXPECT_EQ(seen, seen_again);
}

}  // namespace
}  // namespace proleg::optimize
