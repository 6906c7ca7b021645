#include "sim/optimize/method/search.hpp"

#include <gtest/gtest.h>

#include "fake_source.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

PagmoSettings pagmo_method(const std::string& name, std::uint32_t population = 20) {
  PagmoSettings settings;
  settings.algorithm = name;
  settings.population = population;
  settings.generations = 3;
  return settings;
}

std::string refusal(const Experiment& experiment) {
  try {
    check_method(experiment);
  } catch (const InputError& error) {
    FakeSource source([](const Candidate&) { return std::vector<double>{0.0}; });
    EXPECT_THROW(static_cast<void>(search(experiment, 0, source)), InputError);
    EXPECT_TRUE(source.asked.empty());
    return error.what();
  }
  return "";
}

TEST(CheckMethod, NamesTheAlgorithms) {
  const std::string message = refusal(make_experiment({5}, pagmo_method("simplex")));
  EXPECT_EQ(message,
            "test.optimise.xml: found algorithm 'simplex', expected one of bee_colony, cmaes, compass_search, de, "
            "de1220, gaco, gwo, ihs, maco, moead, nsga2, nspso, pso, pso_gen, sade, sea, sga, simulated_annealing, "
            "xnes");
}

TEST(CheckMethod, RefusesTheWrongNumberOfObjectives) {
  for (const MethodSettings& method :
       std::vector<MethodSettings>{GreatDelugeSettings{}, GeneticSettings{}, pagmo_method("cmaes")}) {
    EXPECT_EQ(refusal(make_experiment({5}, method)), "");
    EXPECT_NE(refusal(make_experiment({5}, method, Goal::maximise, 2)).find("found 2 objectives for "),
              std::string::npos);
  }
  EXPECT_EQ(refusal(make_experiment({5}, pagmo_method("nsga2"), Goal::maximise, 2)), "");
  EXPECT_EQ(refusal(make_experiment({5}, pagmo_method("nsga2"))),
            "test.optimise.xml: found 1 objective for nsga2, expected at least two objectives");
}

TEST(CheckMethod, RefusesAPopulationThatIsTooSmall) {
  EXPECT_EQ(refusal(make_experiment({5}, pagmo_method("cmaes", 4))),
            "test.optimise.xml: found a population of 4 for cmaes, expected at least 5");
  EXPECT_EQ(refusal(make_experiment({5}, pagmo_method("nsga2", 22), Goal::maximise, 2)),
            "test.optimise.xml: found a population of 22 for nsga2, expected at least 8, and a multiple of 4");
  EXPECT_NE(refusal(make_experiment({5}, pagmo_method("sea", 0))), "");
}

TEST(CheckMethod, RefusesSettingsThatAnAlgorithmDoesNotHave) {
  PagmoSettings settings = pagmo_method("de");
  settings.sigma0 = 0.3;
  EXPECT_EQ(refusal(make_experiment({5}, settings)),
            "test.optimise.xml: found sigma0 for de, expected one of its settings: crossover, scale");
  settings = pagmo_method("sade");
  settings.scale = 0.3;
  EXPECT_EQ(refusal(make_experiment({5}, settings)),
            "test.optimise.xml: found scale for sade, expected no such setting: sade has none");
  settings = pagmo_method("cmaes");
  settings.sigma0 = 0.0;
  EXPECT_NE(refusal(make_experiment({5}, settings)), "");
  settings.sigma0 = 1.0;
  EXPECT_EQ(refusal(make_experiment({5}, settings)), "");
  settings = pagmo_method("sga");
  settings.mutation = 1.5;
  EXPECT_NE(refusal(make_experiment({5}, settings)), "");
  settings.mutation = 0.0;
  EXPECT_EQ(refusal(make_experiment({5}, settings)), "");
}

TEST(CheckMethod, RefusesReevaluationsThatAreAllEqual) {
  GreatDelugeSettings settings;
  settings.reevaluations = 2;
  Experiment experiment = make_experiment({5}, settings);
  EXPECT_EQ(refusal(experiment), "") << "nothing is random: that is so without common random numbers, too";
  experiment.trials.spread.friction = 0.1;
  EXPECT_NE(
      refusal(experiment).find("found 2 reevaluations that are all equal, expected 0, or randomNumbers=\"fresh\""),
      std::string::npos);
  experiment.trials.random_numbers = RandomNumbers::fresh;
  EXPECT_EQ(refusal(experiment), "");
}

TEST(PlannedEvaluations, AreThoseOfTheBudgetOrOfAllGenerationsWithTheFirstPopulation) {
  Experiment experiment = make_experiment({5}, pagmo_method("cmaes", 20));  // 3 generations
  EXPECT_EQ(planned_evaluations(experiment), 80U);
  experiment.has_baseline = true;
  EXPECT_EQ(planned_evaluations(experiment), 81U);
  experiment.has_baseline = false;
  experiment.evaluations = 50;
  EXPECT_EQ(planned_evaluations(experiment), 50U);
  experiment.evaluations = 5000;
  EXPECT_EQ(planned_evaluations(experiment), 80U);
  experiment.method = GreatDelugeSettings{};
  EXPECT_EQ(planned_evaluations(experiment), 5000U);
  experiment.evaluations = 0;
  EXPECT_EQ(planned_evaluations(experiment), 0U) << "unknown";
}

/// An experiment whose scenario has 40 degrees on the five joints of a travelling wave; 0 to 10 degrees by 1 and 40.
Experiment real_experiment(const MethodSettings& method) {
  Experiment experiment = make_experiment({12, 12, 12}, method);
  sim::DiskFiles files;
  experiment.scenario = sim::read_scenario(
      std::filesystem::path(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml")), files);
  for (Dimension& dimension : experiment.space.dimensions) {
    dimension.unit = Unit::degree;
    for (std::size_t i = 0; i < 12; ++i) {
      dimension.values[i] = raw(Unit::degree, i == 11 ? 40 : static_cast<int>(i));
    }
  }
  return experiment;
}

const Candidate own_values{11, 11, 11};

std::vector<Candidate> asked_by(const Experiment& experiment) {
  FakeSource source([](const Candidate& candidate) { return std::vector<double>{sphere(candidate, 5.0)}; }, 8, 60);
  try {
    static_cast<void>(search(experiment, 0, source));
  } catch (const SearchEnded&) {
  }
  return source.asked;
}

std::vector<MethodSettings> methods_that_start_at(Start start) {
  GreatDelugeSettings deluge;
  deluge.start = start;
  GeneticSettings genetic;
  genetic.start = start;
  std::vector<MethodSettings> methods{deluge, genetic};
  for (const PagmoAlgorithm& algorithm : pagmo_algorithms()) {
    if (algorithm.declaration().objectives != ObjectiveCount::several) {
      PagmoSettings settings = pagmo_method(std::string(algorithm.name));
      settings.start = start;
      methods.emplace_back(settings);
    }
  }
  return methods;
}

TEST(Search, EvaluatesTheBaselineFirstAndThenDoesWhatItWouldDoWithout) {
  for (const Start start : {Start::random, Start::scenario}) {
    for (const MethodSettings& method : methods_that_start_at(start)) {
      Experiment experiment = real_experiment(method);
      std::vector<Candidate> without = asked_by(experiment);
      experiment.has_baseline = true;
      const std::vector<Candidate> with = asked_by(experiment);
      ASSERT_FALSE(with.empty());
      EXPECT_EQ(with.front(), own_values);
      without.insert(without.begin(), own_values);
      without.resize(with.size());
      EXPECT_EQ(with, without) << method_name(method);
    }
  }
}

TEST(Search, HasTheScenariosValuesInTheFirstPopulationIfItStartsThere) {
  for (const Start start : {Start::random, Start::scenario}) {
    for (const MethodSettings& method : methods_that_start_at(start)) {
      std::vector<Candidate> first = asked_by(real_experiment(method));
      first.resize(std::min<std::size_t>(first.size(), std::holds_alternative<GeneticSettings>(method)       ? 30
                                                       : std::holds_alternative<GreatDelugeSettings>(method) ? 1
                                                                                                             : 20));
      EXPECT_EQ(std::ranges::count(first, own_values), start == Start::scenario ? 1 : 0) << method_name(method);
    }
  }
}

TEST(Search, OfOneCandidateEvaluatesItOnce) {
  for (const MethodSettings& method :
       std::vector<MethodSettings>{GreatDelugeSettings{}, GeneticSettings{}, pagmo_method("cmaes")}) {
    FakeSource source([](const Candidate&) { return std::vector<double>{1.0}; });
    EXPECT_EQ(search(make_experiment({1, 1}, method), 0, source), "there is one candidate only");
    EXPECT_EQ(source.asked, (std::vector<Candidate>{{0, 0}}));
  }
}

}  // namespace
}  // namespace proleg::optimize
