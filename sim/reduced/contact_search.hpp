#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/outline_contact.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Finds the contacts of the links with the terrain and with each other. A lane has only its own contacts, one after
/// the other, so that a step costs what the busiest lane needs and not what all need together.
template <int width>
class ContactSearch {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;

  ContactSearch(const ChainForm& form, const ChainMemory<Number>& memory, const ChainScratch<Number>& scratch)
      : form_(form), m_(memory), s_(scratch) {}

  /// The links must have been placed. Returns the most contacts of a lane.
  std::size_t run() {
    for (std::size_t link = 0; link < form_.counts.links; ++link) {
      m_.pressed[link] = Number{};
    }
    for (int lane = 0; lane < width; ++lane) {
      found_[lane] = 0;
      old_[lane] = 0;
    }
    for (std::size_t shape = 0; shape < form_.counts.shapes; ++shape) {
      search_terrain(shape);
    }
    if (form_.self_collision) {
      for (std::size_t shape = 0; shape < form_.counts.shapes; ++shape) {
        search_links(shape);
      }
    }
    std::size_t most = 0;
    for (int lane = 0; lane < width; ++lane) {
      most = found_[lane] > most ? found_[lane] : most;
    }
    for (int lane = 0; lane < width; ++lane) {
      for (std::size_t contact = found_[lane]; contact < most; ++contact) {
        clear(contact, lane);
      }
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
  /// m, far more than rounding errors: what is farther apart than this cannot touch.
  static constexpr double rounding_reach = 1e-6;

  /// Half of what a rectangle covers along x.
  [[nodiscard]] static double half_span(const Rectangle& rectangle) {
    const double along_x = rectangle.along.x < 0.0 ? -rectangle.along.x : rectangle.along.x;
    const double along_z = rectangle.along.z < 0.0 ? -rectangle.along.z : rectangle.along.z;
    return along_x * rectangle.half_length + along_z * rectangle.half_height;
  }

  [[nodiscard]] Plane<Number> position_of(std::size_t link) const {
    return {m_.link_position[2 * link], m_.link_position[2 * link + 1]};
  }
  [[nodiscard]] Plane<Number> turned_with(std::size_t link, const Point& point) const {
    return {s_.cosine[link] * point.x - s_.sine[link] * point.z, s_.sine[link] * point.x + s_.cosine[link] * point.z};
  }
  /// Of a shape, from the centre.
  [[nodiscard]] Outline<width> outline_of(const ShapeForm& shape) const {
    return {position_of(shape.link) + turned_with(shape.link, shape.outline.center),
            turned_with(shape.link, shape.outline.along), Lanes<width>::number(shape.outline.half_length),
            Lanes<width>::number(shape.outline.half_height)};
  }

  void search_terrain(std::size_t number) {
    const ShapeForm& shape = form_.shapes[number];
    const Plane<Number> center{m_.center[0], m_.center[1]};
    const Number link_x = position_of(shape.link).x;
    const Outline<width> outline = outline_of(shape);
    for (std::size_t solid = 0; solid < form_.counts.solids; ++solid) {
      const Rectangle& rectangle = form_.terrain[solid];
      const Number ground_x = rectangle.center.x - center.x;
      const double reach = shape.radius + half_span(rectangle) + rounding_reach;
      const Number apart = link_x - ground_x;
      if (!any(apart * apart < Lanes<width>::number(reach * reach))) {
        continue;
      }
      const Outline<width> ground{Plane<Number>{ground_x, rectangle.center.z - center.z},
                                  {Lanes<width>::number(rectangle.along.x), Lanes<width>::number(rectangle.along.z)},
                                  Lanes<width>::number(rectangle.half_length),
                                  Lanes<width>::number(rectangle.half_height)};
      Touch<width> touch;
      if (find_touch<width>(outline, ground, touch)) {
        const std::size_t pair = number * form_.counts.solids + solid;
        add(touch, pair, m_.terrain_friction[pair], shape.link, -1);
      }
    }
  }

  void search_links(std::size_t number) {
    const ShapeForm& shape = form_.shapes[number];
    for (std::size_t other_number = number + 1; other_number < form_.counts.shapes; ++other_number) {
      const ShapeForm& other = form_.shapes[other_number];
      if (other.link <= shape.link + 1) {
        continue;  // neighbouring links overlap at their joint by construction
      }
      const Plane<Number> apart = position_of(other.link) - position_of(shape.link);
      const double reach = shape.radius + other.radius;
      if (!any(dot(apart, apart) < Lanes<width>::number(reach * reach))) {
        continue;
      }
      Touch<width> touch;
      if (find_touch<width>(outline_of(shape), outline_of(other), touch)) {
        const std::size_t pair = number * form_.counts.shapes + other_number;
        add(touch, form_.counts.shapes * form_.counts.solids + pair, m_.self_friction[pair], shape.link,
            static_cast<int>(other.link));
      }
    }
  }

  /// other: -1: the terrain.
  void add(const Touch<width>& touch, std::size_t pair, Number friction, std::size_t link, int other) {
    const Plane<Number> middle = position_of(link);
    const Plane<Number> forward = turned_with(link, form_.links[link].forward);
    const Plane<Number> down = turned_with(link, form_.links[link].down);
    for (int point = 0; point < 2; ++point) {
      const Mask touches = touch.depths[point] > 0.0;
      if (!any(touches)) {
        continue;
      }
      const Plane<Number> from_middle = touch.points[point] - middle;
      const Number ahead = dot(from_middle, forward);
      const Number below = dot(from_middle, down);
      const Number key = touch.corners[point] + static_cast<double>(pair) * 8.0;
      for (int lane = 0; lane < width; ++lane) {
        if (touches[lane] == 0) {
          continue;
        }
        if (found_[lane] == form_.counts.contacts) {
          m_.failed[0][lane] = too_many_contacts;
          continue;
        }
        const std::size_t contact = found_[lane]++;
        s_.link[contact][lane] = static_cast<double>(link);
        s_.other_link[contact][lane] = other;
        s_.arm[2 * contact][lane] = touch.points[point].x[lane];
        s_.arm[2 * contact + 1][lane] = touch.points[point].z[lane];
        s_.normal[2 * contact][lane] = touch.normal.x[lane];
        s_.normal[2 * contact + 1][lane] = touch.normal.z[lane];
        s_.depth_speed[contact][lane] = touch.depths[point][lane];
        s_.friction[contact][lane] = friction[lane];
        s_.key[contact][lane] = key[lane];
        take_old_impulses(lane, contact, static_cast<double>(pair) * 8.0, key[lane]);
        if (other < 0 && below[lane] > 0.0) {
          press(link, lane, ahead[lane] < 0.0 ? 1 : 2);
        }
      }
    }
  }

  /// A contact that only other lanes have. What another chain has left in the scratch memory may be no number, and
  /// then 0 times it is none either.
  void clear(std::size_t contact, int lane) {
    for (std::size_t i = 2 * contact; i < 2 * contact + 2; ++i) {
      s_.arm[i][lane] = 0.0;
      s_.normal[i][lane] = 0.0;
    }
    Number* const arrays[] = {s_.link, s_.other_link, s_.depth_speed, s_.friction,
                              s_.key,  s_.old_normal, s_.old_friction};
    for (Number* const array : arrays) {
      array[contact][lane] = 0.0;
    }
  }

  void press(std::size_t link, int lane, int sensor) {
    m_.pressed[link][lane] = static_cast<double>(static_cast<int>(m_.pressed[link][lane]) | sensor);
  }

  /// Both steps have their contacts in the same order of pairs.
  void take_old_impulses(int lane, std::size_t contact, double first_key_of_pair, double key) {
    const auto count = static_cast<std::size_t>(m_.contact_count[0][lane]);
    std::size_t& old = old_[lane];
    while (old < count && m_.contact_key[old][lane] < first_key_of_pair) {
      ++old;
    }
    s_.old_normal[contact][lane] = 0.0;
    s_.old_friction[contact][lane] = 0.0;
    for (std::size_t candidate = old; candidate < count && m_.contact_key[candidate][lane] < first_key_of_pair + 8.0;
         ++candidate) {
      if (m_.contact_key[candidate][lane] == key) {
        s_.old_normal[contact][lane] = m_.normal_impulse[candidate][lane];
        s_.old_friction[contact][lane] = m_.friction_impulse[candidate][lane];
      }
    }
  }

  const ChainForm& form_;
  const ChainMemory<Number>& m_;
  const ChainScratch<Number>& s_;
  std::size_t found_[static_cast<unsigned>(width)];
  std::size_t old_[static_cast<unsigned>(width)];  ///< number of the first contact of the last step that may come again
};

}  // namespace
}  // namespace proleg::sim::reduced
