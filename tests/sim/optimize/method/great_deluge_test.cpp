#include "sim/optimize/method/great_deluge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/problems/ackley.hpp>
#include <pagmo/problems/zdt.hpp>
#include <set>
#include <stdexcept>

#include "deluge_log.hpp"
#include "fake_source.hpp"
#include "landscape_problem.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

using Growth = GreatDelugeSettings::Growth;
using Move = GreatDelugeSettings::Move;
using Neighbour = GreatDelugeSettings::Neighbour;

FakeSource::Function constant(double score) {
  return [score](const Candidate&) { return std::vector<double>{score}; };
}

FakeSource::Function rugged_score() {
  return [](const Candidate& candidate) { return std::vector<double>{rugged(candidate)}; };
}

TEST(GreatDelugeSearch, ThatAcceptsNothingMakesRetriesTimesCreditsPlusOneEvaluationsAfterTheStart) {
  FakeSource source(constant(0.1));  // below the thesis's water level
  EXPECT_EQ(search(make_experiment({161, 161, 161, 161, 161}, GreatDelugeSettings{}), 0, source), "no credit left");
  EXPECT_EQ(source.asked.size(), 1U + 2200U);

  GreatDelugeSettings settings;
  settings.retries = 7;
  settings.credits = 0;
  FakeSource short_source(constant(0.1));
  EXPECT_EQ(search(make_experiment({161}, settings), 0, short_source), "no credit left");
  EXPECT_EQ(short_source.asked.size(), 1U + 7U);

  settings.chains = 3;
  settings.credits = 1;
  FakeSource source_of_three(constant(0.1));
  EXPECT_EQ(search(make_experiment({161}, settings), 0, source_of_three), "no credit left");
  EXPECT_EQ(source_of_three.asked.size(), 3U * (1U + 14U));
}

TEST(GreatDelugeSearch, UsesNoRetryAboveAllLevels) {
  int evaluations = 0;
  const auto log = log_of({},
                          Landscape{.level =
                                        [&](const auto&) {
                                          if (++evaluations > 1000) {
                                            throw SearchEnded{};
                                          }
                                          return 1e9;
                                        }},
                          {{80, 80, 80}});
  ASSERT_EQ(log.size(), 1000U);
  for (std::size_t i = 0; i < log.size(); ++i) {
    EXPECT_EQ(log[i].used, 0U);
    EXPECT_TRUE(log[i].accepted);
    EXPECT_EQ(log[i].credits, 10U);
    EXPECT_EQ(log[i].radius, i == 0 ? 0.0 : 1.0);
    EXPECT_NEAR(log[i].water, 0.15 + 0.01 * static_cast<double>(i), 1e-9);  // the water law
  }
}

TEST(GreatDelugeSearch, WidensByTheFirstRadiusAfterEveryConfidenceFailuresWithLinearGrowth) {
  GreatDelugeSettings settings;
  settings.growth = Growth::linear;
  settings.step = 3;
  settings.retries = 100;
  settings.credits = 2;
  const auto log = log_of(settings, Landscape{.level = [](const auto&) { return 0.0; }}, {{80, 80, 80}});
  ASSERT_EQ(log.size(), 1U + 300U);
  for (std::size_t i = 1; i < log.size(); ++i) {
    const std::size_t used = (i - 1) % 100;
    const std::size_t widenings = used / 20;
    EXPECT_EQ(log[i].used, used);
    EXPECT_EQ(log[i].radius, 3.0 * static_cast<double>(1 + widenings));
    EXPECT_EQ(log[i].credits, 2 - (i - 1) / 100);
    EXPECT_EQ(log[i].water, 0.15);
  }
}

TEST(GreatDelugeSearch, DoublesTheRadiusAfterEveryConfidenceFailures) {
  GreatDelugeSettings settings;
  settings.credits = 0;
  settings.retries = 2000;
  const auto log = log_of(settings, Landscape{.level = [](const auto&) { return 0.0; }}, {{80, 80, 80}});
  ASSERT_EQ(log.size(), 2001U);
  for (std::size_t i = 1; i < log.size(); ++i) {
    const std::size_t doublings = (i - 1) / 20;
    EXPECT_EQ(log[i].radius, std::min(std::exp2(static_cast<double>(doublings)), 2147483647.0)) << i;
  }
}

TEST(GreatDelugeSearch, ReturnsToTheFirstRadiusWhenItAccepts) {
  int evaluations = 0;
  const auto log = log_of({},
                          Landscape{.level =
                                        [&](const auto&) {
                                          ++evaluations;
                                          return evaluations % 50 == 0 ? 1.0 : 0.0;
                                        }},
                          {{80, 80, 80}});
  ASSERT_GT(log.size(), 200U);
  EXPECT_TRUE(log[49].accepted);
  EXPECT_EQ(log[49].used, 48U);
  EXPECT_EQ(log[49].radius, 4.0);
  EXPECT_EQ(log[50].used, 0U);
  EXPECT_EQ(log[50].radius, 1.0);
  EXPECT_EQ(log[50].water, 0.15 + 0.01);
}

TEST(GreatDelugeSearch, AcceptsAWorsePlaceIfItReachesTheWater) {
  int evaluations = 0;
  const auto log = log_of({},
                          Landscape{.level =
                                        [&](const auto&) {
                                          ++evaluations;
                                          return evaluations == 1 ? 1.0 : evaluations == 2 ? 0.5 : 0.0;
                                        }},
                          {{80, 80, 80}});
  EXPECT_TRUE(log[0].accepted);
  EXPECT_TRUE(log[1].accepted);
  EXPECT_FALSE(log[2].accepted);
}

TEST(GreatDelugeSearch, KeepsTheBestPlaceWhenItMovesOn) {
  Landscape landscape;
  landscape.level = [&, evaluations = 0](const auto&) mutable {
    ++evaluations;
    return evaluations == 1 ? 1.0 : evaluations == 2 ? 5.0 : evaluations == 3 ? 0.5 : 0.0;
  };
  pagmo::population population{pagmo::problem{LandscapeProblem{landscape}}, 0U, 1U};
  population.push_back({80, 80, 80});
  pagmo::algorithm algorithm{GreatDeluge{{}, 4}};
  algorithm.set_verbosity(1);
  const pagmo::population evolved = algorithm.evolve(population);
  EXPECT_EQ(evolved.champion_f(), std::vector<double>{-5.0});
  EXPECT_EQ(evolved.champion_x(), algorithm.extract<GreatDeluge>()->get_log()[1].place);
  EXPECT_EQ(evolved.get_f()[0], std::vector<double>{-5.0});
}

/// From the middle of a large box, so that nothing is cut: by how much candidates of the first radius differ from it.
std::vector<std::vector<double>> offsets(GreatDelugeSettings settings, std::uint64_t seed) {
  settings.retries = 3000;
  settings.confidence = 3000;
  settings.credits = 0;
  auto log = log_of(settings, Landscape{.level = [](const auto&) { return 0.0; }}, {{80, 80, 80}}, seed);
  std::vector<std::vector<double>> result;
  for (std::size_t i = 1; i < log.size(); ++i) {
    for (double& x : log[i].place) {
      x -= 80.0;
    }
    result.push_back(log[i].place);
  }
  return result;
}

/// How often each offset is drawn for a variable.
std::map<double, int> histogram(const std::vector<std::vector<double>>& drawn, std::size_t variable) {
  std::map<double, int> counts;
  for (const auto& offset : drawn) {
    ++counts[offset[variable]];
  }
  return counts;
}

TEST(GreatDelugeNeighbours, AreEvenlyDistributedOverTheSteps) {
  GreatDelugeSettings settings;
  settings.step = 4;
  const std::map<Neighbour, std::vector<double>> wanted = {{Neighbour::three, {-4, 0, 4}},
                                                           {Neighbour::sign, {-4, 4}},
                                                           {Neighbour::uniform, {-4, -3, -2, -1, 0, 1, 2, 3, 4}}};
  for (const auto& [neighbour, values] : wanted) {
    settings.neighbour = neighbour;
    const auto drawn = offsets(settings, 3);
    ASSERT_EQ(drawn.size(), 3000U);
    for (std::size_t variable = 0; variable < 3; ++variable) {
      const auto counts = histogram(drawn, variable);
      ASSERT_EQ(counts.size(), values.size());
      const double mean = 3000.0 / static_cast<double>(values.size());
      for (const double value : values) {
        ASSERT_TRUE(counts.contains(value)) << value;
        EXPECT_NEAR(counts.at(value), mean, 5.0 * std::sqrt(mean));
      }
    }
    // Variables are drawn independently: all combinations of two turn up.
    std::set<std::pair<double, double>> pairs;
    for (const auto& offset : drawn) {
      pairs.emplace(offset[0], offset[1]);
    }
    EXPECT_EQ(pairs.size(), values.size() * values.size());
  }
}

TEST(GreatDelugeNeighbours, DifferInOneParameterIfOneMoves) {
  GreatDelugeSettings settings;
  settings.move = Move::one;
  settings.neighbour = Neighbour::sign;
  std::vector<int> moved(3, 0);
  for (const auto& offset : offsets(settings, 5)) {
    int count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (offset[i] != 0.0) {
        EXPECT_EQ(std::abs(offset[i]), 1.0);
        ++moved[i];
        ++count;
      }
    }
    EXPECT_EQ(count, 1);
  }
  for (const int count : moved) {
    EXPECT_NEAR(count, 1000, 150);
  }
}

TEST(GreatDelugeNeighbours, AreCutToTheBounds) {
  GreatDelugeSettings settings;
  settings.step = 7;
  Landscape landscape{.lower = {-3.0, 0.0, 0.0}, .upper = {2.0, 0.0, 160.0}, .level = [](const auto&) { return 0.0; }};
  std::set<double> seen;
  for (const auto& line : log_of(settings, landscape, {{1.0, 0.0, 159.0}})) {
    seen.insert(line.place[0]);
    EXPECT_EQ(line.place[1], 0.0);
    EXPECT_LE(line.place[2], 160.0);
    EXPECT_GE(line.place[2], 0.0);
  }
  EXPECT_EQ(seen, (std::set<double>{-3.0, 1.0, 2.0}));
}

TEST(GreatDelugeStart, StaysTheCurrentPlaceIfItIsBelowTheWater) {
  const Landscape low{.level = [](const auto&) { return 0.1; }};
  const auto must_pass = log_of({}, low, {{80, 80, 80}});
  EXPECT_FALSE(must_pass[0].accepted);
  EXPECT_EQ(must_pass[1].water, 0.15);
  for (const double x : must_pass[1].place) {
    EXPECT_NEAR(x, 80.0, 1.0);
  }
  GreatDelugeSettings settings;
  settings.first_must_pass = false;
  const auto accepted = log_of(settings, low, {{80, 80, 80}});
  EXPECT_TRUE(accepted[0].accepted);
  EXPECT_EQ(accepted[1].water, 0.15 + 0.01);
}

TEST(GreatDelugeStart, IsDrawnEvenlyFromTheWholeSpace) {
  GreatDelugeSettings settings;
  settings.retries = 1;
  settings.credits = 0;
  std::vector<int> counts(5, 0);
  for (std::uint32_t run = 0; run < 1000; ++run) {
    FakeSource source(constant(0.0));
    static_cast<void>(search(make_experiment({5, 161}, settings), run, source));
    ++counts[source.asked[0][0]];
  }
  for (const int count : counts) {
    EXPECT_NEAR(count, 200, 60);
  }
}

TEST(GreatDelugeStart, CanBeTheScenario) {
  GreatDelugeSettings settings;
  settings.start = Start::scenario;
  settings.chains = 2;
  Experiment experiment = make_experiment({161, 161}, settings);
  for (const Dimension& dimension : experiment.space.dimensions) {
    Setting setting = dimension.targets[0];
    setting.value = 33 + setting.joint;
    experiment.scenario.settings.push_back(setting);
  }
  FakeSource source(constant(0.0));
  static_cast<void>(search(experiment, 0, source));
  EXPECT_EQ(source.asked[0], (Candidate{33, 34}));
  EXPECT_EQ(source.asked[1], (Candidate{33, 34}));
  EXPECT_NE(source.asked[2], source.asked[3]);  // chains draw different numbers
}

TEST(GreatDelugeReevaluation, DecidesByTheMean) {
  GreatDelugeSettings settings;
  settings.reevaluations = 2;
  settings.retries = 3;
  settings.credits = 0;
  // The start; a candidate that is good once; one that is good on average; one that fails at once.
  const std::vector<double> levels = {0.0, 0.3, 0.0, 0.0, 0.2, 0.1, 0.3, 0.0};
  std::size_t evaluation = 0;
  const auto log =
      log_of(settings,
             Landscape{.level = [&](const auto&) { return evaluation < levels.size() ? levels[evaluation++] : 0.0; }},
             {{80, 80, 80}});
  ASSERT_EQ(log.size(), 1U + 2U + 3U);
  EXPECT_NEAR(log[1].level, 0.1, 1e-15);
  EXPECT_FALSE(log[1].accepted);
  EXPECT_NEAR(log[2].level, 0.2, 1e-15);
  EXPECT_TRUE(log[2].accepted);
  EXPECT_EQ(log[3].level, 0.0);
  EXPECT_EQ(log[3].used, 0U);
}

TEST(GreatDelugeTarget, EndsTheSearchWhereverItIsReached) {
  GreatDelugeSettings settings;
  settings.target = 2.0;
  FakeSource source(rugged_score());
  EXPECT_EQ(search(make_experiment({41, 41, 41}, settings), 0, source), "target reached");
  for (std::size_t i = 0; i < source.scores.size(); ++i) {
    EXPECT_EQ(source.scores[i][0] >= 2.0, i + 1 == source.scores.size());
  }
  FakeSource from_the_start(constant(3.0));
  EXPECT_EQ(search(make_experiment({41}, settings), 0, from_the_start), "target reached");
  EXPECT_EQ(from_the_start.asked.size(), 1U);
}

TEST(GreatDeluge, WorksOnOtherProblemsOfPagmo) {
  GreatDelugeSettings settings;
  settings.water_level = -22.0;
  settings.rain = 0.1;
  settings.neighbour = Neighbour::uniform;
  settings.step = 5;
  pagmo::algorithm algorithm{GreatDeluge{settings, 3}};
  pagmo::population population{pagmo::problem{pagmo::ackley{4}}, 3U, 7U};
  const double before = population.champion_f()[0];
  population = algorithm.evolve(population);
  EXPECT_LT(population.champion_f()[0], before / 2.0);
  EXPECT_EQ(algorithm.extract<GreatDeluge>()->ending(), "no credit left");
  EXPECT_EQ(algorithm.get_name(), "modified great deluge");
  EXPECT_NE(algorithm.get_extra_info().find("retries: 200"), std::string::npos);
  EXPECT_TRUE(algorithm.has_set_seed());
  EXPECT_TRUE(algorithm.has_set_verbosity());
}

TEST(GreatDeluge, RefusesSeveralObjectivesAndBoundsAtInfinity) {
  const pagmo::algorithm algorithm{GreatDeluge{}};
  EXPECT_THROW(static_cast<void>(algorithm.evolve(pagmo::population{pagmo::problem{pagmo::zdt{1, 4}}, 2U, 1U})),
               std::invalid_argument);
  Landscape endless{.level = [](const auto&) { return 0.0; }};
  endless.upper[1] = std::numeric_limits<double>::infinity();
  pagmo::population population{pagmo::problem{LandscapeProblem{endless}}, 0U, 1U};
  population.push_back({0, 0, 0});
  EXPECT_THROW(static_cast<void>(algorithm.evolve(population)), std::invalid_argument);
}

}  // namespace
}  // namespace proleg::optimize
