// What the great deluge asks for and predicts, candidate by candidate. Oracles: numbers that another program computed,
// a trace worked out by hand, and the rules of the thesis (section 3.4.2).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "deluge_log.hpp"
#include "fake_source.hpp"
#include "sim/optimize/method/search.hpp"

namespace proleg::optimize {
namespace {

using Growth = GreatDelugeSettings::Growth;
using Move = GreatDelugeSettings::Move;
using Neighbour = GreatDelugeSettings::Neighbour;

FakeSource::Function rugged_score() {
  return [](const Candidate& candidate) { return std::vector<double>{rugged(candidate)}; };
}

/// Coordinates of places, one after the other.
using Places = std::vector<std::vector<double>>;

TEST(GreatDelugeCandidates, AreThoseThatAnotherProgramDraws) {
  // Computed by a program in another language from the definitions of SplitMix64 and PCG32 and from the comment on
  // candidate_noise(); that program also reproduces PCG32's published sample. Stores hold such searches, so the numbers
  // may not change. Seed 17, radius 4, around (80, 80, 80): five candidates of chain 0, two of chain 1.
  struct Case {
    Move move;
    Neighbour neighbour;
    Places first_chain;
    Places second_chain;
  };
  const std::vector<Case> cases = {{Move::all,
                                    Neighbour::three,
                                    {{80, 76, 80}, {84, 76, 84}, {76, 76, 76}, {84, 80, 80}, {76, 84, 84}},
                                    {{84, 84, 76}, {84, 80, 84}}},
                                   {Move::all,
                                    Neighbour::sign,
                                    {{84, 76, 76}, {84, 76, 76}, {76, 84, 84}, {76, 84, 76}, {76, 84, 84}},
                                    {{84, 84, 76}, {76, 76, 84}}},
                                   {Move::all,
                                    Neighbour::uniform,
                                    {{77, 82, 77}, {78, 82, 78}, {76, 76, 79}, {78, 83, 83}, {76, 78, 78}},
                                    {{81, 81, 79}, {78, 77, 78}}},
                                   {Move::one,
                                    Neighbour::three,
                                    {{80, 76, 80}, {80, 80, 76}, {76, 80, 80}, {80, 80, 80}, {84, 80, 80}},
                                    {{80, 80, 84}, {80, 80, 80}}},
                                   {Move::one,
                                    Neighbour::sign,
                                    {{80, 76, 80}, {80, 80, 76}, {84, 80, 80}, {80, 80, 84}, {84, 80, 80}},
                                    {{80, 80, 84}, {80, 80, 76}}},
                                   {Move::one,
                                    Neighbour::uniform,
                                    {{80, 82, 80}, {80, 80, 82}, {76, 80, 80}, {80, 80, 83}, {78, 80, 80}},
                                    {{80, 80, 81}, {80, 80, 77}}}};
  for (const Case& expected : cases) {
    GreatDelugeSettings settings;
    settings.move = expected.move;
    settings.neighbour = expected.neighbour;
    settings.step = 4;
    settings.retries = 5;
    settings.credits = 0;
    Places first_chain;
    Places second_chain;
    for (const auto& line :
         log_of(settings, Landscape{.level = [](const auto&) { return 0.0; }}, {{80, 80, 80}, {80, 80, 80}}, 17)) {
      if (line.radius > 0.0) {
        (line.chain == 0 ? first_chain : second_chain).push_back(line.place);
      }
    }
    second_chain.resize(2);
    EXPECT_EQ(first_chain, expected.first_chain);
    EXPECT_EQ(second_chain, expected.second_chain);
  }
}

TEST(GreatDelugeTrace, IsTheOneWorkedOutByHandFromTheThesis) {
  // Section 3.4.2: "Every time a solution is found, it increases this condition by a given amount, named rain." "If the
  // number of allowed retries per chance is reached, one credit is consumed and the number of used retries is set to
  // zero again." "Confidence of twenty means that every twentieth simulation round when no valid candidate was found,
  // the step-size ... is increased by itself. But after a valid neighbour ... is found, the number of retries is set to
  // zero again and in this way the step-size is set to its initial value again." "The algorithm terminates if ... no
  // candidate was accepted and no credit is left".
  GreatDelugeSettings settings;
  settings.water_level = 0.5;
  settings.rain = 0.25;
  settings.credits = 1;
  settings.retries = 6;
  settings.confidence = 2;
  settings.step = 3;
  struct Line {
    double level;  ///< that the landscape gives
    double water;
    std::uint32_t used;
    std::uint32_t credits;
    double doubled;    ///< the radius if it doubles
    double linear;     ///< the radius if it grows by the first one
    bool accepted;     ///< level >= water
    std::size_t from;  ///< line of the last accepted place
  };
  const std::vector<Line> lines = {
      {0.75, 0.50, 0, 1, 0, 0, true, 0},     // the start
      {0.50, 0.75, 0, 1, 3, 3, false, 0},    //
      {0.75, 0.75, 1, 1, 3, 3, true, 0},     // as high as the water
      {0.00, 1.00, 0, 1, 3, 3, false, 2},    //
      {0.99, 1.00, 1, 1, 3, 3, false, 2},    //
      {0.00, 1.00, 2, 1, 6, 6, false, 2},    // two failures
      {0.00, 1.00, 3, 1, 6, 6, false, 2},    //
      {0.00, 1.00, 4, 1, 12, 9, false, 2},   // four
      {0.00, 1.00, 5, 1, 12, 9, false, 2},   // six: the credit is consumed
      {0.00, 1.00, 0, 0, 3, 3, false, 2},    //
      {2.00, 1.00, 1, 0, 3, 3, true, 2},     //
      {1.00, 1.25, 0, 0, 3, 3, false, 10},   // worse than the current place, and below the water
      {0.00, 1.25, 1, 0, 3, 3, false, 10},   //
      {0.00, 1.25, 2, 0, 6, 6, false, 10},   //
      {0.00, 1.25, 3, 0, 6, 6, false, 10},   //
      {0.00, 1.25, 4, 0, 12, 9, false, 10},  //
      {0.00, 1.25, 5, 0, 12, 9, false, 10},  // no credit is left
  };
  for (const Growth growth : {Growth::linear, Growth::doubling}) {
    settings.growth = growth;
    std::size_t evaluation = 0;
    const auto log =
        log_of(settings, Landscape{.level = [&](const auto&) { return lines.at(evaluation++).level; }}, {{80, 80, 80}});
    ASSERT_EQ(log.size(), lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double radius = growth == Growth::doubling ? lines[i].doubled : lines[i].linear;
      EXPECT_EQ(log[i].level, lines[i].level) << i;
      EXPECT_EQ(log[i].water, lines[i].water) << i;
      EXPECT_EQ(log[i].used, lines[i].used) << i;
      EXPECT_EQ(log[i].credits, lines[i].credits) << i;
      EXPECT_EQ(log[i].radius, radius) << i;
      EXPECT_EQ(log[i].accepted, lines[i].accepted) << i;
      for (std::size_t variable = 0; variable < 3; ++variable) {
        const double offset = std::abs(log[i].place[variable] - log[lines[i].from].place[variable]);
        EXPECT_TRUE(offset == 0.0 || offset == radius) << i << ": " << offset;
      }
    }
  }
}

/// Follows a sequence of candidates and scores, and checks what the thesis (section 3.4.2) allows next. It draws
/// nothing: within the radius every neighbour is allowed.
class ThesisRules {
 public:
  ThesisRules(const Experiment& experiment, const FakeSource& source)
      : experiment_(experiment), settings_(std::get<GreatDelugeSettings>(experiment.method)), source_(source) {}

  /// ending: what the search returned; empty if its budget ended it.
  void check(const std::string& ending) {
    for (std::uint32_t i = 0; i < settings_.chains && next_ < source_.asked.size(); ++i) {
      start_chain();
    }
    std::size_t turn = 0;
    while (next_ < source_.asked.size() && !testing::Test::HasFailure()) {
      ASSERT_FALSE(target_reached_) << "the search ends where the target is reached";
      ASSERT_TRUE(std::ranges::any_of(chains_, &Chain::is_running)) << "no chain has a credit left";
      while (!chains_[turn % chains_.size()].is_running) {
        ++turn;
      }
      follow(chains_[turn++ % chains_.size()]);
    }
    EXPECT_EQ(target_reached_, ending == "target reached");
    EXPECT_EQ(std::ranges::none_of(chains_, &Chain::is_running), ending == "no credit left");
  }

 private:
  struct Chain {
    Candidate accepted;
    double water;
    std::uint32_t failures = 0;  ///< since the last acceptance or credit
    std::uint32_t credits = 0;
    bool is_running = true;
  };

  /// The score as a height that the search climbs.
  [[nodiscard]] double height(std::size_t evaluation) const { return sign() * source_.scores[evaluation][0]; }
  [[nodiscard]] double sign() const { return experiment_.objectives[0].goal == Goal::maximise ? 1.0 : -1.0; }

  void note_target(double height) {
    target_reached_ = settings_.target.has_value() && height >= sign() * *settings_.target;
  }

  void start_chain() {
    Chain& chain =
        chains_.emplace_back(Chain{source_.asked[next_], sign() * settings_.water_level, 0, settings_.credits, true});
    if (!settings_.first_must_pass || height(next_) >= chain.water) {
      chain.water += settings_.rain;
    }
    note_target(height(next_++));
  }

  void follow(Chain& chain) {
    const Candidate& candidate = source_.asked[next_];
    check_neighbour(chain, candidate);
    double sum = height(next_++);
    double mean = sum;
    if (sum >= chain.water && settings_.reevaluations > 0) {
      for (std::uint32_t i = 0; i < settings_.reevaluations; ++i) {
        if (next_ == source_.asked.size()) {
          return;  // the budget ended the search
        }
        EXPECT_EQ(source_.asked[next_], candidate) << "evaluated again";
        sum += height(next_++);
      }
      mean = sum / (settings_.reevaluations + 1.0);
    }
    if (mean >= chain.water) {
      chain.accepted = candidate;
      chain.water += settings_.rain;
      chain.failures = 0;
    } else if (++chain.failures == settings_.retries) {
      chain.is_running = chain.credits > 0;
      chain.credits -= chain.is_running ? 1 : 0;
      chain.failures = 0;
    }
    note_target(mean);
  }

  void check_neighbour(const Chain& chain, const Candidate& candidate) const {
    const double growths = chain.failures / settings_.confidence;  // NOLINT(bugprone-integer-division): whole ones
    const double radius = settings_.step * (settings_.growth == Growth::linear ? 1.0 + growths : std::exp2(growths));
    std::size_t moved = 0;
    for (std::size_t i = 0; i < candidate.size(); ++i) {
      const double from = chain.accepted[i];
      const double last = static_cast<double>(experiment_.space.dimensions[i].values.size()) - 1.0;
      const double reached = candidate[i];
      EXPECT_LE(reached, last);
      moved += reached != from ? 1 : 0;
      const bool stays = reached == from;
      const bool at_radius = reached == std::min(from + radius, last) || reached == std::max(from - radius, 0.0);
      const bool within = std::abs(reached - from) <= radius;
      const bool may_stay = settings_.neighbour != Neighbour::sign || settings_.move == Move::one;
      EXPECT_TRUE(at_radius || (stays && may_stay) || (within && settings_.neighbour == Neighbour::uniform))
          << "parameter " << i << " moves from " << from << " to " << reached << ", radius " << radius;
    }
    EXPECT_LE(moved, settings_.move == Move::one ? 1U : candidate.size());
  }

  const Experiment& experiment_;
  const GreatDelugeSettings& settings_;
  const FakeSource& source_;
  std::vector<Chain> chains_;
  std::size_t next_ = 0;  ///< evaluation that is checked next
  bool target_reached_ = false;
};

void expect_thesis_rules(const Experiment& experiment, std::uint32_t run, const FakeSource::Function& function) {
  FakeSource source(function, 8, 3000);
  std::string ending;
  try {
    ending = search(experiment, run, source);
  } catch (const SearchEnded&) {
  }
  ThesisRules(experiment, source).check(ending);
  if (!std::get<GreatDelugeSettings>(experiment.method).target) {
    EXPECT_GT(source.asked.size(), 100U);
  }
}

TEST(GreatDelugeSequence, FollowsTheRulesOfTheThesisWithEveryOption) {
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
          expect_thesis_rules(experiment, 5, rugged_score());

          settings.water_level = 4.0;
          settings.target = 2.0;
          expect_thesis_rules(make_experiment({41, 7, 161, 2}, settings, Goal::minimise), 0, lowland);
          ++combinations;
        }
      }
    }
  }
  EXPECT_EQ(combinations, 24);
}

TEST(GreatDelugeSequence, IsTheSameHoweverMuchIsPredicted) {
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

TEST(GreatDelugePrediction, IsRightWhileCandidatesAreAcceptedOrRejectedAsThoseBefore) {
  GreatDelugeSettings settings;
  settings.water_level = 0.2;  // far below the start: at first nearly all are accepted, at last nearly none
  const Experiment experiment = make_experiment({41, 41, 41, 41}, settings);
  FakeSource source(rugged_score(), 16, 20'000);
  EXPECT_EQ(search(experiment, 2, source), "no credit left");
  double water = 0.2;
  std::size_t accepted = 0;
  std::size_t equal_outcomes = 0;  // latest outcomes that are equal
  bool last = false;
  std::size_t predicted_among_acceptances = 0;
  for (std::size_t i = 0; i < source.asked.size(); ++i) {
    EXPECT_EQ(source.needed[i], water);
    if (i > 1 && equal_outcomes > 8) {
      EXPECT_EQ(source.predictions[i], FakeSource::Prediction::right) << i;
      predicted_among_acceptances += last ? 1U : 0U;
    }
    const bool is_accepted = source.scores[i][0] >= water;
    equal_outcomes = is_accepted == last ? equal_outcomes + 1 : 1;
    last = is_accepted;
    if (is_accepted) {
      water += settings.rain;
      ++accepted;
    }
  }
  EXPECT_GT(predicted_among_acceptances, 20U);
  EXPECT_GT(source.count(FakeSource::Prediction::right), source.asked.size() - accepted);
}

TEST(GreatDelugePrediction, IncludesReevaluationsAndTheTurnsOfChains) {
  GreatDelugeSettings settings;
  settings.chains = 3;
  settings.reevaluations = 2;
  settings.retries = 10;
  settings.credits = 1;
  // One candidate in the middle of the search is accepted and confirmed, all others fail. Only the evaluation after its
  // first one is not predicted.
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
      EXPECT_EQ(source.predictions[i], FakeSource::Prediction::right) << i;
    }
  }
}

TEST(GreatDelugeRacing, UsesTheLowestWaterOfTheChains) {
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
