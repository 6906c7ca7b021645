#include "sim/optimize/adaptation/atlas.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/report/report.hpp"
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

/// The values of a gait, each from 0 at the first to 1 at the last of its dimension.
std::vector<double> shares_of(const SearchSpace& space, const Candidate& candidate) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < candidate.size(); ++i) {
    const std::size_t count = space.dimensions[i].values.size();
    shares.push_back(count > 1 ? candidate[i] / static_cast<double>(count - 1) : 0.0);
  }
  return shares;
}

/// Adds gaits, each as far from all that are there as there is (T. F. Gonzalez, "Clustering to minimize the maximum
/// intercluster distance", Theoretical Computer Science 38, 1985).
void add_unlike_gaits(Atlas& atlas, const GaitMap& map, const std::vector<Evaluation>& evaluations, std::size_t most) {
  struct Tried {
    AtlasGait gait;
    std::vector<double> shares;
    double distance = std::numeric_limits<double>::infinity();  ///< squared, from the nearest gait that is there
  };
  std::vector<Tried> all;
  for (const Evaluation& evaluation : evaluations) {
    if (const std::optional<std::size_t> cell = map.cell_of(evaluation.scores)) {
      all.push_back({{*cell, evaluation.candidate, evaluation.scores.front()},
                     shares_of(atlas.experiment.space, evaluation.candidate)});
    }
  }
  const auto shorten_distances = [&](const std::vector<double>& shares) {
    for (Tried& tried : all) {
      double squares = 0.0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        squares += (tried.shares[i] - shares[i]) * (tried.shares[i] - shares[i]);
      }
      tried.distance = std::min(tried.distance, squares);
    }
  };
  for (const AtlasGait& gait : atlas.gaits) {
    shorten_distances(shares_of(atlas.experiment.space, gait.candidate));
  }
  for (std::size_t added = 0; added < most; ++added) {
    const auto farthest = std::ranges::max_element(all, {}, &Tried::distance);
    if (farthest == all.end() || farthest->distance == 0.0) {
      break;
    }
    atlas.gaits.push_back(farthest->gait);
    shorten_distances(std::vector<double>(farthest->shares));
  }
}

}  // namespace

std::vector<std::vector<double>> Atlas::points() const {
  const GaitMap map(experiment);
  std::vector<std::vector<double>> points;
  for (const AtlasGait& gait : gaits) {
    points.push_back(map.point(gait.cell));
    std::ranges::copy(shares_of(experiment.space, gait.candidate), std::back_inserter(points.back()));
  }
  return points;
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

Atlas read_atlas(const std::filesystem::path& path, std::size_t most_others) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / "store.sqlite" : path;
  require_store_file(file);
  Atlas atlas{read_experiment_of(file), {}, {}};
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
  atlas.remarks = axis_remarks(atlas.experiment, evaluations);
  add_unlike_gaits(atlas, map, evaluations, most_others);
  return atlas;
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
