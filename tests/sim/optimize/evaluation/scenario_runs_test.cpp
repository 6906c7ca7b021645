#include "sim/optimize/evaluation/scenario_runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/registry.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/scenario/settings.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

Experiment reduced(Experiment experiment) {
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  return experiment;
}

std::vector<Task> random_tasks(const Experiment& experiment, std::uint32_t count) {
  std::mt19937 random(5);
  std::vector<Task> tasks;
  for (std::uint32_t i = 0; i < count; ++i) {
    tasks.push_back({1, i / 2, i % 2, random_candidate(experiment, random), {}});
  }
  return tasks;
}

std::vector<std::string> exact(const std::vector<TrialResult>& results) {
  std::vector<std::string> texts;
  for (const TrialResult& result : results) {
    texts.push_back(exact(result));
  }
  return texts;
}

std::vector<TrialResult> alone(const Experiment& experiment, const std::vector<Task>& tasks) {
  std::vector<TrialResult> results;
  for (const Task& task : tasks) {
    results.push_back(run_trial(experiment, task));
  }
  return results;
}

TEST(Batch, IsMadeOfWorldsOfTheReducedEngineWithoutMoves) {
  Experiment experiment = small_experiment();
  EXPECT_EQ(sim::batch_size(experiment.scenario), 1U);
  experiment = reduced(experiment);
  EXPECT_EQ(sim::batch_size(experiment.scenario), 64U);
  experiment.scenario.moves.emplace_back();
  EXPECT_EQ(sim::batch_size(experiment.scenario), 1U);
}

TEST(ScenarioRuns, DoNotSimulateParametersThatContradictEachOther) {
  sim::Scenario good = reduced(small_experiment(0.2)).scenario;
  good.kernel.slots = {};
  good.kernel.slots[0] = {find_algorithm("SensingModule_gait_selector"), JointMask::first(good.kernel.joint_count)};
  good.settings.clear();
  good.changes.clear();
  sim::Scenario bad = good;
  for (const char* word : {"feature_2=4", "threshold_2=0.5", "feature_3=4", "threshold_3=0.4"}) {
    sim::apply_setting(bad, word);
  }
  const std::vector<sim::Scenario> scenarios{good, bad, good, bad, bad, good};
  std::vector<std::size_t> ended;
  const auto at_end = [&](std::size_t i, const sim::Simulation&, TrialResult&) { ended.push_back(i); };
  const std::vector<TrialResult> results = run_scenarios(scenarios, {{}, at_end});
  EXPECT_EQ(ended, (std::vector<std::size_t>{0, 2, 5}));
  for (const std::size_t i : {1U, 3U, 4U}) {
    EXPECT_EQ(results[i].failure.find("found SensingModule_gait_selector (1) with threshold_2 0.5 and threshold_3 0.4"),
              0U)
        << results[i].failure;
  }
  EXPECT_EQ(results[5].failure, "");
}

TEST(Batch, GivesEveryTrialTheBitsThatItHasAlone) {
  for (Experiment experiment : {noisy_experiment(2, 0.5), small_experiment(0.5)}) {
    experiment.trials.spread.mass = 0.1;
    for (const Experiment& its : {reduced(experiment), experiment}) {
      const std::vector<Task> tasks = random_tasks(its, 11);
      EXPECT_EQ(exact(run_trials(its, tasks)), exact(alone(its, tasks)));
    }
  }
}

TEST(Batch, GivesUpTheTrialsThatAreGivenUpAlone) {
  Experiment experiment = reduced(small_experiment(0.5));
  experiment.racing.after = 0.5;
  std::vector<Task> tasks = random_tasks(experiment, 12);
  std::vector<double> distances;
  for (const TrialResult& result : run_trials(experiment, tasks)) {
    distances.push_back(result.measures[sim::Measure::distance]);
  }
  std::ranges::sort(distances);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (i % 4 != 3) {
      tasks[i].hopeless_below = distances[distances.size() / 2];
    }
  }
  const std::vector<TrialResult> results = run_trials(experiment, tasks);
  EXPECT_EQ(exact(results), exact(alone(experiment, tasks)));
  const auto given_up = std::ranges::count_if(results, &TrialResult::given_up);
  EXPECT_GT(given_up, 0);
  EXPECT_LT(given_up, 9);
}

TEST(Batch, HasTheFailureOfOneTrialInItsResultOnly) {
  const Experiment experiment = reduced(small_experiment());
  std::vector<sim::Scenario> scenarios(5, experiment.scenario);
  scenarios[2].environment.gravity = {0.0, 0.0, -1e6};
  scenarios[2].environment.robot_pose.position.z() += 1000.0;
  scenarios[3].kernel.seed = 9;
  RunWatch watch;
  watch.at_end = [](std::size_t /*i*/, const sim::Simulation& simulation, TrialResult& result) {
    result.measures = simulation.measures();
  };
  const std::vector<TrialResult> results = run_scenarios(scenarios, watch);
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    EXPECT_EQ(exact(results[i]), exact(run_scenarios({&scenarios[i], 1}, watch).front())) << i;
    EXPECT_EQ(results[i].failure.empty(), i != 2) << results[i].failure;
  }
  EXPECT_LT(results[2].simulated_s, 0.3);
}

TEST(Batch, TakesScenariosThatDoNotFitTogetherOneAfterTheOther) {
  const Experiment experiment = reduced(small_experiment());
  std::vector<sim::Scenario> scenarios(6, experiment.scenario);
  scenarios[1].environment.engine = sim::PhysicsEngine::ode;
  scenarios[3].step_s /= 2.0;
  scenarios[5].duration_s = 0.1;
  RunWatch watch;
  constexpr std::chrono::milliseconds delay{10};
  watch.at_end = [delay](std::size_t /*i*/, const sim::Simulation& simulation, TrialResult& result) {
    result.measures = simulation.measures();
    std::this_thread::sleep_for(delay);
  };
  const std::vector<TrialResult> results = run_scenarios(scenarios, watch);
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    EXPECT_EQ(exact(results[i]), exact(run_scenarios({&scenarios[i], 1}, watch).front())) << i;
    EXPECT_GE(results[i].wall_s, std::chrono::duration<double>(delay).count());
  }
  EXPECT_EQ(results[5].simulated_s, 0.1);
}

TEST(RequireEngine, RefusesARobotThatTheEngineDoesNotHave) {
  Experiment experiment = small_experiment();
  EXPECT_NO_THROW(require_engine(reduced(experiment)));
  experiment.scenario.robot.links[1].geometries[0].shape = sim::Shape::sphere;
  EXPECT_NO_THROW(require_engine(experiment));
  EXPECT_THROW(require_engine(reduced(experiment)), InputError);
}

}  // namespace
}  // namespace proleg::optimize
