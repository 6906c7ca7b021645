
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <set>

#include "fake_source.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

PagmoSettings settings_of(const std::string& name, std::uint32_t population, std::uint32_t generations) {
  PagmoSettings settings;
  settings.algorithm = name;
  settings.population = population;
  settings.generations = generations;
  return settings;
}

double best_of(const FakeSource& source) { return (*std::min_element(source.scores.begin(), source.scores.end()))[0]; }

TEST(PagmoSearch, FindsTheBottomOfABowl) {
  for (const char* name : {"cmaes", "de", "sade", "pso", "pso_gen", "gwo", "xnes", "gaco", "de1220", "bee_colony",
                           "compass_search", "simulated_annealing"}) {
    FakeSource source([](const Candidate& candidate) { return std::vector<double>{sphere(candidate, 29.0)}; });
    const Experiment experiment = make_experiment({41, 41, 41, 41, 41}, settings_of(name, 20, 100), Goal::minimise);
    const std::string ending = search(experiment, 0, source);
    // The far corner has 4205. Annealing is coarse.
    EXPECT_LE(best_of(source), std::string_view(name) == "simulated_annealing" ? 40.0 : 1.0) << name << ": " << ending;
  }
}

TEST(PagmoSearch, FindsACornerWhereTheBoundsCut) {
  // As in the thesis: all amplitudes at their largest, the tail at rest.
  const auto score = [](const Candidate& c) {
    return std::vector<double>{(c[0] + c[1] + c[2] + c[3]) / 640.0 - 0.3 * c[4] / 160.0};
  };
  for (const char* name : {"cmaes", "de", "sade", "pso"}) {
    FakeSource source(score);
    const Experiment experiment = make_experiment({161, 161, 161, 161, 161}, settings_of(name, 20, 300));
    static_cast<void>(search(experiment, 0, source));
    EXPECT_GT((*std::max_element(source.scores.begin(), source.scores.end()))[0], 0.99) << name;
  }
}

TEST(PagmoSearch, EndsWithItsGenerationsOrWhenItsCandidatesNoLongerMove) {
  const auto bowl = [](const Candidate& candidate) { return std::vector<double>{sphere(candidate, 29.0)}; };
  FakeSource three(bowl);
  EXPECT_EQ(search(make_experiment({41, 41}, settings_of("de", 10, 3), Goal::minimise), 0, three),
            "generations used up");
  EXPECT_EQ(three.asked.size(), 40U);
  for (const char* name : {"cmaes", "de", "sade", "xnes"}) {
    FakeSource source(bowl);
    EXPECT_EQ(search(make_experiment({41, 41, 41}, settings_of(name, 20, 5000), Goal::minimise), 0, source),
              "converged")
        << name;
    EXPECT_EQ(best_of(source), 0.0);
    // The last generation was about one place, and the search did not wait for its end.
    const std::set<Candidate> last(source.asked.end() - 20, source.asked.end());
    EXPECT_LE(last.size(), 12U);
  }
}

/// A wide summit of 0.8 in one corner and a narrow one of 1 in the middle.
double two_summits(const Candidate& candidate) {
  const auto summit = [&](double place, double width) {
    double squares = 0.0;
    for (const std::uint32_t index : candidate) {
      squares += (index - place) * (index - place);
    }
    return std::exp(-squares / (width * width));
  };
  return std::max(0.8 * summit(160.0, 120.0), summit(60.0, 50.0));
}

TEST(PagmoSearch, RestartsFromAnotherPopulationAndFindsTheOtherSummit) {
  PagmoSettings settings = settings_of("cmaes", 12, 120);
  std::size_t without = 0;
  std::size_t with = 0;
  for (std::uint32_t run = 0; run < 10; ++run) {
    for (const std::uint32_t restart_after : {0U, 5U}) {
      settings.restart_after = restart_after;
      FakeSource source([](const Candidate& candidate) { return std::vector<double>{two_summits(candidate)}; });
      const std::string ending = search(make_experiment({161, 161, 161}, settings), run, source);
      const bool found = (*std::max_element(source.scores.begin(), source.scores.end()))[0] > 0.99;
      (restart_after == 0 ? without : with) += found ? 1U : 0U;
      if (restart_after > 0) {
        EXPECT_EQ(ending, "generations used up");
        EXPECT_GE(source.asked.size(), 12U * 121U) << "and each start has a first population besides";
      }
    }
  }
  std::printf("the higher summit was found in %zu of 10 searches, with restarts in %zu\n", without, with);
  EXPECT_LT(without, 8U) << "or there is nothing to gain";
  EXPECT_GE(with, without + 2);
}

TEST(PagmoSearch, WithRestartsEndsEvenIfNothingIsGained) {
  for (const PagmoAlgorithm& each : pagmo_algorithms()) {
    const std::size_t objectives = each.declaration().objectives == ObjectiveCount::several ? 2 : 1;
    PagmoSettings settings = settings_of(std::string(each.name), 12, 9);
    settings.restart_after = 2;
    FakeSource source([objectives](const Candidate&) { return std::vector<double>(objectives, 1.0); });
    EXPECT_NE(search(make_experiment({41, 41}, settings, Goal::maximise, objectives), 0, source), "") << each.name;
  }
}

TEST(PagmoSearch, RestartsOnAPlateauAlsoIfItsScoreIsZero) {
  for (const double plateau : {1.0, 0.0, -1.0}) {
    PagmoSettings settings = settings_of("de", 12, 40);
    settings.restart_after = 3;
    FakeSource source([plateau](const Candidate&) { return std::vector<double>{plateau}; });
    static_cast<void>(search(make_experiment({161, 161, 161}, settings), 0, source));
    // 40 generations in starts of 3 generations, each with a first population.
    EXPECT_EQ(source.asked.size(), 12U * (40U + 14U)) << "at " << plateau;
    ASSERT_EQ(source.restarts.size(), 13U) << "at " << plateau;
    for (std::size_t i = 0; i < source.restarts.size(); ++i) {
      EXPECT_EQ(source.restarts[i], 12U * 4U * (i + 1));
    }
  }
}

TEST(PagmoSearch, ContinuesWhereAllScoresAreEqual) {
  for (const char* name : {"cmaes", "de", "nsga2", "gaco", "maco"}) {
    const bool several = std::string_view(name) == "nsga2" || std::string_view(name) == "maco";
    FakeSource source([several](const Candidate&) { return std::vector<double>(several ? 2 : 1, 1.0); });
    static_cast<void>(search(
        make_experiment({161, 161, 161}, settings_of(name, 20, 10), Goal::maximise, several ? 2 : 1), 0, source));
    EXPECT_GE(source.asked.size(), 100U) << name;
  }
}

/// A problem of pagmo without predictions, which records its requests.
struct PlainProblem {
  std::vector<Candidate>* asked = nullptr;
  std::vector<double>::size_type objectives = 1;

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>& x) const {
    Candidate candidate;
    for (const double index : x) {
      candidate.push_back(static_cast<std::uint32_t>(std::lround(std::clamp(index, 0.0, 40.0))));
    }
    asked->push_back(candidate);
    std::vector<double> costs = {3.0 - rugged(candidate), sphere(candidate, 3.0)};
    costs.resize(objectives);
    return costs;
  }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {{0, 0, 0}, {40, 40, 40}};
  }
  [[nodiscard]] std::vector<double>::size_type get_nobj() const { return objectives; }
};

TEST(PagmoSearch, AsksWhatPagmoAsksWithoutPredictions) {
  for (const PagmoAlgorithm& each : pagmo_algorithms()) {
    const std::size_t objectives = each.declaration().objectives == ObjectiveCount::several ? 2 : 1;
    const PagmoSettings settings = settings_of(std::string(each.name), 12, 6);
    Experiment experiment = make_experiment({41, 41, 41}, settings, Goal::minimise, objectives);
    experiment.seed = 5;
    FakeSource source([objectives](const Candidate& candidate) {
      std::vector<double> scores = {3.0 - rugged(candidate), sphere(candidate, 3.0)};
      scores.resize(objectives);
      return scores;
    });
    static_cast<void>(search(experiment, 2, source));

    std::vector<Candidate> asked;
    const std::uint64_t seed = method_seed(5, 2);
    pagmo::population population{pagmo::problem{PlainProblem{&asked, objectives}}, 12U, static_cast<unsigned>(seed)};
    double min = 1e9;
    double max = -1e9;
    for (const auto& costs : population.get_f()) {
      min = std::min(min, costs[0]);
      max = std::max(max, costs[0]);
    }
    const pagmo::algorithm algorithm = each.make({.settings = settings,
                                                  .seed = static_cast<unsigned>(seed >> 32U),
                                                  .variables = 3,
                                                  .max_index = 40.0,
                                                  .cost_spread = max - min,
                                                  .objectives = objectives});
    for (int generation = 0; generation < (each.evolves_by_generation ? 6 : 1); ++generation) {
      population = algorithm.evolve(population);
    }
    EXPECT_EQ(source.asked, asked) << each.name;
    EXPECT_GE(asked.size(), 40U) << each.name;
  }
}

TEST(PagmoRacing, UsesTheBestScoreBeforeTheGeneration) {
  for (const Goal goal : {Goal::maximise, Goal::minimise}) {
    for (const char* name : {"cmaes", "pso"}) {
      FakeSource source([](const Candidate& candidate) { return std::vector<double>{rugged(candidate)}; });
      static_cast<void>(search(make_experiment({161, 161, 161}, settings_of(name, 10, 20), goal), 0, source));
      std::optional<double> best;
      std::optional<double> before;
      for (std::size_t i = 0; i < source.asked.size(); ++i) {
        if (i % 10 == 0) {
          before = best;
        }
        EXPECT_EQ(source.needed[i], before);
        const double score = source.scores[i][0];
        best = !best ? score : goal == Goal::maximise ? std::max(*best, score) : std::min(*best, score);
      }
    }
  }
}

TEST(PagmoFront, OfTwoBowlsIsFound) {
  // K. Deb's reading of Schaffer's first problem, on a grid: (x - 10)^2 against (x - 30)^2, the rest far from its best.
  // No x from 10 to 30 is dominated; all others are.
  for (const char* name : {"nsga2", "moead", "nspso"}) {
    FakeSource source([](const Candidate& c) {
      const double x = c[0];
      const double other = c[1];
      return std::vector<double>{(x - 10) * (x - 10) + other, (x - 30) * (x - 30) + other};
    });
    const Experiment experiment = make_experiment({61, 61}, settings_of(name, 40, 60), Goal::minimise, 2);
    EXPECT_EQ(search(experiment, 0, source), "generations used up");
    std::set<std::uint32_t> found;
    std::size_t late_on_front = 0;
    for (std::size_t i = 0; i < source.asked.size(); ++i) {
      const Candidate& c = source.asked[i];
      const bool on_front = c[0] >= 10 && c[0] <= 30 && c[1] == 0;
      if (on_front) {
        found.insert(c[0]);
      }
      late_on_front += on_front && i >= source.asked.size() - 400 ? 1U : 0U;
    }
    EXPECT_GE(found.size(), 18U) << name << " of 21";
    EXPECT_GE(late_on_front, 150U) << name << " of 400";
  }
}

}  // namespace
}  // namespace proleg::optimize
