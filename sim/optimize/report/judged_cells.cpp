#include "sim/optimize/report/judged_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/random.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// Ranks from 0; equal values have the mean of their ranks.
std::vector<double> ranks_of(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) {
      ++end;
    }
    for (std::size_t i = first; i < end; ++i) {
      ranks[order[i]] = (static_cast<double>(first) + static_cast<double>(end) - 1.0) / 2.0;
    }
    first = end;
  }
  return ranks;
}

bool has_objective(const Experiment& experiment, const Confirmation& confirmation, std::size_t objective) {
  return has_own_score(experiment, confirmation.evaluation, objective) &&
         has_own_score(experiment, confirmation.fresh, objective);
}

EngineAgreement agreement_in(const Experiment& experiment, std::span<const Confirmation> sample,
                             std::size_t objective) {
  std::vector<double> in_map;
  std::vector<double> judged;
  EngineAgreement agreement{experiment.objectives[objective].name};
  for (const Confirmation& confirmation : sample) {
    if (has_objective(experiment, confirmation, objective)) {
      in_map.push_back(confirmation.evaluation.scores[objective]);
      judged.push_back(confirmation.fresh.scores[objective]);
      agreement.mean_in_map += in_map.back();
      agreement.mean_judged += judged.back();
      agreement.mean_difference += std::abs(judged.back() - in_map.back());
    }
  }
  const double count = std::max(static_cast<double>(in_map.size()), 1.0);
  agreement.mean_in_map /= count;
  agreement.mean_judged /= count;
  agreement.mean_difference /= count;
  agreement.rank_correlation = rank_correlation(in_map, judged);
  return agreement;
}

void add_place(const GaitMap& map, std::optional<std::size_t> cell, TableLine& line) {
  const std::vector<std::uint32_t> place = cell ? map.place(*cell) : std::vector<std::uint32_t>();
  for (std::size_t i = 0; i < map.place_numbers().size(); ++i) {
    if (cell) {
      line.add(place[i] + 1);
    } else {
      line.add("");
    }
  }
}

}  // namespace

std::vector<Evaluation> choose_cells(const Experiment& experiment, std::span<const Evaluation> evaluations,
                                     std::size_t count) {
  std::vector<GaitMap::Elite> elites = gait_map(experiment, evaluations).elites();
  std::ranges::sort(elites, {}, &GaitMap::Elite::cell);
  count = std::min(count, elites.size());
  constexpr std::uint64_t stream = 0x6A75646765U;  // any: the sample has random numbers of its own
  Pcg32 random(scatter(experiment.seed), stream);
  std::vector<Evaluation> chosen;
  for (std::size_t part = 0; part < count; ++part) {
    const std::size_t first = part * elites.size() / count;
    const std::size_t end = (part + 1) * elites.size() / count;
    const std::size_t drawn = first + random.below(static_cast<std::uint32_t>(end - first));
    chosen.push_back(evaluations[elites[drawn].candidate]);
  }
  return chosen;
}

double rank_correlation(std::span<const double> left, std::span<const double> right) {
  const std::vector<double> left_ranks = ranks_of(left);
  const std::vector<double> right_ranks = ranks_of(right);
  const double mean = (static_cast<double>(left.size()) - 1.0) / 2.0;
  double both = 0.0;
  double left_squares = 0.0;
  double right_squares = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    both += (left_ranks[i] - mean) * (right_ranks[i] - mean);
    left_squares += (left_ranks[i] - mean) * (left_ranks[i] - mean);
    right_squares += (right_ranks[i] - mean) * (right_ranks[i] - mean);
  }
  const double squares = left_squares * right_squares;
  return squares > 0.0 ? both / std::sqrt(squares) : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> MapAgreement::score_ratio() const {
  const EngineAgreement& score = objectives.front();
  return score.mean_in_map == 0.0 ? std::nullopt : std::optional(score.mean_judged / score.mean_in_map);
}

MapAgreement agreement_of(const Experiment& experiment, std::span<const Confirmation> sample) {
  const GaitMap map(experiment);
  MapAgreement agreement;
  agreement.cells = sample.size();
  for (const Confirmation& confirmation : sample) {
    const std::optional<std::size_t> cell = map.cell_of(confirmation.evaluation.scores);
    const std::optional<std::size_t> judged = map.cell_of(confirmation.fresh.scores);
    if (cell && judged) {
      ++agreement.with_place;
      agreement.in_the_cell += *cell == *judged ? 1U : 0U;
      agreement.near_it += map.are_neighbours(*cell, *judged) ? 1U : 0U;
    }
  }
  for (std::size_t objective = 0; objective < experiment.objectives.size(); ++objective) {
    agreement.objectives.push_back(agreement_in(experiment, sample, objective));
  }
  return agreement;
}

std::string judged_table(const Experiment& experiment, std::span<const Confirmation> sample) {
  const GaitMap map(experiment);
  const auto add_cell_names = [&](const char* prefix, TableLine& line) {
    for (const GaitMap::PlaceNumber& number : map.place_numbers()) {
      line.add(prefix + one_line(number.name));
    }
  };
  TableLine header;
  add_cell_names("cell:", header);
  header.add("evaluation");
  for (const Dimension& dimension : experiment.space.dimensions) {
    header.add(with_unit(one_line(dimension.name), sim::shown_unit(dimension.unit)));
  }
  for (const Objective& objective : experiment.objectives) {
    const std::string name = with_unit(one_line(objective.name), objective.unit());
    for (const sim::PhysicsEngine engine : {experiment.scenario.environment.engine, judging_engine}) {
      header.add(name + " (" + std::string(sim::name_of(engine)) + ")");
    }
  }
  add_cell_names("judged:", header);
  std::string table = header.finish();
  for (const Confirmation& confirmation : sample) {
    TableLine line;
    add_place(map, map.cell_of(confirmation.evaluation.scores), line);
    line.add(confirmation.evaluation.number);
    for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
      line.add(experiment.space.value_text(confirmation.evaluation.candidate, i));
    }
    for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
      line.add(confirmation.evaluation.scores[i]);
      line.add(confirmation.fresh.scores[i]);
    }
    add_place(map, map.cell_of(confirmation.fresh.scores), line);
    table += line.finish();
  }
  return table;
}

}  // namespace proleg::optimize
