#pragma once

#include "sim/reduced/chain_form.hpp"
#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// A Rectangle in each lane.
template <int width>
struct Outline {
  using Number = typename Lanes<width>::Number;
  Plane<Number> corners[4];
  Plane<Number> normals[4];
};

template <int width>
inline Outline<width> in_all_lanes(const Rectangle& rectangle) {
  Outline<width> outline;
  for (int k = 0; k < 4; ++k) {
    outline.corners[k] = {Lanes<width>::number(rectangle.corners[k].x), Lanes<width>::number(rectangle.corners[k].z)};
    outline.normals[k] = {Lanes<width>::number(rectangle.normals[k].x), Lanes<width>::number(rectangle.normals[k].z)};
  }
  return outline;
}

/// How two outlines touch: where the side of one of them is least deep in the other one, and up to two points of the
/// other one that are behind this side.
template <int width>
struct Touch {
  using Number = typename Lanes<width>::Number;
  Plane<Number> normal;  ///< unit vector out of the second outline, into the first
  Plane<Number> points[2];
  Number depths[2];   ///< m; a point touches where its depth is above 0
  Number corners[2];  ///< which corner a point comes from, 0 to 3; 4 more if it is one of the second outline
};

/// The side of an outline that is least deep in another one.
template <int width>
struct Side {
  using Number = typename Lanes<width>::Number;
  Number distance;       ///< of the other outline's nearest corner from the side, m; negative: behind it
  Plane<Number> normal;  ///< outward
  Plane<Number> start;
  Plane<Number> end;
};

/// Whether the other outline is behind all sides in some lane; then also the least deep one.
template <int width>
inline bool find_least_deep_side(const Outline<width>& outline, const Outline<width>& other, Side<width>& best) {
  using Number = typename Lanes<width>::Number;
  for (int k = 0; k < 4; ++k) {
    const Plane<Number>& normal = outline.normals[k];
    Number nearest = dot(normal, other.corners[0]);
    for (int corner = 1; corner < 4; ++corner) {
      nearest = smaller(nearest, dot(normal, other.corners[corner]));
    }
    const Number distance = nearest - dot(normal, outline.corners[k]);
    const Plane<Number>& end = outline.corners[(k + 1) % 4];
    if (k == 0) {
      best = {distance, normal, outline.corners[0], end};
    } else {
      const auto is_better = distance > best.distance;
      best.distance = select(is_better, distance, best.distance);
      best.normal = select(is_better, normal, best.normal);
      best.start = select(is_better, outline.corners[k], best.start);
      best.end = select(is_better, end, best.end);
    }
    if (!any(best.distance < 0.0)) {
      return false;
    }
  }
  return true;
}

/// Puts up to two points of `other` that are behind a side of the outline into `touch`.
template <int width>
inline void find_points(const Side<width>& side, const Outline<width>& other, Touch<width>& touch) {
  using Number = typename Lanes<width>::Number;
  // The side of the other outline that faces this side.
  Number facing = dot(side.normal, other.normals[0]);
  Plane<Number> first = other.corners[0];
  Plane<Number> second = other.corners[1];
  Number corner = Lanes<width>::number(0.0);
  for (int k = 1; k < 4; ++k) {
    const Number candidate = dot(side.normal, other.normals[k]);
    const auto is_better = candidate < facing;
    facing = select(is_better, candidate, facing);
    first = select(is_better, other.corners[k], first);
    second = select(is_better, other.corners[(k + 1) % 4], second);
    corner = select(is_better, Lanes<width>::number(k), corner);
  }
  const Number next = corner + 1.0;
  touch.corners[0] = corner;
  touch.corners[1] = select(next > 3.0, Lanes<width>::number(0.0), next);
  // It is cut where this side ends. Along this side the first point is the farther one.
  const Plane<Number> along = turned(side.normal);
  const Number from = dot(along, first);
  const Number to = dot(along, second);
  const Number length = larger(from - to, Lanes<width>::number(1e-12));
  const Number none = Lanes<width>::number(0.0);
  const Number whole = Lanes<width>::number(1.0);
  const Number cut_first = bounded((from - dot(along, side.end)) / length, none, whole);
  const Number cut_second = bounded((dot(along, side.start) - to) / length, none, whole);
  touch.points[0] = first + (second - first) * cut_first;
  touch.points[1] = second + (first - second) * cut_second;
  for (int point = 0; point < 2; ++point) {
    touch.depths[point] = dot(side.normal, side.start - touch.points[point]);
  }
}

/// Whether the outlines touch in any lane; then also how. In a lane in which they do not, no depth is above 0.
template <int width>
inline bool find_touch(const Outline<width>& first, const Outline<width>& second, Touch<width>& touch) {
  using Number = typename Lanes<width>::Number;
  Side<width> of_first;
  Side<width> of_second;
  if (!find_least_deep_side<width>(second, first, of_second) || !find_least_deep_side<width>(first, second, of_first)) {
    return false;
  }
  const auto touching = (of_first.distance < 0.0) & (of_second.distance < 0.0);
  // A side of the second outline wins if both are nearly as deep, so the choice does not change with the last bit.
  const auto is_of_first = of_first.distance > of_second.distance * 0.95 + 1e-5;
  find_points<width>(of_second, first, touch);
  touch.normal = of_second.normal;
  if (any(is_of_first)) {
    Touch<width> other;
    find_points<width>(of_first, second, other);
    touch.normal = select(is_of_first, Plane<Number>{-of_first.normal.x, -of_first.normal.z}, touch.normal);
    for (int point = 0; point < 2; ++point) {
      touch.points[point] = select(is_of_first, other.points[point], touch.points[point]);
      touch.depths[point] = select(is_of_first, other.depths[point], touch.depths[point]);
      touch.corners[point] = select(is_of_first, other.corners[point] + 4.0, touch.corners[point]);
    }
  }
  for (Number& depth : touch.depths) {
    depth = select(touching, depth, Lanes<width>::number(0.0));
  }
  return true;
}

}  // namespace
}  // namespace proleg::sim::reduced
