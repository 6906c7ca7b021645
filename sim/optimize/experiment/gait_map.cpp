#include "sim/optimize/experiment/gait_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>
#include <variant>

namespace proleg::optimize {
namespace {

/// The centroids of a map; null for a grid. Maps with the same ones share them: 10,000 of four axes take a second.
std::shared_ptr<const Tessellation> tessellation_of(const Experiment& experiment) {
  const auto* const settings = std::get_if<MapElitesSettings>(&experiment.method);
  if (settings == nullptr || settings->centroids == 0) {
    return nullptr;
  }
  static std::mutex mutex;
  static std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<const Tessellation>> known;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const Tessellation>& its = known[{experiment.axes.size(), settings->centroids}];
  if (!its) {
    its = std::make_shared<const Tessellation>(experiment.axes.size(), settings->centroids);
  }
  return its;
}

std::size_t cells_of_grid(const Experiment& experiment) {
  std::size_t cells = 1;
  for (const MapAxis& axis : experiment.axes) {
    cells *= axis.cells;
  }
  return cells;
}

}  // namespace

GaitMap::GaitMap(const Experiment& experiment)
    : experiment_(experiment),
      tessellation_(tessellation_of(experiment)),
      positions_(tessellation_ ? tessellation_->count() : cells_of_grid(experiment), none) {}

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

std::vector<GaitMap::PlaceNumber> GaitMap::place_numbers() const {
  if (tessellation_) {
    return {{"number", static_cast<std::uint32_t>(cells())}};
  }
  std::vector<PlaceNumber> numbers;
  for (const MapAxis& axis : experiment_.axes) {
    numbers.push_back({experiment_.objectives[1 + numbers.size()].name, axis.cells});
  }
  return numbers;
}

std::vector<std::uint32_t> GaitMap::place(std::size_t cell) const {
  if (tessellation_) {
    return {static_cast<std::uint32_t>(cell)};
  }
  std::vector<std::uint32_t> place;
  for (const MapAxis& axis : experiment_.axes) {
    place.push_back(static_cast<std::uint32_t>(cell % axis.cells));
    cell /= axis.cells;
  }
  return place;
}

std::string GaitMap::place_text(std::size_t cell) const {
  std::string text;
  for (const std::uint32_t number : place(cell)) {
    text += (text.empty() ? "" : ",") + std::to_string(number + 1);
  }
  return text;
}

std::vector<double> GaitMap::point(std::size_t cell) const {
  if (tessellation_) {
    const std::span<const double> centroid = tessellation_->centroid(cell);
    return {centroid.begin(), centroid.end()};
  }
  std::vector<double> point;
  for (const std::uint32_t number : place(cell)) {
    point.push_back((number + 0.5) / experiment_.axes[point.size()].cells);
  }
  return point;
}

/// Cells that follow each other are neighbours on the first axis.
std::optional<std::size_t> GaitMap::cell_at(std::span<const std::uint32_t> place) const {
  if (tessellation_) {
    return place.size() == 1 && place.front() < cells() ? std::optional<std::size_t>(place.front()) : std::nullopt;
  }
  if (place.size() != experiment_.axes.size()) {
    return std::nullopt;
  }
  std::size_t cell = 0;
  std::size_t stride = 1;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const MapAxis& axis = experiment_.axes[i];
    if (place[i] >= axis.cells) {
      return std::nullopt;
    }
    cell += stride * place[i];
    stride *= axis.cells;
  }
  return cell;
}

std::optional<std::size_t> GaitMap::cell_of(std::span<const double> scores) const {
  if (!std::isfinite(scores.front()) || scores.front() == experiment_.objectives.front().failed) {
    return std::nullopt;
  }
  std::vector<std::uint32_t> place;
  std::vector<double> point;
  for (std::size_t i = 0; i < experiment_.axes.size(); ++i) {
    const MapAxis& axis = experiment_.axes[i];
    const double value = scores[1 + i];
    if (!std::isfinite(value) || value == experiment_.objectives[1 + i].failed) {
      return std::nullopt;
    }
    const double share = (value - axis.lowest) / (axis.highest - axis.lowest);
    if (tessellation_) {
      point.push_back(std::clamp(share, 0.0, 1.0));
    } else {
      place.push_back(static_cast<std::uint32_t>(std::clamp(share * axis.cells, 0.0, axis.cells - 1.0)));
    }
  }
  return tessellation_ ? tessellation_->nearest(point) : cell_at(place);
}

std::vector<double> GaitMap::middle(std::size_t cell) const {
  std::vector<double> values = point(cell);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = std::lerp(experiment_.axes[i].lowest, experiment_.axes[i].highest, values[i]);
  }
  return values;
}

const GaitMap::Elite* GaitMap::elite_of(std::size_t cell) const {
  const std::size_t position = positions_[cell];
  return position == none ? nullptr : &elites_[position];
}

std::vector<GaitMap::Elite> GaitMap::nearest(std::span<const std::optional<double>> values, std::size_t count) const {
  std::vector<std::pair<double, Elite>> order;
  for (const Elite& elite : elites_) {
    order.emplace_back(distance(elite.cell, values), elite);
  }
  const Objective& objective = experiment_.objectives.front();
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::ranges::partial_sort(order, middle, {}, [&](const std::pair<double, Elite>& item) {
    return std::tuple(item.first, objective.cost(item.second.score), item.second.cell);
  });
  std::vector<Elite> nearest;
  for (auto item = order.begin(); item != middle; ++item) {
    nearest.push_back(item->second);
  }
  return nearest;
}

bool GaitMap::are_neighbours(std::size_t cell, std::size_t other) const {
  if (tessellation_) {
    return tessellation_->are_neighbours(cell, other);
  }
  const std::vector<std::uint32_t> a = place(cell);
  const std::vector<std::uint32_t> b = place(other);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::max(a[i], b[i]) - std::min(a[i], b[i]) > 1) {
      return false;
    }
  }
  return true;
}

/// The square of a cell's distance to some values.
double GaitMap::distance(std::size_t cell, std::span<const std::optional<double>> values) const {
  const std::vector<std::uint32_t> its_place = place(cell);
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) {
      continue;
    }
    const MapAxis& axis = experiment_.axes[i];
    const double value = std::clamp((*values[i] - axis.lowest) / (axis.highest - axis.lowest), 0.0, 1.0);
    const double nearest_in_cell = tessellation_ ? tessellation_->centroid(cell)[i]
                                                 : std::clamp(value, static_cast<double>(its_place[i]) / axis.cells,
                                                              (its_place[i] + 1.0) / axis.cells);
    squares += (value - nearest_in_cell) * (value - nearest_in_cell);
  }
  return squares;
}

double GaitMap::gain(double score) const {
  const Objective& objective = experiment_.objectives.front();
  return objective.cost(objective.failed) - objective.cost(score);
}

}  // namespace proleg::optimize
