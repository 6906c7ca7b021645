#include "sim/optimize/method/genetic.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "fake_source.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

using Mode = GeneticSettings::Mode;

FakeSource::Function rugged_score() {
  return [](const Candidate& candidate) { return std::vector<double>{rugged(candidate)}; };
}

FakeSource::Function constant(double score) {
  return [score](const Candidate&) { return std::vector<double>{score}; };
}

/// What a source was asked for in each generation: it receives one prediction for each.
std::vector<std::vector<Candidate>> generations(const FakeSource& source) {
  std::vector<std::vector<Candidate>> result;
  for (const auto& expectation : source.expectations) {
    result.push_back(expectation.second);
  }
  return result;
}

/// Two generations, the second without selection pressure: its children as they were made.
struct Offspring {
  std::vector<Candidate> parents;
  std::vector<Candidate> children;  ///< without those that equal a parent
};

Offspring breed(GeneticSettings settings, const std::vector<std::uint32_t>& sizes) {
  settings.generations_to_convergence = 2;
  FakeSource source(constant(1.0));
  EXPECT_EQ(search(make_experiment(sizes, settings), 0, source), "converged");
  const auto asked = generations(source);
  EXPECT_EQ(asked.size(), 2U);
  return {asked.at(0), asked.at(1)};
}

std::size_t equal_genes(const Candidate& a, const Candidate& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    count += a[i] == b[i] ? 1U : 0U;
  }
  return count;
}

/// Genes of a child that its most similar parent does not have.
double mean_changed_genes(const Offspring& offspring) {
  std::map<std::pair<std::size_t, std::uint32_t>, std::vector<std::size_t>> parents_with;  // by place and value
  for (std::size_t parent = 0; parent < offspring.parents.size(); ++parent) {
    for (std::size_t i = 0; i < offspring.parents[parent].size(); ++i) {
      parents_with[{i, offspring.parents[parent][i]}].push_back(parent);
    }
  }
  double changed = 0.0;
  for (const Candidate& child : offspring.children) {
    std::map<std::size_t, std::size_t> counts;  // equal genes by parent
    std::size_t most = 0;
    for (std::size_t i = 0; i < child.size(); ++i) {
      for (const std::size_t parent : parents_with[{i, child[i]}]) {
        most = std::max(most, ++counts[parent]);
      }
    }
    changed += static_cast<double>(child.size() - most);
  }
  return changed / static_cast<double>(offspring.children.size());
}

TEST(GeneticConvergence, IsTheQuotientOfBestsOfNGenerations) {
  // The oracle: M. Wall's definition, applied to the best scores. With elitism the best of a generation is the best so
  // far.
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    for (const std::uint32_t n : {1U, 2U, 5U, 20U}) {
      for (const double limit : {0.7, 0.99, 1.0}) {
        GeneticSettings settings;
        settings.mode = mode;
        settings.generations_to_convergence = n;
        settings.convergence = limit;
        FakeSource source(rugged_score());
        EXPECT_EQ(search(make_experiment({41, 41, 41, 41, 41}, settings), n, source), "converged");
        std::vector<double> bests;
        double best = 0.0;
        for (std::size_t g = 0; g < source.expectations.size(); ++g) {
          const std::uint64_t from = source.expectations[g].first;
          for (std::uint64_t i = from; i < from + source.expectations[g].second.size(); ++i) {
            best = std::max(best, source.scores[i][0]);
          }
          bests.push_back(best);
          const bool converged = g + 1 >= n && static_cast<float>(bests[g + 1 - n]) / static_cast<float>(bests[g]) >=
                                                   static_cast<float>(limit);
          EXPECT_EQ(converged, g + 1 == source.expectations.size()) << g << " of " << source.expectations.size();
        }
      }
    }
  }
}

TEST(GeneticConvergence, OfMinimisingIsTheInverseQuotient) {
  GeneticSettings settings;
  settings.generations_to_convergence = 10;
  settings.convergence = 0.9;
  FakeSource source([](const Candidate& candidate) { return std::vector<double>{1.0 + sphere(candidate, 20.0)}; });
  EXPECT_EQ(search(make_experiment({41, 41, 41}, settings, Goal::minimise), 0, source), "converged");
  std::vector<double> bests;
  double best = 1e9;
  for (const auto& [from, batch] : source.expectations) {
    for (std::uint64_t i = from; i < from + batch.size(); ++i) {
      best = std::min(best, source.scores[i][0]);
    }
    bests.push_back(best);
    const bool converged = bests.size() >= 10 && bests.back() / bests[bests.size() - 10] >= 0.9;
    EXPECT_EQ(converged, bests.size() == source.expectations.size());
  }
  EXPECT_LT(best, 40.0);
}

TEST(GeneticConvergence, WithScoresOfZeroOnlyComesAfterNGenerations) {
  for (const Goal goal : {Goal::maximise, Goal::minimise}) {
    GeneticSettings settings;
    settings.generations_to_convergence = 7;
    FakeSource source(constant(0.0));
    EXPECT_EQ(search(make_experiment({41, 41}, settings, goal), 0, source), "converged");
    EXPECT_EQ(source.expectations.size(), 7U);
  }
}

TEST(GeneticMutation, OfOneOrMoreGenesRedrawsThatManyPlacesWithReplacement) {
  // Of length l, r draws with replacement touch l * (1 - (1 - 1/l)^r) genes; r = ceil(mutation * l).
  struct Case {
    double mutation;
    std::size_t length;
    double draws;
  };
  for (const Case& wanted : {Case{0.8, 5, 4}, Case{1.0, 10, 10}, Case{0.5, 12, 6}, Case{0.25, 5, 2}, Case{0.2, 5, 1}}) {
    GeneticSettings settings;
    settings.population = 1200;
    settings.mutation = wanted.mutation;
    settings.crossover = 0.0;
    const Offspring offspring = breed(settings, std::vector<std::uint32_t>(wanted.length, 5000));
    EXPECT_GE(offspring.children.size(), 1190U);  // all but those whose gene was drawn with the same value
    const auto length = static_cast<double>(wanted.length);
    const double touched = length * (1.0 - std::pow(1.0 - 1.0 / length, wanted.draws));
    EXPECT_NEAR(mean_changed_genes(offspring), touched, 0.12) << wanted.mutation;
  }
}

TEST(GeneticMutation, OfLessThanOneGeneTossesForEachGene) {
  GeneticSettings settings;
  settings.population = 1500;
  settings.mutation = 0.1;
  settings.crossover = 0.0;
  const Offspring offspring = breed(settings, std::vector<std::uint32_t>(5, 5000));
  // A child without a new gene is not evaluated again.
  const double touched = 1.0 - std::pow(0.9, 5);
  EXPECT_NEAR(static_cast<double>(offspring.children.size()), 1500.0 * touched, 5.0 * std::sqrt(1500.0 * 0.25));
  EXPECT_NEAR(mean_changed_genes(offspring), 0.5 / touched, 0.09);
}

TEST(GeneticCrossover, TakesEachGeneFromEitherParent) {
  GeneticSettings settings;
  settings.population = 1000;
  settings.mutation = 0.0;
  settings.crossover = 1.0;
  const Offspring offspring = breed(settings, std::vector<std::uint32_t>(10, 16'000));
  EXPECT_GE(offspring.children.size(), 950U);
  double switches = 0.0;
  std::size_t counted = 0;
  for (const Candidate& child : offspring.children) {
    std::vector<std::size_t> from;
    for (std::size_t i = 0; i < child.size(); ++i) {
      for (std::size_t parent = 0; parent < offspring.parents.size(); ++parent) {
        if (offspring.parents[parent][i] == child[i] &&
            (from.size() == i || equal_genes(offspring.parents[parent], child) > 2)) {
          from.resize(i);
          from.push_back(parent);
        }
      }
    }
    ASSERT_EQ(from.size(), child.size()) << "a gene of no parent";
    if (std::set(from.begin(), from.end()).size() != 2) {
      continue;  // by chance two parents have the same gene
    }
    for (std::size_t i = 1; i < from.size(); ++i) {
      switches += from[i] != from[i - 1] ? 1.0 : 0.0;
    }
    ++counted;
  }
  EXPECT_GT(counted, 900U);
  // Nine borders between genes, half of them between genes of different parents. (At most 1 if it was by one point.)
  EXPECT_NEAR(switches / static_cast<double>(counted), 4.5, 0.2);
}

TEST(GeneticCrossover, HappensWithItsProbability) {
  GeneticSettings settings;
  settings.population = 2000;
  settings.mutation = 0.0;
  settings.crossover = 0.2;
  const Offspring offspring = breed(settings, std::vector<std::uint32_t>(8, 5000));
  EXPECT_NEAR(static_cast<double>(offspring.children.size()), 400.0, 130.0);  // pairs: twice the variance
}

TEST(GeneticGenes, AreDrawnEvenlyFromTheirSetsOnly) {
  GeneticSettings settings;
  settings.population = 2000;
  settings.mutation = 1.0;
  const std::vector<std::uint32_t> sizes = {1, 2, 3, 161};
  const Offspring offspring = breed(settings, sizes);
  ASSERT_EQ(offspring.parents.size(), 2000U);
  for (const auto& candidates : {offspring.parents, offspring.children}) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      std::map<std::uint32_t, double> counts;
      for (const Candidate& candidate : candidates) {
        ASSERT_LT(candidate[i], sizes[i]);
        ++counts[candidate[i]];
      }
      const double mean = static_cast<double>(candidates.size()) / sizes[i];
      for (std::uint32_t value = 0; value < sizes[i]; ++value) {
        EXPECT_NEAR(counts[value], mean, 5.0 * std::sqrt(mean) + 1.0) << i;
      }
    }
  }
}

TEST(GeneticSequence, DependsOnSeedAndRunOnly) {
  const auto sequence = [](std::uint64_t seed, std::uint32_t run, std::size_t ahead, Mode mode) {
    GeneticSettings settings;
    settings.mode = mode;
    Experiment experiment = make_experiment({161, 161, 161}, settings);
    experiment.seed = seed;
    FakeSource source(rugged_score(), ahead, 500);
    try {
      static_cast<void>(search(experiment, run, source));
    } catch (const SearchEnded&) {
    }
    return source.asked;
  };
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    const auto first = sequence(1, 0, 1, mode);
    EXPECT_EQ(first, sequence(1, 0, 64, mode));
    EXPECT_NE(first, sequence(2, 0, 1, mode));
    EXPECT_NE(first, sequence(1, 1, 1, mode));
  }
  EXPECT_NE(sequence(1, 0, 1, Mode::simple), sequence(1, 0, 1, Mode::steady_state));
}

TEST(GeneticPrediction, IsTheWholeGenerationAndRight) {
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    GeneticSettings settings;
    settings.mode = mode;
    settings.mutation = 0.8;
    settings.crossover = 0.2;
    FakeSource source(rugged_score());
    EXPECT_EQ(search(make_experiment({161, 161, 161, 161, 161}, settings), 0, source), "converged");
    const std::size_t count = source.expectations.size();
    EXPECT_GE(count, 50U);
    EXPECT_EQ(source.count(FakeSource::Prediction::wrong), 0U);
    EXPECT_EQ(source.count(FakeSource::Prediction::none), count);
    // Half of a steady state is new in each generation.
    const std::size_t half = mode == Mode::simple ? 30 : 15;
    EXPECT_NEAR(static_cast<double>(source.asked.size()) / static_cast<double>(count), static_cast<double>(half), 1.0);
  }
}

TEST(GeneticRacing, UsesTheBestScoreBeforeTheGeneration) {
  FakeSource source(rugged_score());
  static_cast<void>(search(make_experiment({161, 161, 161}, GeneticSettings{}), 0, source));
  std::optional<double> best;
  for (const auto& [from, batch] : source.expectations) {
    const std::optional<double> before = best;
    for (std::uint64_t i = from; i < from + batch.size(); ++i) {
      EXPECT_EQ(source.needed[i], before);
      best = std::max(best.value_or(0.0), source.scores[i][0]);
    }
  }
}

TEST(GeneticSearch, EndsWhenItsSourceDoesAtAnyEvaluation) {
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    GeneticSettings settings;
    settings.mode = mode;
    settings.population = 10;
    for (std::uint64_t budget = 0; budget < 40; ++budget) {
      FakeSource source(rugged_score(), 4, budget);
      EXPECT_THROW(static_cast<void>(search(make_experiment({41, 41}, settings), 0, source)), SearchEnded);
      EXPECT_EQ(source.asked.size(), budget);
    }
  }
  FakeSource broken([](const Candidate&) -> std::vector<double> { throw std::runtime_error("no worker is left"); });
  EXPECT_THROW(static_cast<void>(search(make_experiment({41, 41}, GeneticSettings{}), 0, broken)), std::runtime_error);
}

/// Mean of the scores that were asked for in one generation.
double mean_score(const FakeSource& source, const std::pair<std::uint64_t, std::vector<Candidate>>& generation) {
  double sum = 0.0;
  for (std::uint64_t i = generation.first; i < generation.first + generation.second.size(); ++i) {
    sum += source.scores[i][0];
  }
  return sum / static_cast<double>(generation.second.size());
}

/// An experiment whose objective may be negative.
Experiment signed_experiment(const std::vector<std::uint32_t>& sizes, const GeneticSettings& settings,
                             Goal goal = Goal::maximise) {
  Experiment experiment = make_experiment(sizes, settings, goal);
  experiment.objectives.front().terms.front().measure = sim::Measure::speed;
  return experiment;
}

TEST(GeneticSearch, ClimbsFromScoresBelowZeroToScoresAbove) {
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    GeneticSettings settings;
    settings.mode = mode;
    settings.mutation = 0.05;
    testing::internal::CaptureStderr();
    FakeSource source([](const Candidate& candidate) { return std::vector<double>{rugged(candidate) - 2.5}; });
    EXPECT_EQ(search(signed_experiment({41, 41, 41}, settings), 0, source), "converged");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "GAlib prints no warnings";
    ASSERT_GE(source.expectations.size(), 2U);
    const auto best_until = [&](std::size_t count) {
      return (*std::max_element(source.scores.begin(), source.scores.begin() + static_cast<std::ptrdiff_t>(count)))[0];
    };
    EXPECT_LT(mean_score(source, source.expectations.front()), 0.0) << "most of the first generation is below 0";
    EXPECT_GT(best_until(source.scores.size()), best_until(settings.population) + 0.2);
    EXPECT_GT(mean_score(source, source.expectations.back()), mean_score(source, source.expectations.front()) + 0.5);
  }
}

TEST(GeneticSearch, ClimbsWhereAllScoresAreBelowZero) {
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    for (const Goal goal : {Goal::maximise, Goal::minimise}) {
      GeneticSettings settings;
      settings.mode = mode;
      settings.mutation = 0.05;
      const double sign = goal == Goal::maximise ? 1.0 : -1.0;
      testing::internal::CaptureStderr();
      FakeSource source(
          [sign](const Candidate& candidate) { return std::vector<double>{sign * rugged(candidate) - 10.0}; });
      EXPECT_EQ(search(signed_experiment({41, 41, 41}, settings, goal), 0, source), "converged");
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
      EXPECT_GT(sign * mean_score(source, source.expectations.back()),
                sign * mean_score(source, source.expectations.front()) + 0.5);
    }
  }
}

TEST(GeneticConvergence, OfScoresBelowZeroComesAfterNGenerationsWithoutAGain) {
  GeneticSettings settings;
  settings.generations_to_convergence = 12;
  FakeSource flat(constant(-3.0));
  EXPECT_EQ(search(signed_experiment({41, 41, 41}, settings), 0, flat), "converged");
  EXPECT_EQ(flat.expectations.size(), 12U);
  // Each generation gains 27 of at most 1000, so 11 generations gain more than a hundredth.
  int evaluations = 0;
  FakeSource rising([&](const Candidate&) { return std::vector<double>{-1000.0 + 0.9 * ++evaluations}; }, 8, 900);
  EXPECT_THROW(static_cast<void>(search(signed_experiment({41, 41, 41}, settings), 0, rising)), SearchEnded);
}

TEST(GeneticSearch, MaximisesAndMinimises) {
  GeneticSettings settings;
  settings.mutation = 0.05;
  for (const Mode mode : {Mode::simple, Mode::steady_state}) {
    settings.mode = mode;
    FakeSource up([](const Candidate& candidate) {
      return std::vector<double>{std::accumulate(candidate.begin(), candidate.end(), 0.0)};
    });
    static_cast<void>(search(make_experiment(std::vector<std::uint32_t>(5, 41), settings), 0, up));
    EXPECT_GT((*std::max_element(up.scores.begin(), up.scores.end()))[0], 180.0);
    FakeSource down([](const Candidate& candidate) {
      return std::vector<double>{std::accumulate(candidate.begin(), candidate.end(), 0.0)};
    });
    static_cast<void>(search(make_experiment(std::vector<std::uint32_t>(5, 41), settings, Goal::minimise), 0, down));
    EXPECT_LT((*std::min_element(down.scores.begin(), down.scores.end()))[0], 20.0);
  }
}

}  // namespace
}  // namespace proleg::optimize
