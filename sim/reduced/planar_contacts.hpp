#pragma once

#include <cstddef>

#include "sim/reduced/contact_list.hpp"
#include "sim/reduced/outline_contact.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// Contacts of links with the terrain and with each other.
template <int width>
class Contacts<Planar, width> : public ContactList<Planar, width> {
  using Base = ContactList<Planar, width>;
  using Base::form_;
  using Base::m_;
  using Base::s_;
  using Base::stride_;

 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Plane<Number>;
  using Base::has;
  using Base::most;

  Contacts(const ChainForm<Planar>& form, const ChainMemory<Planar, Number>& memory,
           const ChainScratch<Planar, Number>& scratch)
      : Base(form, memory, scratch) {}

  /// Finds the contacts. The links must have been placed.
  void find() {
    Base::start();
    for (std::size_t shape = 0; shape < form_.counts.shapes; ++shape) {
      search_terrain(shape);
    }
    if (form_.self_collision) {
      for (std::size_t shape = 0; shape < form_.counts.shapes; ++shape) {
        search_links(shape);
      }
    }
    Base::count([&](std::size_t k, Mask lanes) {
      put_where(lanes, s_.other_link[k], Lanes<width>::number(-1.0));
      put_where(lanes, s_.normal, k, Vector{});
    });
    free_joints_between_links();
  }

  /// Computes directions, given speeds and the Jacobian of the rotation of all rows. The drift must be known.
  void set_rows() const {
    for (std::size_t k = 0; k < most(); ++k) {
      const Vector arm = at<Vector>(s_.arm, k);
      const Vector normal = at<Vector>(s_.normal, k);
      const Vector given = velocity_at(k, arm);
      const Number ground = select(is_terrain(k), Lanes<width>::number(1.0), Number{});
      const Vector directions[] = {{normal.z, -normal.x}, normal};
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const std::size_t row = 2 * k + axis;
        put(s_.direction, row, directions[axis] * ground);
        s_.given[row] = dot(directions[axis], given);
        s_.jacobian[row * stride_] = cross(arm, directions[axis]) * ground;
      }
    }
  }

  // Row `axis` of contact k: 0 friction, 1 normal.

  /// The speed along the row but for what the free joints add, m/s.
  template <std::size_t axis>
  [[nodiscard]] Number speed_along(std::size_t k, const Motion<Planar, Number>& v) const {
    return (s_.given[2 * k + axis] + turning<axis>(k) * v.rotation) + dot(direction<axis>(k), v.center);
  }
  /// The Jacobian of the rotation.
  template <std::size_t axis>
  [[nodiscard]] Number turning(std::size_t k) const {
    return s_.jacobian[(2 * k + axis) * stride_];
  }
  /// The speed that an impulse of 1 Ns gives, by the motion of the centre.
  template <std::size_t axis>
  [[nodiscard]] Number center_mobility(std::size_t k) const {
    return dot(direction<axis>(k), direction<axis>(k)) * m_.inverse_mass[0];
  }
  /// speed: what a free mass would get from the impulse.
  template <std::size_t axis>
  void push_center(std::size_t k, const Number& speed, Motion<Planar, Number>& v) const {
    v.center = v.center + direction<axis>(k) * speed;
  }

  void sum_impulses() const {}
  /// Adds the momenta that link i gains, less what its contacts give. own: the angular momentum about its centre of
  /// mass; as_point: that of its centre of mass.
  void add_link(std::size_t i, const Vector& gain, Number own, Number as_point, Vector& linear, Number& angular) const {
    linear = linear + gain;
    angular = with_link(angular, own, as_point);
    const auto link = static_cast<double>(i);
    for (std::size_t k = 0; k < most(); ++k) {
      const Mask is_link = s_.link[k] == link;
      const Mask is_other = s_.other_link[k] == link;
      if (!any(is_link | is_other)) {
        continue;
      }
      const Vector normal = at<Vector>(s_.normal, k);
      const Vector value = at<Vector>(s_.value, k);
      const Vector impulse = normal * value.z + Vector{normal.z, -normal.x} * value.x;
      const Vector own_impulse = select(is_link, impulse, select(is_other, Vector{} - impulse, Vector{}));
      const Vector felt = select(has(k), own_impulse, Vector{});
      linear = linear - felt;
      angular -= cross(at<Vector>(s_.arm, k), felt);
    }
  }

  /// Keeps the results of the lanes that are done. Sliding speeds must be in ChainScratch::given.
  void keep(Mask done) const {
    Base::keep_contacts(done, [&](std::size_t k, const Vector& impulse, double steps_per_s) {
      const Number speed = magnitude(s_.given[2 * k]);
      return typename Base::Slide{is_terrain(k), speed, magnitude(impulse.x) * steps_per_s * speed};
    });
    sum_forces(done);
  }

 private:
  /// m, far more than rounding errors: what is farther apart than this cannot touch.
  static constexpr double rounding_reach = 1e-6;

  [[nodiscard]] Mask is_terrain(std::size_t k) const { return s_.other_link[k] < 0.0; }
  template <std::size_t axis>
  [[nodiscard]] Vector direction(std::size_t k) const {
    return at<Vector>(s_.direction, 2 * k + axis);
  }

  /// Half of what a rectangle covers along x.
  [[nodiscard]] static double half_span(const Rectangle& rectangle) {
    const double along_x = rectangle.along.x < 0.0 ? -rectangle.along.x : rectangle.along.x;
    const double along_z = rectangle.along.z < 0.0 ? -rectangle.along.z : rectangle.along.z;
    return along_x * rectangle.half_length + along_z * rectangle.half_height;
  }

  [[nodiscard]] Vector position_of(std::size_t link) const { return at<Vector>(m_.link_position, link); }
  [[nodiscard]] Vector turned_with(std::size_t link, const Point& point) const {
    return {s_.cosine[link] * point.x - s_.sine[link] * point.z, s_.sine[link] * point.x + s_.cosine[link] * point.z};
  }
  /// The outline of a shape, from the centre.
  [[nodiscard]] Outline<width> outline_of(const Planar::Shape& shape) const {
    return {position_of(shape.link) + turned_with(shape.link, shape.outline.center),
            turned_with(shape.link, shape.outline.along), Lanes<width>::number(shape.outline.half_length),
            Lanes<width>::number(shape.outline.half_height)};
  }

  void search_terrain(std::size_t number) {
    const Planar::Shape& shape = form_.shapes[number];
    const Vector center = at<Vector>(m_.center, 0);
    const Number link_x = position_of(shape.link).x;
    const Outline<width> outline = outline_of(shape);
    for (std::size_t solid = 0; solid < form_.counts.solids; ++solid) {
      const Rectangle& rectangle = form_.solids[solid];
      const Number ground_x = rectangle.center.x - center.x;
      const double reach = shape.radius + half_span(rectangle) + rounding_reach;
      const Number apart = link_x - ground_x;
      if (!any(apart * apart < Lanes<width>::number(reach * reach))) {
        continue;
      }
      const Outline<width> ground{Vector{ground_x, rectangle.center.z - center.z},
                                  {Lanes<width>::number(rectangle.along.x), Lanes<width>::number(rectangle.along.z)},
                                  Lanes<width>::number(rectangle.half_length),
                                  Lanes<width>::number(rectangle.half_height)};
      Touch<width> touch;
      if (find_touch<width>(outline, ground, touch)) {
        add(touch, number * form_.counts.solids + solid, shape.link, -1);
      }
    }
  }

  void search_links(std::size_t number) {
    const Planar::Shape& shape = form_.shapes[number];
    for (std::size_t other_number = number + 1; other_number < form_.counts.shapes; ++other_number) {
      const Planar::Shape& other = form_.shapes[other_number];
      if (other.link <= shape.link + 1) {
        continue;  // neighbouring links overlap at their joint by construction
      }
      const Vector apart = position_of(other.link) - position_of(shape.link);
      const double reach = shape.radius + other.radius;
      if (!any(dot(apart, apart) < Lanes<width>::number(reach * reach))) {
        continue;
      }
      Touch<width> touch;
      if (find_touch<width>(outline_of(shape), outline_of(other), touch)) {
        add(touch, form_.counts.shapes * (form_.counts.solids + number) + other_number, shape.link,
            static_cast<int>(other.link));
      }
    }
  }

  /// pair: its number in ChainModel::friction. other: -1: the terrain.
  void add(const Touch<width>& touch, std::size_t pair, std::size_t link, int other) {
    const Vector middle = position_of(link);
    const Vector forward = turned_with(link, form_.links[link].forward);
    const Vector down = turned_with(link, form_.links[link].down);
    const double first_key = static_cast<double>(pair) * Planar::contact_keys;
    for (int point = 0; point < 2; ++point) {
      const Mask touches = touch.depths[point] > 0.0;
      if (!any(touches)) {
        continue;
      }
      const Vector from_middle = touch.points[point] - middle;
      const Number ahead = dot(from_middle, forward);
      const Number below = dot(from_middle, down);
      const Number key = touch.corners[point] + first_key;
      for (int lane = 0; lane < width; ++lane) {
        if (touches[lane] == 0) {
          continue;
        }
        if (Base::is_full(lane)) {
          m_.failed[0][lane] = too_many_contacts;
          continue;
        }
        const std::size_t contact =
            Base::add(lane, link, first_key, key[lane], touch.points[point], touch.depths[point], m_.friction[pair]);
        s_.other_link[contact][lane] = other;
        put_lane(s_.normal, contact, lane, touch.normal);
        if (other < 0 && below[lane] > 0.0) {
          Base::press(link, lane, ahead[lane] < 0.0 ? 1 : 2);
        }
      }
    }
  }

  /// Where two links touch, the joints between them are free: what they do moves the centre not at all.
  void free_joints_between_links() const {
    for (std::size_t k = 0; k < most(); ++k) {
      const Mask is_between_links = ~is_terrain(k);
      if (any(is_between_links)) {
        for (std::size_t j = 0; j < form_.counts.joints; ++j) {
          const auto joint = static_cast<double>(j);
          const Mask is_between = is_between_links & (s_.link[k] <= joint) & (s_.other_link[k] > joint);
          put_where(is_between, m_.is_free[j], Lanes<width>::number(1.0));
        }
      }
    }
  }

  /// The velocity of the point of a contact, for the given joint speeds: against the centre, or against the other link.
  [[nodiscard]] Vector velocity_at(std::size_t contact, const Vector& arm) const {
    Vector velocity{};
    for (std::size_t i = 0; i < form_.counts.links; ++i) {
      const auto link = static_cast<double>(i);
      const Mask is_link = s_.link[contact] == link;
      const Mask is_other = s_.other_link[contact] == link;
      if (any(is_link | is_other)) {
        const Vector own = at<Vector>(s_.drift, i) + cross(s_.spin[i], arm - position_of(i));
        velocity = select(is_link, velocity + own, velocity);
        velocity = select(is_other, velocity - own, velocity);
      }
    }
    return velocity;
  }

  void sum_forces(Mask done) const {
    for (std::size_t i = 0; i < form_.counts.links; ++i) {
      put_where(done, m_.contact_force[i], Number{});
    }
    const double steps_per_s = 1.0 / form_.step_s;
    for (int lane = 0; lane < width; ++lane) {
      const auto count = done[lane] != 0 ? static_cast<std::size_t>(Base::counts_[lane]) : 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double force = m_.impulse[2 * k + 1][lane] * steps_per_s;
        m_.contact_force[static_cast<std::size_t>(s_.link[k][lane])][lane] += force;
        if (s_.other_link[k][lane] >= 0.0) {
          m_.contact_force[static_cast<std::size_t>(s_.other_link[k][lane])][lane] += force;
        }
      }
    }
  }
};

}  // namespace
}  // namespace proleg::sim::reduced
