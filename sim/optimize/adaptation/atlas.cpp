#include "sim/optimize/adaptation/atlas.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found) {
  throw StoreError(path.string() + ": found " + found + ", expected a map of gaits: the folder of `proleg atlas`");
}

std::string joint_count_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " joint" : " joints"); }

void require_same_joints(const sim::Scenario& atlas, const sim::Scenario& scenario) {
  const std::vector<sim::Joint>& wanted = atlas.robot.joints;
  const std::vector<sim::Joint>& found = scenario.robot.joints;
  if (found.size() != wanted.size()) {
    throw InputError(scenario.robot_file, 0, joint_count_text(found.size()),
                     joint_count_text(wanted.size()) + " as in the atlas");
  }
  constexpr double same_direction = 0.999;
  for (std::size_t joint = 0; joint < wanted.size(); ++joint) {
    if (found[joint].name != wanted[joint].name) {
      throw InputError(scenario.robot_file, 0, "joint " + in_quotes(found[joint].name),
                       in_quotes(wanted[joint].name) + " at this place of the chain, as in the atlas");
    }
    if (found[joint].axis.dot(wanted[joint].axis) < same_direction) {
      throw InputError(scenario.robot_file, 0, "another axis of joint " + found[joint].name, "that of the atlas");
    }
  }
}

void require_same_modules(const sim::Scenario& atlas, const sim::Scenario& scenario) {
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    const Slot& wanted = atlas.kernel.slots[slot];
    const Slot& found = scenario.kernel.slots[slot];
    if (found.algorithm != wanted.algorithm || !(found.group == wanted.group)) {
      const auto name = [slot](const sim::Scenario& one) {
        return one.kernel.slots[slot].algorithm == nullptr ? "no actuation module " + std::to_string(slot + 1)
                                                           : sim::slot_name(one, slot) + " on its joints";
      };
      throw InputError(scenario.actuation_file, 0, name(scenario), name(atlas) + " as in the atlas");
    }
  }
  if (scenario.kernel.tick_period_us != atlas.kernel.tick_period_us) {
    throw InputError(scenario.path, 0, "ticks of " + std::to_string(scenario.kernel.tick_period_us) + " us",
                     std::to_string(atlas.kernel.tick_period_us) + " us as in the atlas");
  }
}

/// The start values that the search does not choose.
void require_same_values(const sim::Scenario& atlas, const sim::Scenario& scenario) {
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    const ActuationModule* const algorithm = scenario.kernel.slots[slot].algorithm;
    for (unsigned joint = 0; algorithm != nullptr && joint < scenario.kernel.joint_count; ++joint) {
      const std::span<const Parameter> parameters = algorithm->declaration().parameters;
      for (unsigned number = 0; number < parameters.size() && scenario.kernel.slots[slot].group.contains(joint);
           ++number) {
        if (start_value(scenario, slot, joint, number) != start_value(atlas, slot, joint, number)) {
          throw InputError(
              scenario.actuation_file, 0,
              "another " + std::string(parameters[number].name) + " of " + scenario.robot.joints[joint].name,
              "that of the atlas, which does not choose it");
        }
      }
    }
  }
}

}  // namespace

std::vector<AdaptationCell> Atlas::cells() const {
  const GaitMap map(experiment);
  std::vector<AdaptationCell> cells;
  for (const AtlasGait& gait : gaits) {
    cells.push_back({map.point(gait.cell), -experiment.objectives.front().cost(gait.score)});
    for (std::size_t i = 0; i < gait.candidate.size(); ++i) {
      const std::size_t count = experiment.space.dimensions[i].values.size();
      cells.back().point.push_back(count > 1 ? gait.candidate[i] / static_cast<double>(count - 1) : 0.0);
    }
  }
  return cells;
}

std::string Atlas::fingerprint() const {
  std::string text = experiment.fingerprint();
  for (const AtlasGait& gait : gaits) {
    text += ' ' + std::to_string(gait.cell) + ' ' + exact_text(gait.score);
    for (const std::uint32_t value : gait.candidate) {
      text += ',' + std::to_string(value);
    }
  }
  return sha256_hex(text);
}

Atlas read_atlas(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / "store.sqlite" : path;
  require_store_file(file);
  Atlas atlas{read_experiment_of(file), {}};
  if (atlas.experiment.axes.empty()) {
    refuse(file, "a search without a map");
  }
  Store store(file, atlas.experiment, {}, Store::Opening::trust);
  const std::vector<Evaluation> evaluations = store.evaluations(0);
  const GaitMap map = gait_map(atlas.experiment, evaluations);
  for (const GaitMap::Elite& elite : map.elites()) {
    atlas.gaits.push_back({elite.cell, evaluations[elite.candidate].candidate, elite.score});
  }
  std::ranges::sort(atlas.gaits, {}, &AtlasGait::cell);
  if (atlas.gaits.empty()) {
    refuse(file, "no gait yet");
  }
  return atlas;
}

void rate_for_length(Atlas& atlas, double seconds, const std::function<void(double share)>& progress,
                     const std::function<bool()>& stop) {
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
  const Objective& objective = experiment.objectives.front();
  constexpr std::size_t most_at_once = 64;
  std::vector<bool> has_score(atlas.gaits.size());
  for (std::size_t first = 0; first < atlas.gaits.size(); first += most_at_once) {
    const std::span<AtlasGait> gaits =
        std::span(atlas.gaits).subspan(first, std::min(most_at_once, atlas.gaits.size() - first));
    std::vector<sim::Scenario> scenarios(gaits.size(), experiment.scenario);
    for (std::size_t i = 0; i < gaits.size(); ++i) {
      experiment.space.apply(gaits[i].candidate, scenarios[i]);
    }
    const auto after_tick = [&stop](std::size_t, const sim::Simulation&, TrialResult& result) {
      result.given_up = stop();
    };
    const auto at_end = [&](std::size_t i, const sim::Simulation& simulation, TrialResult&) {
      const sim::MeasureValues measures = simulation.measures(experiment.heading_deg);
      gaits[i].score = objective.score(measures);
      has_score[first + i] = objective.is_defined(measures);
    };
    static_cast<void>(run_scenarios(scenarios, {after_tick, at_end}));
    if (stop()) {
      throw SearchEnded();
    }
    progress(static_cast<double>(first + gaits.size()) / static_cast<double>(atlas.gaits.size()));
  }
  std::vector<AtlasGait> rated;
  for (std::size_t i = 0; i < atlas.gaits.size(); ++i) {
    if (has_score[i]) {
      rated.push_back(atlas.gaits[i]);
    }
  }
  atlas.gaits = std::move(rated);
  if (atlas.gaits.empty()) {
    refuse(experiment.path, "no gait with a score in " + number_text(seconds) + " s");
  }
}

void require_same_robot(const Atlas& atlas, const sim::Scenario& scenario) {
  require_same_joints(atlas.experiment.scenario, scenario);
  require_same_modules(atlas.experiment.scenario, scenario);
  sim::Scenario with_gait = scenario;
  sim::Scenario of_atlas = atlas.experiment.scenario;
  atlas.experiment.space.apply(atlas.gaits.front().candidate, with_gait);
  atlas.experiment.space.apply(atlas.gaits.front().candidate, of_atlas);
  require_same_values(of_atlas, with_gait);
}

}  // namespace proleg::optimize
