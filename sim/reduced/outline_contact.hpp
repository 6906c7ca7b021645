#pragma once

#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// A Rectangle in each lane, in its place. Its sides are numbered as they follow each other when x turns towards z,
/// from the one below: 0 below, 1 ahead, 2 above, 3 behind (with `along` ahead). Corner k is at the start of side k.
template <int width>
struct Outline {
  using Number = typename Lanes<width>::Number;
  Plane<Number> center;
  Plane<Number> along;  ///< unit vector
  Number half_length;   ///< m, along it
  Number half_height;   ///< m, across it
};

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
  Number distance;       ///< distance of the other outline's nearest corner from the side, m; negative: behind it
  Plane<Number> normal;  ///< outward
  Plane<Number> middle;
  Number half;  ///< m: half its length
};

/// Half the extent of an outline in a direction, m.
template <int width>
inline typename Lanes<width>::Number half_extent(const Outline<width>& outline,
                                                 const Plane<typename Lanes<width>::Number>& direction) {
  return magnitude(dot(outline.along, direction)) * outline.half_length +
         magnitude(cross(outline.along, direction)) * outline.half_height;
}

/// Whether the other outline is behind all sides in some lane; then also the least deep one.
template <int width>
inline bool find_least_deep_side(const Outline<width>& outline, const Outline<width>& other, Side<width>& best) {
  using Number = typename Lanes<width>::Number;
  const Plane<Number> apart = other.center - outline.center;
  const Plane<Number> up = turned(outline.along);
  // Of two opposite sides, the one that faces the other outline is less deep.
  const Number height = dot(apart, up);
  const Number above = magnitude(height) - outline.half_height - half_extent<width>(other, up);
  if (!any(above < 0.0)) {
    return false;
  }
  const Number length = dot(apart, outline.along);
  const Number ahead = magnitude(length) - outline.half_length - half_extent<width>(other, outline.along);
  if (!any((above < 0.0) & (ahead < 0.0))) {
    return false;
  }
  const auto is_ahead = ahead > above;
  const auto is_back = select(is_ahead, length, height) < 0.0;
  best.distance = select(is_ahead, ahead, above);
  best.normal = select(is_ahead, outline.along, up);
  best.normal = select(is_back, Plane<Number>{} - best.normal, best.normal);
  best.middle = outline.center + best.normal * select(is_ahead, outline.half_length, outline.half_height);
  best.half = select(is_ahead, outline.half_height, outline.half_length);
  return true;
}

/// Puts up to two points of `other` that are behind a side of the outline into `touch`.
template <int width>
inline void find_points(const Side<width>& side, const Outline<width>& other, Touch<width>& touch) {
  using Number = typename Lanes<width>::Number;
  const auto number = [](double value) { return Lanes<width>::number(value); };
  // The side of the other outline that faces this side.
  const Plane<Number> up = turned(other.along);
  const Number with_along = dot(side.normal, other.along);
  const Number with_up = dot(side.normal, up);
  const auto is_end = magnitude(with_along) > magnitude(with_up);
  const auto is_back = select(is_end, with_along, with_up) > 0.0;
  Plane<Number> normal = select(is_end, other.along, up);
  normal = select(is_back, Plane<Number>{} - normal, normal);
  const Number distance = select(is_end, other.half_length, other.half_height);
  const Number half = select(is_end, other.half_height, other.half_length);
  const Plane<Number> middle = other.center + normal * distance;
  const Plane<Number> facing_along = turned(normal);
  const Plane<Number> first = middle - facing_along * half;
  const Plane<Number> second = middle + facing_along * half;
  const Number corner =
      select(is_end, select(is_back, number(3.0), number(1.0)), select(is_back, number(0.0), number(2.0)));
  touch.corners[0] = corner;
  touch.corners[1] = select(corner == 3.0, number(0.0), corner + 1.0);
  // It is cut where this side ends. Along this side the first point is the farther one.
  const Plane<Number> along = turned(side.normal);
  const Number from = dot(along, first - side.middle);
  const Number to = dot(along, second - side.middle);
  const Number inverse = 1.0 / larger(from - to, number(1e-12));
  const Number cut_first = bounded((from - side.half) * inverse, number(0.0), number(1.0));
  const Number cut_second = bounded((-side.half - to) * inverse, number(0.0), number(1.0));
  touch.points[0] = first + (second - first) * cut_first;
  touch.points[1] = second + (first - second) * cut_second;
  for (int point = 0; point < 2; ++point) {
    touch.depths[point] = dot(side.normal, side.middle - touch.points[point]);
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
  if (!any(touching)) {
    return false;
  }
  // A side of the second outline wins if both are nearly as deep, so the choice does not change with the last bit.
  const auto is_of_first = of_first.distance > of_second.distance * 0.95 + 1e-5;
  find_points<width>(of_second, first, touch);
  touch.normal = of_second.normal;
  if (any(is_of_first & touching)) {
    Touch<width> other;
    find_points<width>(of_first, second, other);
    touch.normal = select(is_of_first, Plane<Number>{} - of_first.normal, touch.normal);
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
