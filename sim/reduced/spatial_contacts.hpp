#pragma once

#include <cstddef>

#include "sim/reduced/contact_list.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// Corners of boxes that are in the floor, and links that are not neighbours and touch each other.
template <int width>
class Contacts<Spatial, width> : public ContactList<Spatial, width> {
  using Base = ContactList<Spatial, width>;
  using Base::form_;
  using Base::m_;
  using Base::s_;
  using Base::stride_;

 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;
  using Base::has;
  using Base::most;

  Contacts(const ChainForm<Spatial>& form, const ChainMemory<Spatial, Number>& memory,
           const ChainScratch<Spatial, Number>& scratch)
      : Base(form, memory, scratch) {}

  /// Finds the contacts. The links must have been placed.
  void find() {
    Base::start();
    if (form_.counts.solids > 0) {
      for (std::size_t box = 0; box < form_.counts.shapes; ++box) {
        search(box);
      }
    }
    Base::count([&](std::size_t k, Mask lanes) { put_where(lanes, s_.lever, k, Vector{}); });
    overlap_ = form_.self_collision ? find_overlap() : Number{};
  }

  /// The given speeds of all contacts. The drift must be known.
  void set_rows() const {
    for (std::size_t k = 0; k < most(); ++k) {
      for (int lane = 0; lane < width; ++lane) {
        const std::size_t link = 3 * static_cast<std::size_t>(s_.link[k][lane]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          s_.given[3 * k + axis][lane] = s_.drift[link + axis][lane];
          s_.link_spin[3 * k + axis][lane] = s_.spin[link + axis][lane];
        }
      }
      put(s_.given, k, at<Vector>(s_.given, k) + cross(at<Vector>(s_.link_spin, k), at<Vector>(s_.lever, k)));
    }
  }

  // Row `axis` of contact k: along x, y or z.

  /// The speed along the row but for what the free joints add, m/s.
  template <std::size_t axis>
  [[nodiscard]] Number speed_along(std::size_t k, const Motion<Spatial, Number>& v) const {
    const Vector arm = at<Vector>(s_.arm, k);
    const Number given = s_.given[3 * k + axis];
    if constexpr (axis == 0) {
      return (v.center.x + given) + (v.rotation.y * arm.z - v.rotation.z * arm.y);
    } else if constexpr (axis == 1) {
      return (v.center.y + given) + (v.rotation.z * arm.x - v.rotation.x * arm.z);
    } else {
      return (v.center.z + given) + (v.rotation.x * arm.y - v.rotation.y * arm.x);
    }
  }
  /// The Jacobian of the rotation.
  template <std::size_t axis>
  [[nodiscard]] Vector turning(std::size_t k) const {
    const Vector arm = at<Vector>(s_.arm, k);
    if constexpr (axis == 0) {
      return {Number{}, arm.z, -arm.y};
    } else if constexpr (axis == 1) {
      return {-arm.z, Number{}, arm.x};
    } else {
      return {arm.y, -arm.x, Number{}};
    }
  }
  /// The speed that an impulse of 1 Ns gives, by the motion of the centre.
  template <std::size_t axis>
  [[nodiscard]] Number center_mobility(std::size_t /*k*/) const {
    return m_.inverse_mass[0];
  }
  /// speed: what a free mass would get from the impulse.
  template <std::size_t axis>
  void push_center(std::size_t /*k*/, const Number& speed, Motion<Spatial, Number>& v) const {
    (axis == 0 ? v.center.x : (axis == 1 ? v.center.y : v.center.z)) += speed;
  }

  /// Sums the impulses of the contacts of each link.
  void sum_impulses() const {
    for (std::size_t i = 0; i < form_.counts.links; ++i) {
      put(s_.contact_impulse, i, Vector{});
      put(s_.contact_moment, i, Vector{});
    }
    for (std::size_t k = 0; k < most(); ++k) {
      const Vector impulse = at<Vector>(s_.value, k);
      const Vector moment = cross(at<Vector>(s_.arm, k), impulse);
      for (int lane = 0; lane < width; ++lane) {
        if (Base::counts_[lane] > static_cast<double>(k)) {
          const std::size_t link = 3 * static_cast<std::size_t>(s_.link[k][lane]);
          s_.contact_impulse[link][lane] += impulse.x[lane];
          s_.contact_impulse[link + 1][lane] += impulse.y[lane];
          s_.contact_impulse[link + 2][lane] += impulse.z[lane];
          s_.contact_moment[link][lane] += moment.x[lane];
          s_.contact_moment[link + 1][lane] += moment.y[lane];
          s_.contact_moment[link + 2][lane] += moment.z[lane];
        }
      }
    }
  }
  /// Adds the momenta that link i gains, less what its contacts give. own: the angular momentum about its centre of
  /// mass; as_point: that of its centre of mass.
  void add_link(std::size_t i, const Vector& gain, const Vector& own, const Vector& as_point, Vector& linear,
                Vector& angular) const {
    linear = linear + (gain - at<Vector>(s_.contact_impulse, i));
    angular = with_link(angular, own, as_point - at<Vector>(s_.contact_moment, i));
  }

  /// Keeps the results of the lanes that are done. Sliding speeds must be in ChainScratch::given.
  void keep(Mask done) const {
    Base::keep_contacts(done, [&](std::size_t k, const Vector& impulse, double steps_per_s) {
      const Number x = s_.given[3 * k];
      const Number y = s_.given[3 * k + 1];
      return typename Base::Slide{Lanes<width>::all(), square_root(x * x + y * y),
                                  magnitude(impulse.x * x + impulse.y * y) * steps_per_s};
    });
    const double steps_per_s = 1.0 / form_.step_s;
    for (std::size_t i = 0; i < form_.counts.links; ++i) {
      put_where(done, m_.contact_force[i], s_.contact_impulse[3 * i + 2] * steps_per_s);
    }
    put_where(done, m_.overlap[0], overlap_);
  }

 private:
  [[nodiscard]] static Vector vector(const Point3& p) {
    return {Lanes<width>::number(p.x), Lanes<width>::number(p.y), Lanes<width>::number(p.z)};
  }
  [[nodiscard]] Vector position_of(std::size_t link) const { return at<Vector>(m_.link_position, link); }
  [[nodiscard]] Vector turned_with(std::size_t link, const Point3& p) const {
    return at<Turn<Number>>(m_.link_turn, link) * vector(p);
  }

  void search(std::size_t number) {
    const Spatial::Shape& box = form_.shapes[number];
    const Spatial::Solid& floor = form_.solids[0];
    const Vector center = at<Vector>(m_.center, 0);
    const Number* turn = m_.link_turn + 9 * box.link;  // the z of the axes are 2, 5 and 8
    const auto rise = [&](const Point3& p) { return turn[2] * p.x + turn[5] * p.y + turn[8] * p.z; };
    const Number middle = (m_.link_position[3 * box.link + 2] + center.z - floor.center.z) + rise(box.center);
    const Number reach = magnitude(rise(box.sides[0])) + magnitude(rise(box.sides[1])) + magnitude(rise(box.sides[2]));
    constexpr double rounding = 1e-9;  // m
    if (!any(middle - reach < rounding)) {
      return;
    }
    const Vector position = position_of(box.link);
    const auto axes = at<Turn<Number>>(m_.link_turn, box.link);
    // A link that lies on its flank, which begins at 45 degrees, presses no sensor.
    constexpr double max_sine = 0.707;
    const Mask can_press = magnitude(rise(form_.links[box.link].sideways)) < max_sine;
    for (std::size_t i = 0; i < Spatial::corners_of_shape; ++i) {
      const Spatial::Corner& corner = box.corners[i];
      const Vector lever = axes * vector(corner.point);
      const Vector arm = position + lever;
      const Number depth = floor.center.z - (center.z + arm.z);
      if (!any(depth > 0.0)) {
        continue;
      }
      const Mask touches = (depth > 0.0) & (depth < floor.thickness) & is_over_floor(center, arm);
      if (!any(touches)) {
        continue;
      }
      const auto key = static_cast<double>(Spatial::corners_of_shape * number + i);
      for (int lane = 0; lane < width; ++lane) {
        if (touches[lane] != 0) {
          put_lane(s_.lever, Base::add(lane, box.link, key, key, arm, depth, m_.friction[number]), lane, lever);
          if (can_press[lane] != 0) {
            Base::press(box.link, lane, corner.sensor);
          }
        }
      }
    }
  }

  [[nodiscard]] Mask is_over_floor(const Vector& center, const Vector& arm) const {
    const Spatial::Solid& floor = form_.solids[0];
    const Number x = center.x + arm.x - floor.center.x;
    const Number y = center.y + arm.y - floor.center.y;
    return (magnitude(x * floor.along.x + y * floor.along.y) < floor.half_length) &
           (magnitude(y * floor.along.x - x * floor.along.y) < floor.half_width);
  }

  /// Returns OwnMemory::overlap.
  [[nodiscard]] Number find_overlap() const {
    Number result{};
    const std::size_t boxes = form_.counts.shapes;
    for (std::size_t a = 0; a < boxes; ++a) {
      for (std::size_t b = a + 1; b < boxes; ++b) {
        const Spatial::Shape& first = form_.shapes[a];
        const Spatial::Shape& second = form_.shapes[b];
        if (second.link <= first.link + 1) {
          continue;  // neighbouring links overlap at their joint by construction
        }
        const Vector apart = position_of(second.link) - position_of(first.link);
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

  /// Two boxes are apart if they are apart along a side of one of them, or along a direction that is perpendicular to
  /// an edge of each.
  [[nodiscard]] Mask overlap(const Spatial::Shape& a, const Spatial::Shape& b) const {
    Vector sides[6];
    for (std::size_t i = 0; i < 3; ++i) {
      sides[i] = turned_with(a.link, a.sides[i]);
      sides[3 + i] = turned_with(b.link, b.sides[i]);
    }
    const Vector apart =
        (position_of(b.link) + turned_with(b.link, b.center)) - (position_of(a.link) + turned_with(a.link, a.center));
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

  Number overlap_{};
};

}  // namespace
}  // namespace proleg::sim::reduced
