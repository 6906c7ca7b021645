#pragma once

#include <cstddef>

#include "sim/reduced/lanes.hpp"
#include "sim/reduced/space.hpp"
#include "sim/reduced/spatial_memory.hpp"
#include "sim/reduced/spatial_scratch.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Finds the corners of the boxes that are in the floor. A lane has only its own contacts, one after the other, so that
/// a step costs what the busiest lane needs and not what all need together.
template <int width>
class FloorContact {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;

  FloorContact(const SpatialForm& form, const SpatialMemory<Number>& memory, const SpatialScratch<Number>& scratch)
      : form_(form), m_(memory), s_(scratch), center_(space_at(memory.center, 0)) {}

  /// The links must have been placed. Returns the most contacts of a lane.
  std::size_t run() {
    for (std::size_t link = 0; link < form_.counts.links; ++link) {
      m_.pressed[link] = Number{};
    }
    for (int lane = 0; lane < width; ++lane) {
      found_[lane] = 0;
      old_[lane] = 0;
    }
    if (form_.floor.thickness > 0.0) {
      for (std::size_t box = 0; box < form_.counts.boxes; ++box) {
        search(box);
      }
    }
    std::size_t most = 0;
    for (int lane = 0; lane < width; ++lane) {
      most = found_[lane] > most ? found_[lane] : most;
    }
    return most;
  }

  /// Of each lane.
  [[nodiscard]] Number counts() const {
    Number counts{};
    for (int lane = 0; lane < width; ++lane) {
      counts[lane] = static_cast<double>(found_[lane]);
    }
    return counts;
  }

 private:
  void search(std::size_t number) {
    const BoxForm& box = form_.boxes[number];
    const Number* turn = m_.link_turn + 9 * box.link;  // the z of the axes are 2, 5 and 8
    const auto rise = [&](const Point3& p) { return turn[2] * p.x + turn[5] * p.y + turn[8] * p.z; };
    const Number middle = (m_.link_position[3 * box.link + 2] + center_.z - form_.floor.center.z) + rise(box.center);
    const Number reach = magnitude(rise(box.sides[0])) + magnitude(rise(box.sides[1])) + magnitude(rise(box.sides[2]));
    constexpr double rounding = 1e-9;  // m
    if (!any(middle - reach < rounding)) {
      return;
    }
    const Vector position = space_at(m_.link_position, box.link);
    const Turn<Number> axes{space_at(turn, 0), space_at(turn, 1), space_at(turn, 2)};
    // A link that lies on its flank presses no sensor: beyond 45 degrees.
    constexpr double max_sine = 0.707;
    const Mask can_press = magnitude(rise(form_.links[box.link].sideways)) < max_sine;
    for (std::size_t i = 0; i < corners_of_box; ++i) {
      const CornerForm& corner = box.corners[i];
      const Vector lever = axes * Vector{Lanes<width>::number(corner.point.x), Lanes<width>::number(corner.point.y),
                                         Lanes<width>::number(corner.point.z)};
      const Vector arm = position + lever;
      const Number depth = form_.floor.center.z - (center_.z + arm.z);
      if (!any(depth > 0.0)) {
        continue;
      }
      const Mask touches = (depth > 0.0) & (depth < form_.floor.thickness) & is_over_floor(arm);
      if (!any(touches)) {
        continue;
      }
      for (int lane = 0; lane < width; ++lane) {
        if (touches[lane] != 0) {
          add(lane, number, corners_of_box * number + i, arm, lever, depth);
          if (can_press[lane] != 0) {
            press(box.link, lane, corner.sensor);
          }
        }
      }
    }
  }

  [[nodiscard]] Mask is_over_floor(const Vector& arm) const {
    const FloorForm& floor = form_.floor;
    const Number x = center_.x + arm.x - floor.center.x;
    const Number y = center_.y + arm.y - floor.center.y;
    return (magnitude(x * floor.along.x + y * floor.along.y) < floor.half_length) &
           (magnitude(y * floor.along.x - x * floor.along.y) < floor.half_width);
  }

  void add(int lane, std::size_t box, std::size_t corner, const Vector& arm, const Vector& lever, const Number& depth) {
    const std::size_t contact = found_[lane]++;
    s_.link[contact][lane] = static_cast<double>(form_.boxes[box].link);
    s_.corner[contact][lane] = static_cast<double>(corner);
    s_.arm[3 * contact][lane] = arm.x[lane];
    s_.arm[3 * contact + 1][lane] = arm.y[lane];
    s_.arm[3 * contact + 2][lane] = arm.z[lane];
    s_.lever[3 * contact][lane] = lever.x[lane];
    s_.lever[3 * contact + 1][lane] = lever.y[lane];
    s_.lever[3 * contact + 2][lane] = lever.z[lane];
    s_.depth_speed[contact][lane] = depth[lane];
    s_.friction[contact][lane] = m_.friction[box][lane];
    take_old_impulse(lane, contact, static_cast<double>(corner));
  }

  void press(std::size_t link, int lane, int sensor) {
    m_.pressed[link][lane] = static_cast<double>(static_cast<int>(m_.pressed[link][lane]) | sensor);
  }

  /// Both steps have their contacts in the order of corners.
  void take_old_impulse(int lane, std::size_t contact, double corner) {
    const auto count = static_cast<std::size_t>(m_.contact_count[0][lane]);
    std::size_t& old = old_[lane];
    while (old < count && m_.contact_corner[old][lane] < corner) {
      ++old;
    }
    const bool is_old = old < count && m_.contact_corner[old][lane] == corner;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      s_.old_impulse[3 * contact + axis][lane] = is_old ? m_.impulse[3 * old + axis][lane] : 0.0;
    }
  }

  const SpatialForm& form_;
  const SpatialMemory<Number>& m_;
  const SpatialScratch<Number>& s_;
  Vector center_;
  std::size_t found_[static_cast<unsigned>(width)];
  std::size_t old_[static_cast<unsigned>(width)];  ///< number of the first contact of the last step that may come again
};

}  // namespace
}  // namespace proleg::sim::reduced
