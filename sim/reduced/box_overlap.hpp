#pragma once

#include <cstddef>

#include "sim/reduced/lanes.hpp"
#include "sim/reduced/space.hpp"
#include "sim/reduced/spatial_memory.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Finds links that are not neighbours and touch each other.
template <int width>
class BoxOverlap {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;

  BoxOverlap(const SpatialForm& form, const SpatialMemory<Number>& memory) : form_(form), m_(memory) {}

  /// As SpatialMemory::overlap.
  [[nodiscard]] Number run() const {
    Number result{};
    const std::size_t boxes = form_.counts.boxes;
    for (std::size_t a = 0; a < boxes; ++a) {
      for (std::size_t b = a + 1; b < boxes; ++b) {
        const BoxForm& first = form_.boxes[a];
        const BoxForm& second = form_.boxes[b];
        if (second.link <= first.link + 1) {
          continue;  // neighbouring links overlap at their joint by construction
        }
        const Vector apart = space_at(m_.link_position, second.link) - space_at(m_.link_position, first.link);
        const double reach = first.radius + second.radius;
        if (!any(dot(apart, apart) < reach * reach)) {
          continue;
        }
        const auto code = static_cast<double>(1 + a + b * boxes);
        result = select((result == 0.0) & overlap(first, second), Lanes<width>::number(code), result);
      }
    }
    return result;
  }

 private:
  [[nodiscard]] Vector turned_with(std::size_t link, const Point3& p) const {
    const Number* turn = m_.link_turn + 9 * link;
    return space_at(turn, 0) * Lanes<width>::number(p.x) + space_at(turn, 1) * Lanes<width>::number(p.y) +
           space_at(turn, 2) * Lanes<width>::number(p.z);
  }

  /// Two boxes are apart if they are apart along a side of one of them, or along a direction that is perpendicular to
  /// an edge of each.
  [[nodiscard]] Mask overlap(const BoxForm& a, const BoxForm& b) const {
    Vector sides[6];
    for (std::size_t i = 0; i < 3; ++i) {
      sides[i] = turned_with(a.link, a.sides[i]);
      sides[3 + i] = turned_with(b.link, b.sides[i]);
    }
    const Vector apart = (space_at(m_.link_position, b.link) + turned_with(b.link, b.center)) -
                         (space_at(m_.link_position, a.link) + turned_with(a.link, a.center));
    Mask result = Lanes<width>::all();
    const auto require_overlap = [&](const Vector& direction) {
      Number reach{};
      for (const Vector& side : sides) {
        reach += magnitude(dot(side, direction));
      }
      result &= magnitude(dot(apart, direction)) <= reach;
    };
    for (std::size_t i = 0; i < 3; ++i) {
      require_overlap(sides[i]);
      require_overlap(sides[3 + i]);
      for (std::size_t k = 3; k < 6; ++k) {
        require_overlap(cross(sides[i], sides[k]));
      }
    }
    return result;
  }

  const SpatialForm& form_;
  const SpatialMemory<Number>& m_;
};

}  // namespace
}  // namespace proleg::sim::reduced
