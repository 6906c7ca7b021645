// MAP-Elites on a made-up robot: the measures of its axes are values of the candidate, so a reader knows what the map
// must be.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fake_source.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

constexpr std::uint32_t values = 41;

Experiment with_map(const MapElitesSettings& settings, std::uint32_t cells = 10) {
  Experiment experiment = make_experiment({values, values, values, values}, settings);
  for (const char* name : {"first", "second"}) {
    experiment.axes.push_back({sim::Measure::height, 0.0, 40.0, cells});
    experiment.objectives.push_back({name, {Term{}}, Goal::maximise, -1e12});
  }
  return experiment;
}

/// The first two values are the place on the map; the score is best, 10, where the others are 7 and 33.
std::vector<double> rate(const Candidate& candidate) {
  const double miss = std::hypot(candidate[2] - 7.0, candidate[3] - 33.0);
  return {10.0 - 0.2 * miss, static_cast<double>(candidate[0]), static_cast<double>(candidate[1])};
}

GaitMap map_of(const Experiment& experiment, const FakeSource& source) {
  GaitMap map(experiment);
  for (std::size_t i = 0; i < source.scores.size(); ++i) {
    map.add(i, source.scores[i]);
  }
  return map;
}

TEST(MapElites, FillsTheMapAndFindsTheBestOfEachCell) {
  MapElitesSettings settings;
  settings.first = 100;
  settings.population = 50;
  settings.generations = 200;
  const Experiment experiment = with_map(settings);
  FakeSource source(rate);
  EXPECT_EQ(search(experiment, 0, source), "generations used up");
  EXPECT_EQ(source.asked.size(), 100U + 200U * 50U);
  const GaitMap map = map_of(experiment, source);
  EXPECT_EQ(map.coverage(), 1.0);
  for (const GaitMap::Elite& elite : map.elites()) {
    EXPECT_GT(elite.score, 9.7) << elite.cell;
  }
}

/// As many evaluations at random fill the map as well, but with worse candidates.
TEST(MapElites, IsBetterThanRandomSearch) {
  MapElitesSettings settings;
  settings.first = 100;
  settings.population = 50;
  settings.generations = 60;
  const Experiment experiment = with_map(settings);
  FakeSource source(rate);
  static_cast<void>(search(experiment, 0, source));
  MapElitesSettings at_random = settings;
  at_random.first = 3050;
  at_random.generations = 1;
  const Experiment random_experiment = with_map(at_random);
  FakeSource random_source(rate);
  static_cast<void>(search(random_experiment, 0, random_source));
  EXPECT_EQ(source.asked.size(), random_source.asked.size());
  const double full = 100 * 10.0;
  EXPECT_LT(full - map_of(experiment, source).qd_score(),
            0.1 * (full - map_of(random_experiment, random_source).qd_score()));
}

TEST(MapElites, AsksForTheSameWithAnyLookaheadAndPredictsAll) {
  MapElitesSettings settings;
  settings.first = 40;
  settings.population = 20;
  settings.generations = 5;
  const Experiment experiment = with_map(settings);
  FakeSource few(rate, 1);
  FakeSource many(rate, 100);
  static_cast<void>(search(experiment, 0, few));
  static_cast<void>(search(experiment, 0, many));
  EXPECT_EQ(few.asked, many.asked);
  EXPECT_EQ(many.count(FakeSource::Prediction::wrong), 0U);
  // The first ones of the first and the second generation: before, there was nothing to predict them from.
  EXPECT_LE(many.count(FakeSource::Prediction::none), 2U);
  FakeSource other(rate);
  static_cast<void>(search(experiment, 1, other));
  EXPECT_NE(other.asked, many.asked) << "another run";
}

TEST(MapElites, StartsAtTheScenarioOrAtRandomAndStaysInTheSpace) {
  MapElitesSettings settings;
  settings.first = 5;
  settings.population = 10;
  settings.generations = 30;
  settings.noise = 1.0;
  settings.line = 1.0;
  Experiment experiment = with_map(settings);
  experiment.space = make_space({values, 1, values, 2});  // one value, and two
  FakeSource source(rate);
  static_cast<void>(search(experiment, 0, source));
  for (const Candidate& candidate : source.asked) {
    for (std::size_t i = 0; i < candidate.size(); ++i) {
      ASSERT_LT(candidate[i], experiment.space.dimensions[i].values.size());
    }
  }
}

TEST(MapElites, VariesEveryCandidateThatItKeeps) {
  MapElitesSettings settings;
  settings.first = 1;
  settings.population = 200;
  settings.generations = 1;
  settings.noise = 0.0;
  settings.line = 0.0;
  const Experiment experiment = with_map(settings);
  FakeSource source(rate);
  static_cast<void>(search(experiment, 0, source));
  for (std::size_t i = 1; i < source.asked.size(); ++i) {
    int changed = 0;
    for (std::size_t k = 0; k < source.asked[i].size(); ++k) {
      changed += source.asked[i][k] != source.asked[0][k] ? 1 : 0;
    }
    EXPECT_EQ(changed, 1);
  }
}

TEST(MapElites, GoesOnAtRandomWhileNoRunSucceeds) {
  MapElitesSettings settings;
  settings.first = 10;
  settings.population = 10;
  settings.generations = 3;
  const Experiment experiment = with_map(settings);
  FakeSource source([](const Candidate&) { return std::vector<double>{0.0, -1e12, -1e12}; });
  static_cast<void>(search(experiment, 0, source));
  EXPECT_GT((std::set<Candidate>(source.asked.begin(), source.asked.end())).size(), 35U);
}

TEST(MapElites, EndsWithTheEvaluations) {
  const Experiment experiment = with_map({});
  FakeSource source(rate, 8, 1500);
  EXPECT_THROW(static_cast<void>(search(experiment, 0, source)), SearchEnded);
  EXPECT_EQ(source.asked.size(), 1500U);
}

}  // namespace
}  // namespace proleg::optimize
