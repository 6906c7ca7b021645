#include <gtest/gtest.h>

#include <bit>

#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/scenario/settings.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

std::vector<std::uint64_t> bits(const sim::MeasureValues& measures) {
  std::vector<std::uint64_t> bits;
  for (const double value : measures.all()) {
    bits.push_back(
        std::bit_cast<std::uint64_t>(value == value ? value + 0.0 : std::numeric_limits<double>::quiet_NaN()));
  }
  return bits;
}

sim::MeasureValues simulated(const sim::Scenario& scenario, std::uint32_t ticks, double heading_deg = 0.0) {
  sim::Simulation simulation(scenario);
  while (simulation.tick() < ticks) {
    simulation.advance();
  }
  return simulation.measures(heading_deg);
}

TEST(RunTrial, IsASimulationOfTheScenarioWithTheCandidatesValues) {
  Experiment experiment = small_experiment(0.5);
  experiment.heading_deg = 30.0;
  const TrialResult result = run_trial(experiment, {0, 3, 0, {4, 2, 1}, {}});
  // The same through words of the command line.
  sim::Scenario scenario = experiment.scenario;
  for (const char* word : {"amplitude=50", "frequency=1.5", "phase_difference=50"}) {
    sim::apply_setting(scenario, word);
  }
  EXPECT_EQ(bits(result.measures), bits(simulated(scenario, 50, 30.0)));
  EXPECT_GT(result.measures[sim::Measure::distance], 0.0);
  EXPECT_EQ(result.simulated_s, 0.5);
  EXPECT_EQ(result.failure, "");
  EXPECT_FALSE(result.given_up);
}

TEST(RunTrial, RepeatsToTheLastBitAfterOtherTrials) {
  const Experiment experiment = small_experiment();
  const Task task{0, 0, 0, {3, 1, 2}, {}};
  const std::string first = exact(run_trial(experiment, task));
  static_cast<void>(run_trial(experiment, {0, 1, 0, {5, 3, 0}, {}}));
  EXPECT_EQ(exact(run_trial(experiment, task)), first);
}

TEST(RunTrial, DependsOnRunNumberAndTrialOnlyIfTheSeedHasInfluence) {
  const Experiment experiment = small_experiment();
  const Candidate candidate{3, 1, 2};
  const std::string first = exact(run_trial(experiment, {0, 0, 0, candidate, {}}));
  EXPECT_EQ(exact(run_trial(experiment, {1, 2, 3, candidate, {}})), first);

  const Experiment noisy = noisy_experiment();
  const std::string noisy_first = exact(run_trial(noisy, {0, 0, 0, candidate, {}}));
  EXPECT_EQ(exact(run_trial(noisy, {0, 0, 0, candidate, {}})), noisy_first);
  EXPECT_NE(exact(run_trial(noisy, {1, 0, 0, candidate, {}})), noisy_first);
  EXPECT_NE(exact(run_trial(noisy, {0, 1, 0, candidate, {}})), noisy_first);
  EXPECT_NE(exact(run_trial(noisy, {0, 0, 1, candidate, {}})), noisy_first);
}

TEST(RunTrial, MeetsTheSameWorldInEveryEvaluationOfARepetitionWithCommonRandomNumbers) {
  Experiment experiment = noisy_experiment();
  experiment.trials.random_numbers = RandomNumbers::common;
  const Candidate candidate{3, 1, 2};
  const std::string first = exact(run_trial(experiment, {0, 0, 0, candidate, {}}));
  EXPECT_EQ(exact(run_trial(experiment, {0, 9, 0, candidate, {}})), first) << "another evaluation";
  EXPECT_NE(exact(run_trial(experiment, {1, 0, 0, candidate, {}})), first) << "another repetition";
  EXPECT_NE(exact(run_trial(experiment, {0, 0, 1, candidate, {}})), first) << "another trial";
}

TEST(RunTrial, PerturbsWithTheTrialsSeed) {
  const Experiment experiment = noisy_experiment(2);
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply({3, 1, 2}, scenario);
  perturb(scenario, experiment.trials.spread, trial_seed(experiment.seed, 2, 5, 1));
  EXPECT_EQ(bits(run_trial(experiment, {2, 5, 1, {3, 1, 2}, {}}).measures), bits(simulated(scenario, 30)));
}

TEST(OwnWorld, IsTheOnlyTrialIfNothingIsVaried) {
  Experiment experiment = small_experiment();
  experiment.scenario.contact_noise = 0.2;
  for (const RandomNumbers numbers : {RandomNumbers::common, RandomNumbers::fresh}) {
    experiment.trials.random_numbers = numbers;
    const Task task{2, 5, 0, {3, 1, 2}, {}};
    const TrialResult trial = run_trial(experiment, task);
    const Evaluation evaluation = rate(experiment, task.run, task.number, task.candidate, std::vector{trial});
    EXPECT_EQ(exact(run_own_world(experiment, evaluation)), exact(trial));
    EXPECT_EQ(own_world(experiment, evaluation).kernel.seed, seed_of(experiment, task));
  }
}

TEST(OwnWorld, HasNoVariations) {
  const Experiment experiment = noisy_experiment();
  Evaluation evaluation;
  evaluation.candidate = {3, 1, 2};
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(evaluation.candidate, scenario);
  EXPECT_EQ(bits(run_own_world(experiment, evaluation).measures), bits(simulated(scenario, 30)));
}

TEST(RunTrial, ReportsWhyASimulationFailed) {
  Experiment experiment = small_experiment();
  experiment.scenario.environment.gravity = {0.0, 0.0, -1e6};
  experiment.scenario.environment.robot_pose.position.z() += 1000.0;
  const TrialResult result = run_trial(experiment, {0, 0, 0, {3, 1, 2}, {}});
  EXPECT_NE(result.failure, "");
  EXPECT_LT(result.simulated_s, 0.3);
  for (const double value : result.measures.all()) {
    EXPECT_NE(value, value);
  }
  EXPECT_EQ(experiment.objectives.front().score(result.measures), 0.0);
  // The next trial is not affected.
  const Experiment sound = small_experiment();
  const TrialResult next = run_trial(sound, {0, 0, 0, {3, 1, 2}, {}});
  sim::Scenario scenario = sound.scenario;
  sound.space.apply({3, 1, 2}, scenario);
  EXPECT_EQ(bits(next.measures), bits(simulated(scenario, 30)));
}

}  // namespace
}  // namespace proleg::optimize
