#include "tools/proleg/search/map_result.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/judged_cells.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::tools {
namespace {

using optimize::Confirmation;
using optimize::EngineAgreement;
using optimize::Experiment;
using optimize::GaitMap;
using optimize::MapAgreement;

std::string correlation_text(const EngineAgreement& agreement) {
  return std::isfinite(agreement.rank_correlation)
             ? ", rank correlation " + optimize::fixed_text(agreement.rank_correlation, 3)
             : "";
}

}  // namespace

void print_line(const std::string& name, const std::string& text) {
  std::printf("%-24s %s\n", name.c_str(), text.c_str());
}

std::string map_text(const GaitMap& map) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%zu of %zu cells filled (%.1f %%), QD score %s", map.elites().size(),
                map.cells(), 100.0 * map.coverage(), optimize::rounded_text(map.qd_score()).c_str());
  return text.data();
}

Json map_object(const GaitMap& map) {
  return {{"cells", map.cells()},
          {"filled", map.elites().size()},
          {"coverage", map.coverage()},
          {"qd_score", map.qd_score()}};
}

Json place_object(const GaitMap& map, std::size_t cell) {
  Json place = Json::empty_array();
  for (const std::uint32_t number : map.place(cell)) {
    place.append(number + 1);
  }
  return place;
}

std::vector<Confirmation> confirmations_of(std::span<const optimize::Evaluation> cells,
                                           std::span<const Confirmation> confirmations) {
  std::vector<Confirmation> sample;
  for (const optimize::Evaluation& chosen : cells) {
    const auto found = std::ranges::find_if(confirmations, [&](const Confirmation& confirmation) {
      return confirmation.evaluation.candidate == chosen.candidate;
    });
    if (found != confirmations.end()) {
      sample.push_back(*found);
    }
  }
  return sample;
}

void print_agreement(const Experiment& experiment, std::span<const Confirmation> sample,
                     const optimize::Evaluation& best) {
  const MapAgreement agreement = optimize::agreement_of(experiment, sample);
  print_line("judged by " + std::string(sim::name_of(optimize::judging_engine)),
             std::to_string(agreement.cells) + " cells, drawn at random over the map");
  const std::optional<double> ratio = agreement.score_ratio();
  for (std::size_t i = 0; i < agreement.objectives.size(); ++i) {
    const EngineAgreement& objective = agreement.objectives[i];
    const std::string_view unit = experiment.objectives[i].unit();
    const std::string difference = "mean difference " + optimize::rounded_text(objective.mean_difference) +
                                   (unit.empty() ? "" : " " + std::string(unit));
    print_line("  " + objective.name,
               (i == 0 && ratio ? optimize::fixed_text(*ratio, 3) + " of the map's in the mean, " : "") + difference +
                   correlation_text(objective));
  }
  print_line("  cell", std::to_string(agreement.in_the_cell) + " of " + std::to_string(agreement.with_place) +
                           " in the same one, " + std::to_string(agreement.near_it) + " there or next to it");
  const GaitMap map(experiment);
  if (const std::optional<std::size_t> cell = map.cell_of(best.scores)) {
    print_line("  best cell", map.place_text(*cell));
  }
}

Json agreement_object(const Experiment& experiment, std::span<const Confirmation> sample,
                      const optimize::Evaluation& best) {
  const MapAgreement agreement = optimize::agreement_of(experiment, sample);
  Json objectives = Json::empty_object();
  for (const EngineAgreement& objective : agreement.objectives) {
    objectives.add(objective.name, {{"mean_in_map", objective.mean_in_map},
                                    {"mean_judged", objective.mean_judged},
                                    {"mean_difference", objective.mean_difference},
                                    {"rank_correlation", objective.rank_correlation}});
  }
  const GaitMap map(experiment);
  const std::optional<std::size_t> cell = map.cell_of(best.scores);
  return {{"cells", agreement.cells},
          {"with_place", agreement.with_place},
          {"in_the_cell", agreement.in_the_cell},
          {"near_it", agreement.near_it},
          {"score_ratio", agreement.score_ratio()},
          {"objectives", objectives},
          {"best_cell", cell ? place_object(map, *cell) : Json()}};
}

}  // namespace proleg::tools
