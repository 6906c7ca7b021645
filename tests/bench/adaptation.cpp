// What a damaged robot reaches in some trials with an atlas, against a search on the damaged robot, the best gait of
// the atlas without adaptation, random gaits of the atlas, trials without what the atlas expects, trials with the atlas
// alone (no damage is suspected), and trials of which no suspected damage is of the joint that is damaged.
//
//   bench_adaptation ATLAS [--damages 20] [--first 0] [--seconds 10] [--trials 12] [--evaluations 2000]
//                    [--engine ode] [--kappa K] [--length L] [--noise N] [--all]
//
// ATLAS: the folder of a search for a map of gaits. The trials are made in ODE. The search is CMA-ES; --engine reduced:
// it searches there, and the best 20 of its candidates are rated in ODE. --all: the best gait of the atlas on each
// robot, too.

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/gait_rating.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/scenario_runs.hpp"
#include "sim/optimize/method/search.hpp"
#include "sim/scenario/damage.hpp"

namespace {

using namespace proleg;
using namespace proleg::optimize;

struct Options {
  std::string atlas;
  std::uint32_t damages = 20;
  std::uint32_t first = 0;
  double seconds = 10.0;
  std::uint64_t evaluations = 2000;
  std::string engine = "ode";
  AdaptationSettings adaptation;
  bool all = false;
};

/// The words of --damage of a seed: one damage of each kind in turn, of a joint that is drawn.
std::vector<std::string> damage_of(const sim::RobotModel& robot, std::uint32_t seed) {
  Pcg32 random(seed, 0);
  const std::string joint = robot.joints[random.below(static_cast<std::uint32_t>(robot.joints.size()))].name;
  const int angle = 5 * static_cast<int>(random.below(13)) - 30;
  switch (seed % 6) {
    case 0:
      return {"jammed:" + joint + "=" + std::to_string(angle)};
    case 1:
      return {"torque:" + joint + "=40%"};
    case 2:
      return {"powerless:" + joint};
    case 3:
      return {"lost:" + joint, "mass:" + robot.links.front().name + "=115%"};
    case 4:
      return {"friction=50%"};
    default:
      return {"jammed:" + joint, "friction=" + std::to_string(60 + random.below(81)) + "%"};
  }
}

sim::Scenario damaged(const Atlas& atlas, const std::vector<std::string>& words, sim::PhysicsEngine engine) {
  sim::Scenario scenario = atlas.experiment.scenario;
  scenario.environment.engine = engine;
  sim::apply_damage(scenario, words);
  return scenario;
}

/// Rates candidates on the damaged robot in one engine, and keeps all that it has rated.
class DamagedSource final : public FitnessSource {
 public:
  DamagedSource(const Atlas& atlas, sim::Scenario scenario, std::uint64_t budget)
      : experiment_(atlas.experiment), scenario_(std::move(scenario)), budget_(budget) {}

  void expect(std::span<const Candidate> next) override {
    std::vector<Candidate> missing;
    for (const Candidate& candidate : next) {
      if (!scores_.contains(candidate)) {
        missing.push_back(candidate);
      }
    }
    rate(missing);
  }
  [[nodiscard]] std::size_t lookahead() const override { return 32; }
  std::vector<double> fitness(const Candidate& candidate) override {
    if (asked_++ >= budget_) {
      throw SearchEnded();
    }
    if (!scores_.contains(candidate)) {
      rate({candidate});
    }
    return {scores_.at(candidate)};
  }
  void set_needed_score(std::optional<double> /*score*/) override {}

  /// The best candidates, best first.
  [[nodiscard]] std::vector<Candidate> best(std::size_t count) const {
    std::vector<std::pair<double, Candidate>> ranked;
    for (const auto& [candidate, score] : scores_) {
      ranked.emplace_back(experiment_.objectives.front().cost(score), candidate);
    }
    std::ranges::sort(ranked);
    std::vector<Candidate> best;
    for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) {
      best.push_back(ranked[i].second);
    }
    return best;
  }

 private:
  void rate(const std::vector<Candidate>& candidates) {
    std::vector<sim::Scenario> scenarios(candidates.size(), scenario_);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      experiment_.space.apply(candidates[i], scenarios[i]);
      scores_[candidates[i]] = experiment_.objectives.front().failed;
    }
    const RunWatch watch{{}, [&](std::size_t i, const sim::Simulation& simulation, TrialResult&) {
                           scores_[candidates[i]] =
                               experiment_.objectives.front().score(simulation.measures(experiment_.heading_deg));
                         }};
    static_cast<void>(run_scenarios(scenarios, watch));
  }

  const Experiment& experiment_;
  sim::Scenario scenario_;
  std::uint64_t budget_;
  std::uint64_t asked_ = 0;
  std::map<Candidate, double> scores_;
};

/// The trials on one damaged robot.
class Robot {
 public:
  /// elites: number of gaits that are the best of their cells.
  Robot(const Atlas& atlas, std::size_t elites, const std::vector<std::string>& words)
      : atlas_(atlas),
        elites_(static_cast<std::uint32_t>(elites)),
        words_(words),
        robot_(atlas.experiment, damaged(atlas, words, sim::PhysicsEngine::ode),
               sim::losses_of_damage(atlas.experiment.scenario, words), [] { return false; }) {}

  double score(const Candidate& candidate) {
    const auto [known, is_new] = known_.try_emplace(candidate);
    if (is_new) {
      known->second = robot_.try_gait(candidate).score;
    }
    return known->second;
  }
  double value(const Candidate& candidate) { return -atlas_.experiment.objectives.front().cost(score(candidate)); }
  double value_of_gait(std::size_t gait) { return value(atlas_.gaits[gait].candidate); }

  /// Best value and number of trials.
  std::pair<double, std::size_t> adapt(const std::vector<Hypothesis>& hypotheses, const AdaptationSettings& settings) {
    Adaptation adaptation(atlas_.points(), hypotheses, settings);
    while (const std::optional<std::size_t> gait = adaptation.next()) {
      adaptation.tell(*gait, value_of_gait(*gait));
    }
    return {adaptation.best()->value, adaptation.trials().size()};
  }

  double best_of_random(std::uint32_t trials, std::uint32_t seed) {
    Pcg32 random(seed, 1);
    double best = value_of_gait(random.below(elites_));
    for (std::uint32_t trial = 1; trial < trials; ++trial) {
      best = std::max(best, value_of_gait(random.below(elites_)));
    }
    return best;
  }

  double best_of_search(std::uint64_t evaluations, const std::string& engine, std::uint32_t seed) {
    Experiment experiment = atlas_.experiment;
    experiment.objectives.resize(1);
    experiment.axes.clear();
    experiment.seed = seed;
    PagmoSettings settings;
    settings.algorithm = "cmaes";
    settings.population = 20;
    settings.generations = 1'000'000;
    settings.restart_after = 20;
    settings.start = Start::random;
    experiment.method = settings;
    const bool is_reduced = engine == "reduced";
    DamagedSource source(atlas_,
                         damaged(atlas_, words_, is_reduced ? sim::PhysicsEngine::reduced : sim::PhysicsEngine::ode),
                         evaluations);
    try {
      static_cast<void>(search(experiment, 0, source));
    } catch (const SearchEnded&) {
    }
    double best = -std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : source.best(is_reduced ? 20 : 1)) {
      best = std::max(best, value(candidate));
    }
    return best;
  }

  double best_of_all() {
    double best = value_of_gait(0);
    for (std::size_t gait = 1; gait < atlas_.gaits.size(); ++gait) {
      best = std::max(best, value_of_gait(gait));
    }
    return best;
  }

 private:
  const Atlas& atlas_;
  std::uint32_t elites_;
  std::vector<std::string> words_;
  SimulatedRobot robot_;
  std::map<Candidate, double> known_;
};

double number_of(const char* text) {
  const std::optional<double> number = parse_number(text);
  if (!number) {
    throw std::runtime_error(std::string("found ") + text + ", expected a number");
  }
  return *number;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&] {
      if (++i == argc) {
        throw std::runtime_error("found nothing behind " + word + ", expected a value");
      }
      return argv[i];
    };
    const auto whole = [&] { return static_cast<std::uint32_t>(number_of(next())); };
    if (word == "--damages") {
      options.damages = whole();
    } else if (word == "--first") {
      options.first = whole();
    } else if (word == "--seconds") {
      options.seconds = number_of(next());
    } else if (word == "--trials") {
      options.adaptation.trials = whole();
    } else if (word == "--evaluations") {
      options.evaluations = whole();
    } else if (word == "--engine") {
      options.engine = next();
    } else if (word == "--kappa") {
      options.adaptation.kappa = number_of(next());
    } else if (word == "--length") {
      options.adaptation.length = number_of(next());
    } else if (word == "--noise") {
      options.adaptation.noise = number_of(next());
    } else if (word == "--all") {
      options.all = true;
    } else if (options.atlas.empty() && !word.starts_with("-")) {
      options.atlas = word;
    } else {
      throw std::runtime_error("found " + word + ", expected the folder of an atlas and options");
    }
  }
  if (options.atlas.empty()) {
    throw std::runtime_error("found no folder of an atlas, expected one");
  }
  return options;
}

/// The first gaits, which are the best of their cells: their cells ascend, and those of the others are among them.
std::size_t elites_of(const Atlas& atlas) {
  std::size_t count = 1;
  while (count < atlas.gaits.size() && atlas.gaits[count].cell > atlas.gaits[count - 1].cell) {
    ++count;
  }
  return count;
}

/// What a word damages: the name of a joint, or "friction=50%".
std::string place_of(const std::string& word) {
  const std::size_t colon = word.find(':');
  return colon == std::string::npos ? word : word.substr(colon + 1, word.find('=') - colon - 1);
}

/// Those that are of another place than the damage.
std::vector<std::string> without_place_of(const std::string& damage, std::vector<std::string> suspects) {
  std::erase_if(suspects, [&](const std::string& suspect) { return place_of(suspect) == place_of(damage); });
  return suspects;
}

/// That all gaits are as good as the mean of all.
Hypothesis without_prior(const Hypothesis& unknown) {
  const double sum = std::accumulate(unknown.values.begin(), unknown.values.end(), 0.0);
  const auto count = static_cast<double>(unknown.values.size());
  return {std::vector<double>(unknown.values.size(), sum / count), unknown.deviation, 1.0};
}

void print_table(const Options& options) {
  Atlas atlas = read_atlas(options.atlas);
  const ShareDone no_progress = [](double) {};
  const auto never = [] { return false; };
  rate_for_length(atlas, options.seconds, no_progress, never);
  const std::vector<std::string> suspects = sim::usual_damages(atlas.experiment.scenario);
  const std::vector<Hypothesis> alone = hypotheses_of(atlas, {}, {});
  const DamageScores scores = rate_with_damages(atlas, suspects, no_progress, never);
  const std::vector<Hypothesis> hypotheses = hypotheses_of(atlas, suspects, scores);
  const std::vector<double>& expected = alone.front().values;
  const auto most_expected = static_cast<std::size_t>(std::ranges::max_element(expected) - expected.begin());
  std::printf("%zu gaits, %zu of them the best of their cells; the best is expected to have %.3f\n", atlas.gaits.size(),
              elites_of(atlas), expected[most_expected]);
  std::printf("%-28s %8s %7s %8s %8s %8s %8s %8s %7s %8s %7s %8s\n", "damage", "adapted", "trials", "search", "best",
              "random", "no prior", "atlas", "trials", "others", "trials", options.all ? "all" : "");
  constexpr std::array<std::string_view, 6> ways{"adapted", "best", "random", "no prior", "atlas", "others"};
  std::array<std::uint32_t, 6> reached{};
  std::array<double, 6> shares{};
  std::array<std::size_t, 3> all_trials{};
  for (std::uint32_t seed = options.first; seed < options.first + options.damages; ++seed) {
    const std::vector<std::string> words = damage_of(atlas.experiment.scenario.robot, seed);
    std::string name;
    for (const std::string& word : words) {
      name += (name.empty() ? "" : " ") + word;
    }
    Robot robot(atlas, elites_of(atlas), words);
    const auto [adapted, trials] = robot.adapt(hypotheses, options.adaptation);
    const double searched =
        options.evaluations > 0 ? robot.best_of_search(options.evaluations, options.engine, seed) : 0.0;
    const auto [with_atlas, trials_with_atlas] = robot.adapt(alone, options.adaptation);
    const std::vector<std::string> others = without_place_of(words.front(), suspects);
    const auto [with_others, trials_with_others] =
        robot.adapt(hypotheses_of(atlas, others, scores), options.adaptation);
    const std::array<double, 6> values{adapted,
                                       robot.value_of_gait(most_expected),
                                       robot.best_of_random(options.adaptation.trials, seed),
                                       robot.adapt({without_prior(alone[1])}, options.adaptation).first,
                                       with_atlas,
                                       with_others};
    for (std::size_t way = 0; way < values.size(); ++way) {
      reached[way] += values[way] >= 0.8 * searched ? 1U : 0U;
      shares[way] += searched > 0.0 ? values[way] / searched / options.damages : 0.0;
    }
    all_trials[0] += trials;
    all_trials[1] += trials_with_atlas;
    all_trials[2] += trials_with_others;
    std::printf("%-28s %8.3f %7zu %8.3f %8.3f %8.3f %8.3f %8.3f %7zu %8.3f %7zu", name.c_str(), values[0], trials,
                searched, values[1], values[2], values[3], values[4], trials_with_atlas, values[5], trials_with_others);
    if (options.all) {
      std::printf(" %8.3f", robot.best_of_all());
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  for (std::size_t way = 0; way < ways.size(); ++way) {
    std::printf("%-8s at least 80 %% of what the search reaches: %u of %u, mean %.1f %%\n", ways[way].data(),
                reached[way], options.damages, 100.0 * shares[way]);
  }
  std::printf("trials on average: adapted %.1f, atlas %.1f, others %.1f\n",
              static_cast<double>(all_trials[0]) / options.damages,
              static_cast<double>(all_trials[1]) / options.damages,
              static_cast<double>(all_trials[2]) / options.damages);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    print_table(read_options(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_adaptation: %s\n", error.what());
    return 2;
  }
  return 0;
}
