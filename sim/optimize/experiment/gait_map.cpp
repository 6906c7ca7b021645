#include "sim/optimize/experiment/gait_map.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::optimize {
namespace {

std::size_t number_of_cells(const Experiment& experiment) {
  std::size_t cells = 1;
  for (const MapAxis& axis : experiment.axes) {
    cells *= axis.cells;
  }
  return cells;
}

}  // namespace

GaitMap::GaitMap(const Experiment& experiment)
    : experiment_(experiment), positions_(number_of_cells(experiment), none) {}

bool GaitMap::add(std::size_t candidate, std::span<const double> scores) {
  const std::optional<std::size_t> cell = cell_of(scores);
  if (!cell) {
    return false;
  }
  const double score = scores.front();
  std::size_t& position = positions_[*cell];
  if (position == none) {
    position = elites_.size();
    elites_.push_back({*cell, candidate, score});
    qd_score_ += gain(score);
    return true;
  }
  Elite& elite = elites_[position];
  if (!experiment_.objectives.front().better(score, elite.score)) {
    return false;
  }
  qd_score_ += gain(score) - gain(elite.score);
  elite.candidate = candidate;
  elite.score = score;
  return true;
}

std::vector<std::uint32_t> GaitMap::place(std::size_t cell) const {
  std::vector<std::uint32_t> place;
  for (const MapAxis& axis : experiment_.axes) {
    place.push_back(static_cast<std::uint32_t>(cell % axis.cells));
    cell /= axis.cells;
  }
  return place;
}

/// The first axis has neighbouring cells.
std::optional<std::size_t> GaitMap::cell_of(std::span<const double> scores) const {
  if (!std::isfinite(scores.front()) || scores.front() == experiment_.objectives.front().failed) {
    return std::nullopt;
  }
  std::size_t cell = 0;
  std::size_t stride = 1;
  for (std::size_t i = 0; i < experiment_.axes.size(); ++i) {
    const MapAxis& axis = experiment_.axes[i];
    const double value = scores[1 + i];
    if (!std::isfinite(value) || value == experiment_.objectives[1 + i].failed) {
      return std::nullopt;
    }
    const double position = (value - axis.lowest) / (axis.highest - axis.lowest) * axis.cells;
    cell += stride * static_cast<std::size_t>(std::clamp(position, 0.0, axis.cells - 1.0));
    stride *= axis.cells;
  }
  return cell;
}

double GaitMap::gain(double score) const {
  const Objective& objective = experiment_.objectives.front();
  return objective.cost(objective.failed) - objective.cost(score);
}

}  // namespace proleg::optimize
