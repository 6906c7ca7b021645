// What the great deluge asks for and foresees, candidate by candidate, held against the pseudo-code.

#include <gtest/gtest.h>

#include <algorithm>

#include "fake_source.hpp"
#include "sim/optimize/method/great_deluge.hpp"
#include "sim/optimize/method/method_seed.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

using Growth = GreatDelugeSettings::Growth;
using Move = GreatDelugeSettings::Move;
using Neighbour = GreatDelugeSettings::Neighbour;

FakeSource::Function rugged_score() {
  return [](const Candidate& candidate) { return std::vector<double>{rugged(candidate)}; };
}

/// The pseudo-code of the algorithm sheet, written down once more without foresight: what is asked for, in order.
std::vector<Candidate> plain_great_deluge(const Experiment& experiment, std::uint64_t seed,
                                          std::vector<Candidate> current, FakeSource& source) {
  const auto& settings = std::get<GreatDelugeSettings>(experiment.method);
  const double sign = experiment.objectives[0].goal == Goal::maximise ? 1.0 : -1.0;
  const auto evaluate = [&](const Candidate& candidate) { return sign * source.fitness(candidate)[0]; };
  struct State {
    double water;
    std::uint32_t used;
    std::uint32_t credits;
    std::uint64_t number;
    bool stopped;
  };
  std::vector<State> states(current.size(), State{sign * settings.water_level, 0, settings.credits, 0, false});
  std::vector<double> first(current.size());
  std::transform(current.begin(), current.end(), first.begin(), evaluate);
  for (std::size_t i = 0; i < current.size(); ++i) {
    if (first[i] >= states[i].water || !settings.first_must_pass) {
      states[i].water += settings.rain;
    }
    if (settings.target && first[i] >= sign * *settings.target) {
      return source.asked;
    }
  }
  for (;;) {
    bool all_stopped = true;
    for (std::uint32_t chain = 0; chain < current.size(); ++chain) {
      State& state = states[chain];
      if (state.stopped) {
        continue;
      }
      all_stopped = false;
      std::int64_t radius = settings.step;
      for (std::uint32_t i = 0; i < state.used / settings.confidence; ++i) {
        radius = settings.growth == Growth::linear ? radius + settings.step : radius * 2;
      }
      radius = std::min<std::int64_t>(radius, 0x7FFFFFFF);
      Pcg32 noise = candidate_noise(seed, chain, state.number++);
      Candidate candidate = current[chain];
      const std::size_t only =
          settings.move == Move::one ? noise.below(static_cast<std::uint32_t>(candidate.size())) : candidate.size();
      for (std::size_t i = 0; i < candidate.size(); ++i) {
        if (settings.move == Move::one && i != only) {
          continue;
        }
        std::int64_t index = candidate[i];
        if (settings.neighbour == Neighbour::three) {
          index += radius * (std::int64_t{noise.below(3)} - 1);
        } else if (settings.neighbour == Neighbour::sign) {
          index += noise.below(2) == 0 ? -radius : radius;
        } else {
          index += std::int64_t{noise.below(static_cast<std::uint32_t>(2 * radius + 1))} - radius;
        }
        const auto last = static_cast<std::int64_t>(experiment.space.dimensions[i].values.size()) - 1;
        candidate[i] = static_cast<std::uint32_t>(std::min(std::max(index, std::int64_t{0}), last));
      }
      double score = evaluate(candidate);
      if (score >= state.water && settings.reevaluations > 0) {
        for (std::uint32_t i = 0; i < settings.reevaluations; ++i) {
          score += evaluate(candidate);
        }
        score /= settings.reevaluations + 1.0;
      }
      if (score >= state.water) {
        current[chain] = candidate;
        state.water += settings.rain;
        state.used = 0;
      } else if (++state.used >= settings.retries) {
        if (state.credits == 0) {
          state.stopped = true;
        } else {
          --state.credits;
          state.used = 0;
        }
      }
      if (settings.target && score >= sign * *settings.target) {
        return source.asked;
      }
    }
    if (all_stopped) {
      return source.asked;
    }
  }
}

/// A sequence of the plain algorithm needs its starts: they are drawn as GreatDelugeStart says, and read off here.
void expect_plain_sequence(const Experiment& experiment, std::uint32_t run, const FakeSource::Function& function,
                           std::uint64_t budget) {
  const auto& settings = std::get<GreatDelugeSettings>(experiment.method);
  FakeSource source(function, 8, budget);
  try {
    static_cast<void>(search(experiment, run, source));
  } catch (const SearchEnded&) {
  }
  FakeSource plain_source(function, 0, budget);
  try {
    const std::vector<Candidate> starts(source.asked.begin(), source.asked.begin() + settings.chains);
    static_cast<void>(plain_great_deluge(experiment, method_seed(experiment.seed, run), starts, plain_source));
  } catch (const SearchEnded&) {
  }
  EXPECT_EQ(source.asked, plain_source.asked);
  if (!settings.target) {
    EXPECT_GT(source.asked.size(), 100U);
  }
}

TEST(GreatDelugeSequence, IsThatOfThePseudoCode) {
  const auto lowland = [](const Candidate& candidate) { return std::vector<double>{5.0 - rugged(candidate)}; };
  int combinations = 0;
  for (const Growth growth : {Growth::linear, Growth::doubling}) {
    for (const Move move : {Move::all, Move::one}) {
      for (const Neighbour neighbour : {Neighbour::three, Neighbour::sign, Neighbour::uniform}) {
        for (const std::uint32_t chains : {1U, 3U}) {
          GreatDelugeSettings settings;
          settings.growth = growth;
          settings.move = move;
          settings.neighbour = neighbour;
          settings.chains = chains;
          settings.credits = 2;
          settings.retries = 50;
          settings.confidence = 9;
          settings.step = 1 + chains;
          settings.water_level = 1.0;
          settings.reevaluations = chains - 1;
          settings.first_must_pass = move == Move::all;
          Experiment experiment = make_experiment({41, 7, 161, 2}, settings);
          experiment.seed = 17;
          expect_plain_sequence(experiment, 5, rugged_score(), 3000);

          settings.water_level = 4.0;
          settings.target = 2.0;
          Experiment down = make_experiment({41, 7, 161, 2}, settings, Goal::minimise);
          expect_plain_sequence(down, 0, lowland, 3000);
          ++combinations;
        }
      }
    }
  }
  EXPECT_EQ(combinations, 24);
}

TEST(GreatDelugeSequence, IsTheSameForEverySizeOfTheForesight) {
  for (const std::uint32_t chains : {1U, 4U}) {
    GreatDelugeSettings settings;
    settings.chains = chains;
    settings.reevaluations = chains - 1;
    const Experiment experiment = make_experiment({41, 41, 41}, settings);
    FakeSource first(rugged_score(), 0, 1500);
    EXPECT_THROW(static_cast<void>(search(experiment, 0, first)), SearchEnded);
    for (const std::size_t ahead : {1U, 2U, 7U, 64U}) {
      FakeSource other(rugged_score(), ahead, 1500);
      EXPECT_THROW(static_cast<void>(search(experiment, 0, other)), SearchEnded);
      EXPECT_EQ(other.asked, first.asked);
      EXPECT_EQ(other.needed, first.needed);
    }
  }
}

TEST(GreatDelugeSequence, DependsOnSeedAndRun) {
  const auto sequence = [](std::uint64_t seed, std::uint32_t run) {
    Experiment experiment = make_experiment({161, 161, 161}, GreatDelugeSettings{});
    experiment.seed = seed;
    FakeSource source(rugged_score(), 4, 50);
    EXPECT_THROW(static_cast<void>(search(experiment, run, source)), SearchEnded);
    return source.asked;
  };
  EXPECT_EQ(sequence(1, 0), sequence(1, 0));
  EXPECT_NE(sequence(1, 0), sequence(2, 0));
  EXPECT_NE(sequence(1, 0), sequence(1, 1));
  EXPECT_NE(sequence(1, 1), sequence(2, 0));
}

TEST(GreatDelugeForesight, ComesTrueWhileCandidatesFareAsThoseBeforeThem) {
  GreatDelugeSettings settings;
  settings.water_level = 0.2;  // so far below the start that nearly all are accepted at first, and nearly none at last
  const Experiment experiment = make_experiment({41, 41, 41, 41}, settings);
  FakeSource source(rugged_score(), 16, 20'000);
  EXPECT_EQ(search(experiment, 2, source), "no credit left");
  double water = 0.2;
  std::size_t accepted = 0;
  std::size_t alike = 0;  // latest outcomes that are the same
  bool last = false;
  std::size_t foreseen_in_a_row_of_acceptances = 0;
  for (std::size_t i = 0; i < source.asked.size(); ++i) {
    EXPECT_EQ(source.needed[i], water);
    if (i > 1 && alike > 8) {
      EXPECT_EQ(source.foresights[i], FakeSource::Foresight::right) << i;
      foreseen_in_a_row_of_acceptances += last ? 1U : 0U;
    }
    const bool is_accepted = source.scores[i][0] >= water;
    alike = is_accepted == last ? alike + 1 : 1;
    last = is_accepted;
    if (is_accepted) {
      water += settings.rain;
      ++accepted;
    }
  }
  EXPECT_GT(foreseen_in_a_row_of_acceptances, 20U);
  EXPECT_GT(source.count(FakeSource::Foresight::right), source.asked.size() - accepted);
}

TEST(GreatDelugeForesight, CountsReevaluationsAndTheRoundOfChainsIn) {
  GreatDelugeSettings settings;
  settings.chains = 3;
  settings.reevaluations = 2;
  settings.retries = 10;
  settings.credits = 1;
  // All candidates fail but one, in the middle of the search, which is confirmed: nothing but what follows the first
  // look at it is unforeseen.
  std::uint64_t evaluation = 0;
  FakeSource source([&](const Candidate&) {
    ++evaluation;
    return std::vector<double>{evaluation >= 20 && evaluation <= 22 ? 1.0 : 0.0};
  });
  EXPECT_EQ(search(make_experiment({161, 161}, settings), 0, source), "no credit left");
  ASSERT_EQ(source.asked.size(), 3U + 3U * 20U + 2U + (20U - 3U) / 3U + 1U);
  EXPECT_EQ(source.asked[19], source.asked[20]);
  EXPECT_EQ(source.asked[19], source.asked[21]);
  for (std::size_t i = 4; i < source.asked.size(); ++i) {
    if (i != 20) {
      EXPECT_EQ(source.foresights[i], FakeSource::Foresight::right) << i;
    }
  }
}

TEST(GreatDelugeForesight, RacesByTheLowestWaterOfTheChains) {
  GreatDelugeSettings settings;
  settings.chains = 2;
  settings.water_level = 1.0;
  const Experiment experiment = make_experiment({41, 41}, settings);
  FakeSource source(rugged_score(), 4, 400);
  EXPECT_THROW(static_cast<void>(search(experiment, 0, source)), SearchEnded);
  std::vector<double> water(2, 1.0);
  for (std::size_t i = 0; i < source.asked.size(); ++i) {
    if (i >= 2) {
      EXPECT_EQ(source.needed[i], std::min(water[0], water[1]));
    }
    if (source.scores[i][0] >= water[i % 2]) {
      water[i % 2] += settings.rain;
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
