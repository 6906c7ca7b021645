#include "sim/optimize/method/great_deluge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>
#include <vector>

#include "sim/optimize/experiment/trials.hpp"
#include "sim/optimize/method/gait_problem.hpp"

namespace proleg::optimize {
namespace {

/// A draw from -radius to radius must have fewer than 2^32 outcomes.
constexpr std::uint32_t max_radius = std::numeric_limits<std::int32_t>::max();

double draw_offset(GreatDelugeSettings::Neighbour neighbour, std::uint32_t radius, Pcg32& noise) {
  const double reach = radius;
  switch (neighbour) {
    case GreatDelugeSettings::Neighbour::three:
      return reach * (static_cast<double>(noise.below(3)) - 1.0);
    case GreatDelugeSettings::Neighbour::sign:
      return noise.below(2) == 0 ? -reach : reach;
    case GreatDelugeSettings::Neighbour::uniform:
      return static_cast<double>(noise.below(2 * radius + 1)) - reach;
  }
  return 0.0;
}

Candidate draw_start(const SearchSpace& space, std::uint64_t seed, std::uint32_t chain) {
  Pcg32 noise(scatter(seed ^ 0x7374617274U), chain);
  Candidate start;
  for (const Dimension& dimension : space.dimensions) {
    start.push_back(noise.below(static_cast<std::uint32_t>(dimension.values.size())));
  }
  return start;
}

}  // namespace

std::uint32_t radius_after(const GreatDelugeSettings& settings, std::uint32_t used) {
  const std::uint64_t times = used / settings.confidence;
  std::uint64_t radius = settings.step;
  if (settings.growth == GreatDelugeSettings::Growth::linear) {
    radius *= 1 + times;
  } else {
    for (std::uint64_t i = 0; i < times && radius < max_radius; ++i) {
      radius *= 2;
    }
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(radius, max_radius));
}

Pcg32 candidate_noise(std::uint64_t seed, std::uint32_t chain, std::uint64_t number) {
  return {scatter(scatter(seed) + number), chain};
}

std::vector<double> DelugeChain::draw(const GreatDelugeSettings& settings, std::uint64_t seed, const DelugeBox& box) {
  Pcg32 noise = candidate_noise(seed, index, drawn++);
  const std::uint32_t radius = radius_after(settings, used);
  std::vector<double> place = current;
  const auto move = [&](std::size_t i) {
    place[i] = std::clamp(place[i] + draw_offset(settings.neighbour, radius, noise), box.lower[i], box.upper[i]);
  };
  if (settings.move == GreatDelugeSettings::Move::one) {
    move(noise.below(static_cast<std::uint32_t>(place.size())));
  } else {
    for (std::size_t i = 0; i < place.size(); ++i) {
      move(i);
    }
  }
  return place;
}

void DelugeChain::accept(const GreatDelugeSettings& settings, const std::vector<double>& place) {
  current = place;
  water += settings.rain;
  used = 0;
}

void DelugeChain::fail(const GreatDelugeSettings& settings) {
  if (++used < settings.retries) {
    return;
  }
  if (credits == 0) {
    ended = true;
    return;
  }
  --credits;
  used = 0;
}

/// The search of one call of evolve().
class GreatDeluge::DelugeSearch {
 public:
  DelugeSearch(const GreatDeluge& algorithm, const pagmo::population& population)
      : algorithm_(algorithm),
        settings_(algorithm.settings_),
        problem_(population.get_problem()),
        gait_(problem_.extract<GaitProblem>()),
        best_places_(population.get_x()),
        box_{problem_.get_lb(), problem_.get_ub()} {
    for (std::uint32_t i = 0; i < population.size(); ++i) {
      chains_.push_back({.index = i,
                         .current = best_places_[i],
                         .water = settings_.water_level,
                         .credits = settings_.credits,
                         .used = 0,
                         .drawn = 0,
                         .acceptance_rate = 0.0,
                         .ended = false});
      best_levels_.push_back(-population.get_f()[i][0]);
    }
  }

  /// Runs the search and returns why it ended.
  std::string run() {
    for (DelugeChain& chain : chains_) {
      const double level = best_levels_[chain.index];
      const bool accepted = !settings_.first_must_pass || level >= chain.water;
      log(chain, chain.current, level, 0.0, accepted);
      if (accepted) {
        chain.accept(settings_, chain.current);
      }
      if (reached(level)) {
        return "target reached";
      }
    }
    for (std::size_t turn = 0; next_turn(chains_, turn); ++turn) {
      if (reached(take_turn(turn))) {
        return "target reached";
      }
    }
    return "no credit left";
  }

  [[nodiscard]] const std::vector<double>& best(std::size_t chain) const { return best_places_[chain]; }
  [[nodiscard]] double best_level(std::size_t chain) const { return best_levels_[chain]; }

 private:
  /// Moves turn to the next chain, in a circle, that has not ended; false if all have ended.
  static bool next_turn(const std::vector<DelugeChain>& chains, std::size_t& turn) {
    for (std::size_t i = 0; i < chains.size(); ++i, ++turn) {
      turn %= chains.size();
      if (!chains[turn].ended) {
        return true;
      }
    }
    return false;
  }

  /// Evaluates a chain's next candidate and returns its level.
  double take_turn(std::size_t turn) {
    DelugeChain& chain = chains_[turn];
    announce_needed_score();
    expect({}, 0, chains_, turn);
    const std::vector<double> place = chain.draw(settings_, algorithm_.seed_, box_);
    double level = evaluate(place);
    if (level >= chain.water && settings_.reevaluations > 0) {
      level = mean_level(chain, place, level);
    }
    if (level > best_levels_[chain.index]) {
      best_levels_[chain.index] = level;
      best_places_[chain.index] = place;
    }
    const bool accepted = level >= chain.water;
    log(chain, place, level, radius_after(settings_, chain.used), accepted);
    chain.count_outcome(accepted);
    if (accepted) {
      chain.accept(settings_, place);
    } else {
      chain.fail(settings_);
    }
    return level;
  }

  double mean_level(const DelugeChain& chain, const std::vector<double>& place, double first) {
    std::vector<DelugeChain> afterwards = chains_;
    afterwards[chain.index].accept(settings_, place);
    double sum = first;
    for (std::uint32_t left = settings_.reevaluations; left > 0; --left) {
      expect(place, left, afterwards, chain.index + 1);
      sum += evaluate(place);
    }
    return sum / (1.0 + settings_.reevaluations);
  }

  double evaluate(const std::vector<double>& place) { return -problem_.fitness(place)[0]; }

  [[nodiscard]] bool reached(double level) const { return settings_.target && level >= *settings_.target; }

  void announce_needed_score() {
    if (gait_ == nullptr) {
      return;
    }
    double water = std::numeric_limits<double>::infinity();
    for (const DelugeChain& chain : chains_) {
      if (!chain.ended) {
        water = std::min(water, chain.water);
      }
    }
    if (announced_water_ != water) {
      announced_water_ = water;
      gait_->evaluator().source().set_needed_score(gait_->evaluator().costs({-water})[0]);
    }
  }

  /// Announces requests to the source: `again`, `times` times, and then the next candidates of the chains from that
  /// turn on. It assumes that a candidate is accepted if most of its chain's latest candidates were: far above the
  /// water nearly all are accepted, near the top nearly none.
  void expect(const std::vector<double>& again, std::uint32_t times, std::vector<DelugeChain> chains,
              std::size_t turn) {
    if (gait_ == nullptr) {
      return;
    }
    const GaitEvaluator& evaluator = gait_->evaluator();
    const std::size_t count = evaluator.source().lookahead();
    std::vector<Candidate> next;
    while (next.size() < std::min<std::size_t>(count, times)) {
      next.push_back(evaluator.candidate(again));
    }
    for (; next.size() < count && next_turn(chains, turn); ++turn) {
      const std::vector<double> place = chains[turn].draw(settings_, algorithm_.seed_, box_);
      next.push_back(evaluator.candidate(place));
      if (chains[turn].acceptance_rate > 0.5 && !algorithm_.scores_depend_on_level_) {
        chains[turn].accept(settings_, place);
      } else {
        chains[turn].fail(settings_);
      }
    }
    evaluator.source().expect(next);
  }

  void log(const DelugeChain& chain, const std::vector<double>& place, double level, double radius, bool accepted) {
    if (algorithm_.verbosity_ > 0) {
      algorithm_.log_.push_back({.chain = chain.index,
                                 .place = place,
                                 .level = level,
                                 .water = chain.water,
                                 .used = chain.used,
                                 .credits = chain.credits,
                                 .radius = radius,
                                 .accepted = accepted});
    }
  }

  const GreatDeluge& algorithm_;
  const GreatDelugeSettings& settings_;
  const pagmo::problem& problem_;
  const GaitProblem* gait_;
  std::vector<std::vector<double>> best_places_;  ///< best place of each chain
  std::vector<double> best_levels_;               ///< levels of best_places_
  DelugeBox box_;
  std::vector<DelugeChain> chains_;
  std::optional<double> announced_water_;
};

GreatDeluge::GreatDeluge(const GreatDelugeSettings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {
  settings_.confidence = std::max(settings_.confidence, 1U);
  settings_.retries = std::max(settings_.retries, 1U);
}

pagmo::population GreatDeluge::evolve(pagmo::population population) const {
  const pagmo::problem& problem = population.get_problem();
  if (problem.get_nobj() != 1 || problem.get_nc() != 0) {
    throw std::invalid_argument(get_name() + ": it needs one objective and no constraints");
  }
  const auto finite = [](double bound) { return std::isfinite(bound); };
  if (!std::ranges::all_of(problem.get_lb(), finite) || !std::ranges::all_of(problem.get_ub(), finite)) {
    throw std::invalid_argument(get_name() + ": it needs finite bounds");
  }
  log_.clear();
  DelugeSearch search(*this, population);
  ending_ = search.run();
  for (std::size_t i = 0; i < population.size(); ++i) {
    population.set_xf(i, search.best(i), {-search.best_level(i)});
  }
  return population;
}

std::string GreatDeluge::get_extra_info() const {
  return "\twater level: " + std::to_string(settings_.water_level) + "\n\train: " + std::to_string(settings_.rain) +
         "\n\tcredits: " + std::to_string(settings_.credits) + "\n\tretries: " + std::to_string(settings_.retries) +
         "\n\tconfidence: " + std::to_string(settings_.confidence) + "\n\tseed: " + std::to_string(seed_);
}

std::string search_great_deluge(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  auto settings = std::get<GreatDelugeSettings>(experiment.method);
  const std::uint64_t seed = method_seed(experiment.seed, run);
  const std::uint32_t chains = std::max(settings.chains, 1U);

  std::vector<Candidate> starts;
  for (std::uint32_t chain = 0; chain < chains; ++chain) {
    starts.push_back(settings.start == Start::scenario ? experiment.space.nearest(experiment.scenario)
                                                       : draw_start(experiment.space, seed, chain));
  }
  source.set_needed_score(settings.first_must_pass ? std::optional(settings.water_level) : std::nullopt);
  source.expect(starts);

  // The algorithm maximises. To minimise an objective, it maximises the negative.
  if (experiment.objectives.front().goal == Goal::minimise) {
    settings.water_level = -settings.water_level;
    if (settings.target) {
      settings.target = -*settings.target;
    }
  }
  GaitEvaluator evaluator(experiment.space, experiment.objectives, source);
  pagmo::population population{pagmo::problem{GaitProblem{evaluator}}, 0U, static_cast<unsigned>(seed)};
  for (const Candidate& start : starts) {
    population.push_back(evaluator.numbers(start));
  }
  GreatDeluge deluge(settings, seed);
  deluge.set_scores_depend_on_level(experiment.racing.on());
  const pagmo::algorithm algorithm{deluge};
  population = algorithm.evolve(population);
  return algorithm.extract<GreatDeluge>()->ending();
}

}  // namespace proleg::optimize
