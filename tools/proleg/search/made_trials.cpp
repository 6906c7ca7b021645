#include "tools/proleg/search/made_trials.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "tools/proleg/search/map_result.hpp"
#include "tools/proleg/search/optimisation.hpp"

namespace proleg::tools {

using optimize::MadeTrial;
using optimize::rounded_text;

MadeTrials::MadeTrials(const optimize::Atlas& atlas, std::vector<optimize::Hypothesis> hypotheses,
                       const std::vector<std::string>& damages, const optimize::AdaptationSettings& settings)
    : atlas_(atlas),
      map_(atlas.experiment),
      objective_(atlas.experiment.objectives.front()),
      names_{"none", "unknown"},
      adaptation_(atlas.points(), std::move(hypotheses), settings) {
  names_.insert(names_.end(), damages.begin(), damages.end());
}

void MadeTrials::add(const MadeTrial& trial) {
  adaptation_.tell(trial.gait, value_of(trial.measured));
  trials_.push_back(trial);
}

std::optional<MadeTrial> MadeTrials::next() const {
  const std::optional<std::size_t> gait = adaptation_.next();
  if (!gait) {
    return std::nullopt;
  }
  const optimize::Estimate& expected = adaptation_.expected()[*gait];
  return MadeTrial{*gait, score_of(expected.mean), expected.deviation, 0.0, {}};
}

const MadeTrial* MadeTrials::best() const {
  const MadeTrial* best = nullptr;
  for (const MadeTrial& trial : trials_) {
    if (trial.failure.empty() && (best == nullptr || objective_.better(trial.measured, best->measured))) {
      best = &trial;
    }
  }
  return best;
}

std::size_t MadeTrials::number_of(const MadeTrial& trial) const {
  return static_cast<std::size_t>(&trial - trials_.data()) + 1;
}

double MadeTrials::best_expected() const {
  return score_of(std::ranges::max_element(adaptation_.expected(), {}, &optimize::Estimate::mean)->mean);
}

std::string MadeTrials::line_of_last() const {
  const MadeTrial& trial = trials_.back();
  const std::size_t cell = atlas_.gaits[trial.gait].cell;
  const std::vector<double> middle = map_.middle(cell);
  std::string measures;
  for (std::size_t axis = 0; axis < middle.size(); ++axis) {
    const optimize::Objective& measure = atlas_.experiment.objectives[1 + axis];
    measures += (axis == 0 ? "" : ", ") + measure.name + ' ' + rounded_text(middle[axis], measure.unit());
  }
  return "trial " + std::to_string(number_of(trial)) + "  cell " + map_.place_text(cell) + " (" + measures +
         "): expected " + rounded_text(trial.expected, objective_.unit()) + ", measured " +
         rounded_text(trial.measured, objective_.unit()) +
         (trial.failure.empty() ? "" : ", failed: " + one_line(trial.failure));
}

std::string MadeTrials::text_of_best() const {
  const MadeTrial& trial = *best();
  return "trial " + std::to_string(number_of(trial)) + ", " + rounded_text(trial.measured, objective_.unit()) + " (" +
         objective_.name +
         "); the best that is expected of any gait: " + rounded_text(best_expected(), objective_.unit());
}

std::vector<std::size_t> MadeTrials::likely_hypotheses() const {
  std::vector<std::size_t> order(names_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t h) { return adaptation_.probabilities()[h]; });
  return order;
}

std::string MadeTrials::text_of_diagnosis() const {
  constexpr std::size_t most = 3;
  constexpr long least_percent = 5;
  std::string text;
  std::vector<std::size_t> order = likely_hypotheses();
  order.resize(names_.size() > 2 ? std::min(most, order.size()) : 0);
  for (const std::size_t h : order) {
    const long percent = std::lround(100.0 * adaptation_.probabilities()[h]);
    if (percent >= least_percent) {
      text += (text.empty() ? "" : ", ") + names_[h] + ' ' + std::to_string(percent) + " %";
    }
  }
  return text;
}

Json MadeTrials::object_of(const MadeTrial& trial) const {
  const optimize::AtlasGait& gait = atlas_.gaits[trial.gait];
  const std::vector<double> middle = map_.middle(gait.cell);
  Json descriptor = Json::empty_object();
  for (std::size_t axis = 0; axis < middle.size(); ++axis) {
    descriptor.add(atlas_.experiment.objectives[1 + axis].name, middle[axis]);
  }
  return {{"cell", place_object(map_, gait.cell)},
          {"descriptor", descriptor},
          {"values", values_object(atlas_.experiment.space, gait.candidate)},
          {"expected", trial.expected},
          {"deviation", trial.deviation},
          {"measured", trial.measured},
          {"failure", trial.failure.empty() ? Json() : Json(one_line(trial.failure))}};
}

void MadeTrials::add_trials_to(Json& object) const {
  Json trials = Json::empty_array();
  for (const MadeTrial& trial : trials_) {
    trials.append(object_of(trial));
  }
  const MadeTrial* const its_best = best();
  object.add("gaits", atlas_.gaits.size());
  object.add("objective", objective_.name);
  object.add("unit", objective_.unit());
  object.add("trials", trials);
  object.add("best_trial", its_best == nullptr ? Json() : Json(number_of(*its_best)));
  object.add("best", its_best == nullptr ? Json() : Json(its_best->measured));
}

void MadeTrials::add_expectations_to(Json& object) const {
  object.add("best_expected", best_expected());
  Json diagnosis = Json::empty_array();
  for (const std::size_t h : likely_hypotheses()) {
    diagnosis.append({{"damage", names_[h]}, {"probability", adaptation_.probabilities()[h]}});
  }
  object.add("diagnosis", diagnosis);
}

std::string MadeTrials::picture() const {
  std::map<std::size_t, optimize::GaitMap::Elite> best_of_cells;
  for (std::size_t i = 0; i < atlas_.gaits.size(); ++i) {
    const optimize::GaitMap::Elite gait{atlas_.gaits[i].cell, i, score_of(adaptation_.expected()[i].mean)};
    const auto [place, is_new] = best_of_cells.try_emplace(gait.cell, gait);
    if (!is_new && objective_.better(gait.score, place->second.score)) {
      place->second = gait;
    }
  }
  std::vector<optimize::GaitMap::Elite> cells;
  cells.reserve(best_of_cells.size());
  for (const auto& [cell, gait] : best_of_cells) {
    cells.push_back(gait);
  }
  std::vector<std::size_t> tried;
  for (const MadeTrial& trial : trials_) {
    tried.push_back(atlas_.gaits[trial.gait].cell);
  }
  const MadeTrial* const its_best = best();
  return optimize::draw_map_with_trials(atlas_.experiment, cells, tried,
                                        its_best == nullptr ? tried.size() : number_of(*its_best) - 1,
                                        "what is expected of each cell after " + std::to_string(trials_.size()) +
                                            " trials, whose numbers are on their cells; the best has a ring");
}

}  // namespace proleg::tools
