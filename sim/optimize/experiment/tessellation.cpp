#include "sim/optimize/experiment/tessellation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace proleg::optimize {
namespace {

constexpr std::size_t rounds = 10;
constexpr std::size_t points_in_all = 10'000;
constexpr std::size_t points_of_each = 10;

/// A coordinate of a point of the Halton sequence: the digits of `index` to a base, mirrored at the point.
double mirrored(std::size_t index, std::size_t base) {
  double value = 0.0;
  double place = 1.0;
  for (; index > 0; index /= base) {
    place /= static_cast<double>(base);
    value += place * static_cast<double>(index % base);
  }
  return value;
}

std::vector<double> halton_points(std::size_t dimensions, std::size_t count) {
  constexpr std::array<std::size_t, 4> bases{2, 3, 5, 7};
  std::vector<double> points;
  for (std::size_t i = 1; i <= count; ++i) {
    for (std::size_t axis = 0; axis < dimensions; ++axis) {
      points.push_back(mirrored(i, bases[axis]));
    }
  }
  return points;
}

double squared_distance(std::span<const double> one, std::span<const double> other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    sum += (one[i] - other[i]) * (one[i] - other[i]);
  }
  return sum;
}

using Corner = std::array<double, 2>;

/// The part of a convex polygon that is nearer to one point than to another.
std::vector<Corner> part_nearer_to(std::span<const double> own, std::span<const double> other,
                                   const std::vector<Corner>& polygon) {
  const auto beyond = [&](const Corner& corner) {
    return squared_distance(own, corner) - squared_distance(other, corner);
  };
  std::vector<Corner> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& from = polygon[i];
    const Corner& to = polygon[(i + 1) % polygon.size()];
    const double at_from = beyond(from);
    const double at_to = beyond(to);
    if (at_from <= 0.0) {
      part.push_back(from);
    }
    if ((at_from < 0.0 && at_to > 0.0) || (at_from > 0.0 && at_to < 0.0)) {
      const double share = at_from / (at_from - at_to);
      part.push_back({std::lerp(from[0], to[0], share), std::lerp(from[1], to[1], share)});
    }
  }
  return part;
}

}  // namespace

struct Tessellation::Found {
  std::size_t number = 0;
  double squared_distance = std::numeric_limits<double>::infinity();
};

Tessellation::Tessellation(std::size_t dimensions, std::size_t count)
    : dimensions_(dimensions), coordinates_(halton_points(dimensions, count)), tree_(count) {
  std::iota(tree_.begin(), tree_.end(), std::size_t{0});
  const std::vector<double> points = halton_points(dimensions, points_in_all + points_of_each * count);
  for (std::size_t round = 0; round < rounds; ++round) {
    make_tree(0, count, 0);
    std::vector<double> sums(coordinates_.size());
    std::vector<std::size_t> members(count);
    for (std::size_t start = 0; start < points.size(); start += dimensions) {
      const std::span<const double> point = std::span(points).subspan(start, dimensions);
      const std::size_t number = nearest(point);
      ++members[number];
      for (std::size_t axis = 0; axis < dimensions; ++axis) {
        sums[number * dimensions + axis] += point[axis];
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const std::size_t its_members = members[i / dimensions];
      coordinates_[i] = its_members == 0 ? coordinates_[i] : sums[i] / static_cast<double>(its_members);
    }
  }
  make_tree(0, count, 0);
}

std::size_t Tessellation::nearest(std::span<const double> point) const {
  Found best;
  search(0, tree_.size(), 0, point, best);
  return best.number;
}

bool Tessellation::are_neighbours(std::size_t one, std::size_t other) const {
  std::vector<double> middle;
  for (std::size_t axis = 0; axis < dimensions_; ++axis) {
    middle.push_back((centroid(one)[axis] + centroid(other)[axis]) / 2.0);
  }
  const std::size_t owner = nearest(middle);
  return owner == one || owner == other;
}

std::vector<std::array<double, 2>> Tessellation::corners(std::size_t number) const {
  const std::span<const double> own = centroid(number);
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t other = 0; other < count(); ++other) {
    if (other != number) {
      others.emplace_back(squared_distance(own, centroid(other)), other);
    }
  }
  // From the nearest on. One that is more than twice as far away as the farthest corner cuts nothing off.
  std::ranges::make_heap(others, std::greater<>());
  std::vector<Corner> cell{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  while (!others.empty()) {
    std::ranges::pop_heap(others, std::greater<>());
    const auto [distance, other] = others.back();
    others.pop_back();
    double farthest = 0.0;
    for (const Corner& corner : cell) {
      farthest = std::max(farthest, squared_distance(own, corner));
    }
    if (distance > 4.0 * farthest) {
      break;
    }
    cell = part_nearer_to(own, centroid(other), cell);
  }
  return cell;
}

void Tessellation::make_tree(std::size_t first, std::size_t end, std::size_t depth) {
  if (end - first < 2) {
    return;
  }
  const std::size_t middle = first + (end - first) / 2;
  const auto at = [this](std::size_t place) { return tree_.begin() + static_cast<std::ptrdiff_t>(place); };
  std::nth_element(at(first), at(middle), at(end), [&](std::size_t a, std::size_t b) {
    return centroid(a)[depth % dimensions_] < centroid(b)[depth % dimensions_];
  });
  make_tree(first, middle, depth + 1);
  make_tree(middle + 1, end, depth + 1);
}

void Tessellation::search(std::size_t first, std::size_t end, std::size_t depth, std::span<const double> point,
                          Found& best) const {
  if (first == end) {
    return;
  }
  const std::size_t middle = first + (end - first) / 2;
  const std::size_t number = tree_[middle];
  const double distance = squared_distance(point, centroid(number));
  if (distance < best.squared_distance || (distance == best.squared_distance && number < best.number)) {
    best = {number, distance};
  }
  const double beyond = point[depth % dimensions_] - centroid(number)[depth % dimensions_];
  const auto below = [&] { search(first, middle, depth + 1, point, best); };
  const auto above = [&] { search(middle + 1, end, depth + 1, point, best); };
  if (beyond < 0.0) {
    below();
  } else {
    above();
  }
  if (beyond * beyond <= best.squared_distance) {
    if (beyond < 0.0) {
      above();
    } else {
      below();
    }
  }
}

}  // namespace proleg::optimize
