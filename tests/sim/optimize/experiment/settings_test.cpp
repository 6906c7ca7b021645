// What the method section, the fitness and the evaluation become.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "experiment_files.hpp"

namespace proleg::optimize {
namespace {

const std::string water_level = "<waterLevel>0.1</waterLevel>";
const std::string objective = "<objective measure=\"distance\"/>";

/// The small experiment with another method section.
Experiment with_method(const std::string& tag, const std::string& settings) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml", "<greatDeluge>", "<" + tag + ">");
  files.replace("top.optimise.xml", "</greatDeluge>", "</" + tag.substr(0, tag.find(' ')) + ">");
  files.replace("top.optimise.xml", water_level, settings);
  return read(files);
}

std::string message_with_method(const std::string& tag, const std::string& settings) {
  try {
    static_cast<void>(with_method(tag, settings));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(GreatDeluge, HasTheThesissSettingsByDefault) {
  const Experiment experiment = read_with(water_level, "");
  const auto& deluge = std::get<GreatDelugeSettings>(experiment.method);
  EXPECT_EQ(deluge.water_level, 0.15);
  EXPECT_EQ(deluge.rain, 0.01);
  EXPECT_EQ(deluge.credits, 10U);
  EXPECT_EQ(deluge.retries, 200U);
  EXPECT_EQ(deluge.confidence, 20U);
  EXPECT_EQ(deluge.growth, GreatDelugeSettings::Growth::doubling) << "its step is 'increased by itself'";
  EXPECT_EQ(deluge.target, std::nullopt);
  EXPECT_EQ(method_name(experiment.method), "great-deluge");
}

TEST(GreatDeluge, TakesEverySetting) {
  const Experiment experiment = read_with(
      water_level,
      "<waterLevel>-0.5</waterLevel><rain>0.25</rain><credits>0</credits><retries>7</retries><confidence>3</confidence>"
      "<step>4</step><growth>Linear</growth><move>one</move><neighbour>uniform</neighbour><start>scenario</start>"
      "<firstMustPass>0</firstMustPass><reevaluations>2</reevaluations><chains>5</chains><target>1.9</target>");
  const auto& deluge = std::get<GreatDelugeSettings>(experiment.method);
  EXPECT_EQ(deluge.water_level, -0.5);
  EXPECT_EQ(deluge.rain, 0.25);
  EXPECT_EQ(deluge.credits, 0U);
  EXPECT_EQ(deluge.retries, 7U);
  EXPECT_EQ(deluge.confidence, 3U);
  EXPECT_EQ(deluge.step, 4U);
  EXPECT_EQ(deluge.growth, GreatDelugeSettings::Growth::linear);
  EXPECT_EQ(deluge.move, GreatDelugeSettings::Move::one);
  EXPECT_EQ(deluge.neighbour, GreatDelugeSettings::Neighbour::uniform);
  EXPECT_EQ(deluge.start, Start::scenario);
  EXPECT_FALSE(deluge.first_must_pass);
  EXPECT_EQ(deluge.reevaluations, 2U);
  EXPECT_EQ(deluge.chains, 5U);
  EXPECT_EQ(deluge.target, 1.9);
}

TEST(Genetic, TakesEverySettingAndSaysThatOneHasNoEffect) {
  const Experiment experiment =
      with_method("geneticAlgorithm",
                  "<popsize>12</popsize><pmut>0.8</pmut><pcross>0.2</pcross><nconvergence>9</nconvergence>"
                  "<pconvergence>0.95</pconvergence><flushfrequency>1</flushfrequency><gamode>2</gamode>");
  const auto& genetic = std::get<GeneticSettings>(experiment.method);
  EXPECT_EQ(genetic.population, 12U);
  EXPECT_EQ(genetic.mutation, 0.8);
  EXPECT_EQ(genetic.crossover, 0.2);
  EXPECT_EQ(genetic.generations_to_convergence, 9U);
  EXPECT_EQ(genetic.convergence, 0.95);
  EXPECT_EQ(genetic.mode, GeneticSettings::Mode::steady_state);
  EXPECT_EQ(method_name(experiment.method), "genetic");
  ASSERT_FALSE(experiment.scenario.remarks.empty());
  EXPECT_EQ(experiment.scenario.remarks.back(),
            "top.optimise.xml:4: <flushfrequency> has no effect: every evaluation is saved when it is known");
}

TEST(Genetic, RefusesWhatIsOutOfRange) {
  const std::string file = "top.optimise.xml:4: found ";
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<popsize>1</popsize>"),
            file + "'1' in <popsize>, expected a whole number from 2 to 10000");
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<pmut>1.1</pmut>"),
            file + "'1.1' in <pmut>, expected a number from 0 to 1");
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<pcross>-1</pcross>"),
            file + "'-1' in <pcross>, expected a number from 0 to 1");
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<nconvergence>0</nconvergence>"),
            file + "'0' in <nconvergence>, expected a whole number from 1 to 10000");
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<pconvergence>2</pconvergence>"),
            file + "'2' in <pconvergence>, expected a number from 0 to 1");
  EXPECT_EQ(message_with_method("geneticAlgorithm", "<gamode>3</gamode>"),
            file + "'3' in <gamode>, expected a whole number from 1 to 2");
}

TEST(Pagmo, SectionsNameItsAlgorithms) {
  const auto algorithm = [](const std::string& tag) {
    return std::get<PagmoSettings>(with_method(tag, "").method).algorithm;
  };
  EXPECT_EQ(algorithm("cmaEs"), "cmaes");
  EXPECT_EQ(algorithm("differentialEvolution"), "de");
  EXPECT_EQ(algorithm("nsga2"), "nsga2");
  EXPECT_EQ(algorithm("pagmo algorithm=\"sade\""), "sade");
  EXPECT_EQ(method_name(with_method("cmaEs", "").method), "cmaes");
}

TEST(Start, IsTheScenarioUnlessTheFileSaysOtherwise) {
  const auto start_of = [](const std::string& tag, const std::string& text) {
    return std::visit([](const auto& method) { return method.start; }, with_method(tag, text).method);
  };
  for (const std::string tag : {"geneticAlgorithm", "cmaEs", "pagmo algorithm=\"sade\""}) {
    EXPECT_EQ(start_of(tag, ""), Start::scenario) << tag;
    EXPECT_EQ(start_of(tag, "<start>random</start>"), Start::random) << tag;
  }
  EXPECT_EQ(start_of("greatDeluge", ""), Start::random) << "as in the thesis";
  EXPECT_EQ(start_of("greatDeluge", "<start>scenario</start>"), Start::scenario);
}

TEST(Confirmation, IsRead) {
  const Experiment plain = read_with("<reuse>1</reuse>", "");
  EXPECT_EQ(plain.confirmation.candidates, 5U);
  EXPECT_EQ(plain.confirmation.runs, 10U);
  const Experiment experiment = read_with("<reuse>1</reuse>", R"(<confirmation candidates="3" runs="0"/>)");
  EXPECT_EQ(experiment.confirmation.candidates, 3U);
  EXPECT_EQ(experiment.confirmation.runs, 0U);
}

TEST(Pagmo, TakesTheSettingsOfEachAlgorithm) {
  const auto cmaes = std::get<PagmoSettings>(
      with_method(
          "cmaEs",
          "<popsize>10</popsize><generations>7</generations><restartAfter>3</restartAfter><sigma0>0.25</sigma0>")
          .method);
  EXPECT_EQ(cmaes.population, 10U);
  EXPECT_EQ(cmaes.generations, 7U);
  EXPECT_EQ(cmaes.restart_after, 3U);
  EXPECT_EQ(cmaes.sigma0, 0.25);
  const auto de = std::get<PagmoSettings>(
      with_method("differentialEvolution", "<crossover>0.5</crossover><scale>0.75</scale>").method);
  EXPECT_EQ(de.crossover, 0.5);
  EXPECT_EQ(de.scale, 0.75);
  EXPECT_EQ(de.sigma0, std::nullopt);
  const auto sga = std::get<PagmoSettings>(
      with_method("pagmo algorithm=\"sga\"", "<crossover>0.5</crossover><mutation>0.125</mutation>").method);
  EXPECT_EQ(sga.mutation, 0.125);
}

TEST(Pagmo, RefusesTheSettingsOfOtherAlgorithmsAndWhatIsOutOfRange) {
  const std::string file = "top.optimise.xml:4: found ";
  EXPECT_EQ(message_with_method("cmaEs", "<mutation>0.1</mutation>"),
            file +
                "<mutation> in <properties>, expected <popsize>, <generations>, <restartAfter>, <start>, <sigma0>, "
                "<numOfParametersToOptimize>, <registeredParameters>");
  EXPECT_EQ(message_with_method("pagmo algorithm=\"sade\"", "<scale>0.1</scale>"),
            file +
                "<scale> in <properties>, expected <popsize>, <generations>, <restartAfter>, <start>, "
                "<numOfParametersToOptimize>, "
                "<registeredParameters>");
  EXPECT_EQ(message_with_method("nsga2", "<popsize>1</popsize>"),
            file + "'1' in <popsize>, expected a whole number from 2 to 10000");
  EXPECT_EQ(message_with_method("nsga2", "<generations>0</generations>"),
            file + "'0' in <generations>, expected a whole number from 1 to 1000000");
  EXPECT_EQ(message_with_method("cmaEs", "<sigma0>0</sigma0>"),
            file + "'0' in <sigma0>, expected a number from 1e-06 to 1");
  EXPECT_EQ(message_with_method("pagmo", ""),
            "top.optimise.xml:1: found no attribute 'algorithm' in <pagmo>, expected one");
}

Objective objective_of(const std::string& text) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml", objective, text);
  files.replace("top.optimise.xml", "<racing after=\"0.3\" keep=\"0.5\"/>", "");
  return read(files).objectives.at(0);
}

TEST(Fitness, IsTheDistanceWhereTheFileSaysNothing) {
  const Experiment experiment = read_with("<fitness heading=\"0\">\n    " + objective + "\n  </fitness>", "");
  ASSERT_EQ(experiment.objectives.size(), 1U);
  EXPECT_EQ(experiment.objectives[0].name, "distance");
  EXPECT_EQ(experiment.objectives[0].goal, Goal::maximise);
  ASSERT_EQ(experiment.objectives[0].terms.size(), 1U);
  EXPECT_EQ(experiment.objectives[0].terms[0].measure, sim::Measure::distance);
  EXPECT_EQ(experiment.heading_deg, 0.0);
}

TEST(Fitness, TakesTheNaturalGoalAndTheNameOfASingleMeasure) {
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    const bool needs_failed = declaration.higher_is_better && declaration.may_be_negative;
    const Objective single = objective_of("<objective measure=\"" + std::string(declaration.name) + "\"" +
                                          (needs_failed ? " failed=\"-9\"/>" : "/>"));
    EXPECT_EQ(single.name, declaration.name);
    EXPECT_EQ(single.goal, declaration.higher_is_better ? Goal::maximise : Goal::minimise) << declaration.name;
    EXPECT_EQ(single.failed, needs_failed ? -9.0 : declaration.higher_is_better ? 0.0 : 1e6) << declaration.name;
    ASSERT_EQ(single.terms.size(), 1U);
    EXPECT_EQ(single.terms[0].measure, declaration.measure);
  }
  EXPECT_EQ(objective_of("<objective failed=\"-9\"><term measure=\"slip\" weight=\"-2\"/></objective>").goal,
            Goal::maximise);
}

TEST(Fitness, TakesWhatAnObjectiveSays) {
  const Objective sum = objective_of(
      "<objective name=\"both\" goal=\"minimise\" failed=\"-3\"><term measure=\"slip\" weight=\"0.5\"/>"
      "<term measure=\"height\"/></objective>");
  EXPECT_EQ(sum.name, "both");
  EXPECT_EQ(sum.goal, Goal::minimise);
  EXPECT_EQ(sum.failed, -3.0);
  ASSERT_EQ(sum.terms.size(), 2U);
  EXPECT_EQ(sum.terms[0].weight, 0.5);
  EXPECT_EQ(sum.terms[1].weight, 1.0);
  const Objective plain =
      objective_of("<objective failed=\"-9\"><term measure=\"slip\"/><term measure=\"height\"/></objective>");
  EXPECT_EQ(plain.name, "score");
  EXPECT_EQ(plain.goal, Goal::maximise);
}

TEST(Fitness, TakesSeveralObjectivesInTheirOrderAndTheHeading) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml", objective,
                "<objective measure=\"speed\" failed=\"-1\"/><objective measure=\"cost_of_transport\"/>");
  files.replace("top.optimise.xml", "heading=\"0\"", "heading=\"-90\"");
  files.replace("top.optimise.xml", "<racing after=\"0.3\" keep=\"0.5\"/>", "");
  const Experiment experiment = read(files);
  ASSERT_EQ(experiment.objectives.size(), 2U);
  EXPECT_EQ(experiment.objectives[0].name, "speed");
  EXPECT_EQ(experiment.objectives[1].goal, Goal::minimise);
  EXPECT_EQ(experiment.heading_deg, -90.0);
}

TEST(Fitness, SaysWhetherAScoreMayBeNegative) {
  EXPECT_FALSE(objective_of("<objective measure=\"distance\"/>").may_be_negative());
  EXPECT_TRUE(objective_of("<objective measure=\"distance\" failed=\"-1\"/>").may_be_negative());
  EXPECT_TRUE(objective_of("<objective measure=\"speed\" failed=\"0\"/>").may_be_negative());
  EXPECT_TRUE(objective_of("<objective failed=\"0\"><term measure=\"distance\"/><term measure=\"mechanical_energy\" "
                           "weight=\"-1\"/></objective>")
                  .may_be_negative());
}

TEST(Score, IsTheWeightedSumOrThatOfAFailure) {
  const Objective sum = objective_of(
      "<objective failed=\"-7\"><term measure=\"distance\" weight=\"2\"/><term measure=\"slip\" weight=\"-0.5\"/>"
      "</objective>");
  sim::MeasureValues measures;
  EXPECT_EQ(sum.score(measures), -7.0) << "neither is defined";
  measures[sim::Measure::distance] = 1.5;
  EXPECT_EQ(sum.score(measures), -7.0) << "one is not defined";
  measures[sim::Measure::slip] = 0.25;
  EXPECT_EQ(sum.score(measures), 2.875);
  measures[sim::Measure::slip] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(sum.score(measures), -7.0);
}

TEST(Score, AsACostIsTheLowerTheBetter) {
  for (const Goal goal : {Goal::maximise, Goal::minimise}) {
    Objective single;
    single.goal = goal;
    EXPECT_NE(single.better(2.0, 1.0), single.better(1.0, 2.0));
    EXPECT_FALSE(single.better(1.0, 1.0));
    EXPECT_EQ(single.better(2.0, 1.0), single.cost(2.0) < single.cost(1.0));
    EXPECT_EQ(single.cost(single.cost(1.25)), 1.25);
  }
}

TEST(EvaluationSection, IsRead) {
  MemoryFiles files = small_experiment();
  const Experiment experiment = read(files);
  EXPECT_EQ(experiment.evaluations, 100U);
  EXPECT_EQ(experiment.seed, 5U);
  EXPECT_TRUE(experiment.reuse);
  EXPECT_EQ(experiment.trials.count, 2U);
  EXPECT_EQ(experiment.trials.random_numbers, RandomNumbers::common);
  EXPECT_EQ(read_with(R"(aggregate="mean")", R"(randomNumbers="fresh")").trials.random_numbers, RandomNumbers::fresh);
  EXPECT_EQ(experiment.trials.aggregate, Aggregate::mean);
  EXPECT_EQ(experiment.trials.spread.friction, 0.1);
  EXPECT_EQ(experiment.trials.spread.mass, 0.0);
  EXPECT_EQ(experiment.trials.spread.servo_gain, 0.0);
  EXPECT_EQ(experiment.trials.spread.latency_ms, 20.0);
  EXPECT_EQ(experiment.trials.spread.contact_noise, 0.0);
  EXPECT_EQ(experiment.racing.after, 0.3);
  EXPECT_EQ(experiment.racing.keep, 0.5);
}

TEST(EvaluationSection, TakesTheOtherSpreads) {
  const Experiment experiment = read_with("aggregate=\"mean\">",
                                          "aggregate=\"worst\"><mass>0.2</mass><servoGain>0.3</servoGain>"
                                          "<contactNoise>0.01</contactNoise>");
  EXPECT_EQ(experiment.trials.aggregate, Aggregate::worst);
  EXPECT_EQ(experiment.trials.spread.mass, 0.2);
  EXPECT_EQ(experiment.trials.spread.servo_gain, 0.3);
  EXPECT_EQ(experiment.trials.spread.contact_noise, 0.01);
}

TEST(EvaluationSection, MayBeLeftOut) {
  MemoryFiles files = small_experiment();
  std::string& text = files.texts["top.optimise.xml"];
  text.replace(text.find("<evaluation>"), std::string::npos, "</greatDeluge>");
  const Experiment experiment = read(files);
  EXPECT_EQ(experiment.evaluations, 0U);
  EXPECT_EQ(experiment.seed, 1U);
  EXPECT_TRUE(experiment.reuse);
  EXPECT_EQ(experiment.trials.count, 1U);
  EXPECT_FALSE(experiment.trials.spread.any());
  EXPECT_FALSE(experiment.racing.on());
}

TEST(EvaluationSection, AllowsRacingThatIsOffWithAnyFitness) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml", objective, "<objective measure=\"slip\"/>");
  files.replace("top.optimise.xml", "after=\"0.3\"", "after=\"0\"");
  EXPECT_EQ(message_of(files), "no error");
}

}  // namespace
}  // namespace proleg::optimize
