#include "sim/optimize/adaptation/gait_rating.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/scenario_runs.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/scenario/damage.hpp"

namespace proleg::optimize {
namespace {

/// Gaits that are rated together: engines that simulate in batches want many, and progress is shown after each.
constexpr std::size_t most_at_once = 64;

// How far the robot is from what a hypothesis expects, as shares of the best score. A simulation of the right damage
// errs by the difference of two engines and by details of the damage; one of the intact robot by what the damage does.
// Chosen on simulated robots with damages; docs/adaptation.md has what they reach on robots that were not among these.
constexpr double deviation_of_simulation = 0.1;
constexpr double deviation_of_unknown = 0.3;
constexpr double probability_of_unknown = 0.1;

/// The scores of the gaits in runs of a scenario; nothing for a run without the measure. Throws SearchEnded.
std::vector<std::optional<double>> rate(const Experiment& experiment, const sim::Scenario& scenario,
                                        std::span<const AtlasGait> gaits, const std::function<bool()>& stop) {
  std::vector<sim::Scenario> scenarios(gaits.size(), scenario);
  for (std::size_t i = 0; i < gaits.size(); ++i) {
    experiment.space.apply(gaits[i].candidate, scenarios[i]);
  }
  const Objective& objective = experiment.objectives.front();
  std::vector<std::optional<double>> scores(gaits.size());
  const auto after_tick = [&](std::size_t, const sim::Simulation&, TrialResult& result) { result.given_up = stop(); };
  const auto at_end = [&](std::size_t i, const sim::Simulation& simulation, TrialResult&) {
    const sim::MeasureValues measures = simulation.measures(experiment.heading_deg);
    if (objective.is_defined(measures)) {
      scores[i] = objective.score(measures);
    }
  };
  static_cast<void>(run_scenarios(scenarios, {after_tick, at_end}));
  if (stop()) {
    throw SearchEnded();
  }
  return scores;
}

/// Ratings of the same gaits in several scenarios, by threads that each take the next part of the work.
class ParallelRating {
 public:
  ParallelRating(const Atlas& atlas, std::vector<sim::Scenario> scenarios, const ShareDone& progress,
                 const std::function<bool()>& stop)
      : atlas_(atlas),
        scenarios_(std::move(scenarios)),
        progress_(progress),
        stop_(stop),
        parts_((atlas.gaits.size() + most_at_once - 1) / most_at_once),
        scores_(scenarios_.size(), std::vector<std::optional<double>>(atlas.gaits.size())) {}

  /// By scenario and gait.
  const std::vector<std::vector<std::optional<double>>>& run() {
    std::vector<std::future<void>> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) {
      others.push_back(std::async(std::launch::async, [this] { work(); }));
    }
    work();
    for (std::future<void>& other : others) {
      other.get();
    }
    return scores_;
  }

 private:
  void work() {
    for (std::size_t job = next_++; job < scenarios_.size() * parts_; job = next_++) {
      const std::size_t first = job % parts_ * most_at_once;
      const std::span<const AtlasGait> gaits =
          std::span(atlas_.gaits).subspan(first, std::min(most_at_once, atlas_.gaits.size() - first));
      const auto rated = rate(atlas_.experiment, scenarios_[job / parts_], gaits, stop_);
      const std::lock_guard lock(mutex_);
      std::ranges::copy(rated, scores_[job / parts_].begin() + static_cast<std::ptrdiff_t>(first));
      progress_(static_cast<double>(++done_) / static_cast<double>(scenarios_.size() * parts_));
    }
  }

  const Atlas& atlas_;
  const std::vector<sim::Scenario> scenarios_;
  const ShareDone& progress_;
  const std::function<bool()>& stop_;
  const std::size_t parts_;  ///< of the gaits
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;  ///< of what follows
  std::size_t done_ = 0;
  std::vector<std::vector<std::optional<double>>> scores_;
};

}  // namespace

void rate_for_length(Atlas& atlas, double seconds, const ShareDone& progress, const std::function<bool()>& stop) {
  Experiment& experiment = atlas.experiment;
  if (experiment.scenario.duration_s == seconds) {
    return;
  }
  if (experiment.on_robot) {
    const std::string length = number_text(experiment.scenario.duration_s);
    throw StoreError(experiment.path + ": found a map that a robot has filled in trials of " + length +
                     " s, expected trials of this length (--seconds " + length + ")");
  }
  experiment.scenario.duration_s = seconds;
  const std::vector<std::optional<double>> scores =
      ParallelRating(atlas, {experiment.scenario}, progress, stop).run().front();
  std::vector<AtlasGait> rated;
  for (std::size_t i = 0; i < atlas.gaits.size(); ++i) {
    if (scores[i]) {
      rated.push_back({atlas.gaits[i].cell, atlas.gaits[i].candidate, *scores[i]});
    }
  }
  if (rated.empty()) {
    throw StoreError(experiment.path + ": found no gait with a score in " + number_text(seconds) +
                     " s, expected a map of gaits: the folder of `proleg atlas`");
  }
  atlas.gaits = std::move(rated);
}

DamageScores rate_with_damages(const Atlas& atlas, std::span<const std::string> damages, const ShareDone& progress,
                               const std::function<bool()>& stop) {
  std::vector<sim::Scenario> scenarios(damages.size(), atlas.experiment.scenario);
  for (std::size_t i = 0; i < damages.size(); ++i) {
    sim::apply_damage(scenarios[i], {damages[i]});
  }
  ParallelRating rating(atlas, std::move(scenarios), progress, stop);
  const auto& rated = rating.run();
  const double failed = atlas.experiment.objectives.front().failed;
  DamageScores scores;
  for (std::size_t i = 0; i < damages.size(); ++i) {
    std::vector<double>& of_gaits = scores[damages[i]];
    for (const std::optional<double>& score : rated[i]) {
      of_gaits.push_back(score.value_or(failed));
    }
  }
  return scores;
}

std::vector<Hypothesis> hypotheses_of(const Atlas& atlas, std::span<const std::string> damages,
                                      const DamageScores& scores) {
  const auto value_of = [&](double score) { return -atlas.experiment.objectives.front().cost(score); };
  std::vector<double> values;
  for (const AtlasGait& gait : atlas.gaits) {
    values.push_back(value_of(gait.score));
  }
  const double probability = (1.0 - probability_of_unknown) / static_cast<double>(1 + damages.size());
  std::vector<Hypothesis> hypotheses{{values, deviation_of_simulation, probability},
                                     {values, deviation_of_unknown, probability_of_unknown}};
  for (const std::string& damage : damages) {
    std::ranges::transform(scores.at(damage), values.begin(), value_of);
    hypotheses.push_back({values, deviation_of_simulation, probability});
  }
  return hypotheses;
}

}  // namespace proleg::optimize
