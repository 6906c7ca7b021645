#pragma once

#include <cstddef>

#include "sim/reduced/kernel.hpp"
#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// A point or a direction in the plane in which the chains move.
template <typename Number>
struct Plane {
  Number x{};
  Number z{};

  Plane operator+(const Plane& other) const { return {x + other.x, z + other.z}; }
  Plane operator-(const Plane& other) const { return {x - other.x, z - other.z}; }
  Plane operator*(Number factor) const { return {x * factor, z * factor}; }
};

/// A point or a direction in space.
template <typename Number>
struct Space {
  Number x;
  Number y;
  Number z;

  Space operator+(const Space& other) const { return {x + other.x, y + other.y, z + other.z}; }
  Space operator-(const Space& other) const { return {x - other.x, y - other.y, z - other.z}; }
  Space operator*(Number factor) const { return {x * factor, y * factor, z * factor}; }
};

/// Where the axes of a link point.
template <typename Number>
struct Turn {
  Space<Number> x;
  Space<Number> y;
  Space<Number> z;

  Space<Number> operator*(const Space<Number>& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// A symmetric matrix.
template <typename Number>
struct Tensor {
  Number xx;
  Number yy;
  Number zz;
  Number xy;
  Number xz;
  Number yz;

  Tensor operator+(const Tensor& other) const {
    return {xx + other.xx, yy + other.yy, zz + other.zz, xy + other.xy, xz + other.xz, yz + other.yz};
  }
  Space<Number> operator*(const Space<Number>& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// The quantities of a kind of chains.
template <typename Kind, typename Number>
struct Quantities;
template <typename Number>
struct Quantities<Planar, Number> {
  using Vector = Plane<Number>;  ///< a point, a velocity, a force
  using Spin = Number;           ///< an angular velocity, an angular momentum, a torque
  using Inertia = Number;
};
template <typename Number>
struct Quantities<Spatial, Number> {
  using Vector = Space<Number>;
  using Spin = Space<Number>;
  using Inertia = Tensor<Number>;
};

/// The unknowns that every chain has.
template <typename Kind, typename Number>
struct Motion {
  typename Quantities<Kind, Number>::Vector center;  ///< velocity of the centre of mass, m/s
  typename Quantities<Kind, Number>::Spin rotation;  ///< rotation of the first link, rad/s
};

// read() and at() take quantity number i of an array, put() sets it.

template <typename Number>
inline void read(const Number* array, std::size_t i, Number& value) {
  value = array[i];
}
template <typename Number>
inline void read(const Number* array, std::size_t i, Plane<Number>& value) {
  value = {array[2 * i], array[2 * i + 1]};
}
template <typename Number>
inline void read(const Number* array, std::size_t i, Space<Number>& value) {
  value = {array[3 * i], array[3 * i + 1], array[3 * i + 2]};
}
template <typename Number>
inline void read(const Number* array, std::size_t i, Turn<Number>& value) {
  read(array, 3 * i, value.x);
  read(array, 3 * i + 1, value.y);
  read(array, 3 * i + 2, value.z);
}
template <typename Number>
inline void read(const Number* array, std::size_t i, Tensor<Number>& value) {
  const Number* t = array + 6 * i;
  value = {t[0], t[1], t[2], t[3], t[4], t[5]};
}
template <typename Value, typename Number>
inline Value at(const Number* array, std::size_t i) {
  Value value;
  read(array, i, value);
  return value;
}

template <typename Number>
inline void put(Number* array, std::size_t i, const Number& value) {
  array[i] = value;
}
template <typename Number>
inline void put(Number* array, std::size_t i, const Plane<Number>& value) {
  array[2 * i] = value.x;
  array[2 * i + 1] = value.z;
}
template <typename Number>
inline void put(Number* array, std::size_t i, const Space<Number>& value) {
  array[3 * i] = value.x;
  array[3 * i + 1] = value.y;
  array[3 * i + 2] = value.z;
}
template <typename Number>
inline void put(Number* array, std::size_t i, const Turn<Number>& value) {
  put(array, 3 * i, value.x);
  put(array, 3 * i + 1, value.y);
  put(array, 3 * i + 2, value.z);
}
template <typename Number>
inline void put(Number* array, std::size_t i, const Tensor<Number>& t) {
  Number* place = array + 6 * i;
  place[0] = t.xx;
  place[1] = t.yy;
  place[2] = t.zz;
  place[3] = t.xy;
  place[4] = t.xz;
  place[5] = t.yz;
}

/// Sets the lanes of the mask.
template <typename Mask, typename Number>
inline void put_where(Mask mask, Number& place, const Number& value) {
  place = select(mask, value, place);
}

template <typename Mask, typename Number>
inline Plane<Number> select(Mask mask, const Plane<Number>& a, const Plane<Number>& b) {
  return {select(mask, a.x, b.x), select(mask, a.z, b.z)};
}
template <typename Mask, typename Number>
inline Space<Number> select(Mask mask, const Space<Number>& a, const Space<Number>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
template <typename Mask, typename Number, typename Value>
inline void put_where(Mask mask, Number* array, std::size_t i, const Value& value) {
  put(array, i, select(mask, value, at<Value>(array, i)));
}

/// Writes a lane of quantity number i of an array.
template <typename Number>
inline void put_lane(Number* array, std::size_t i, int lane, const Plane<Number>& value) {
  array[2 * i][lane] = value.x[lane];
  array[2 * i + 1][lane] = value.z[lane];
}
template <typename Number>
inline void put_lane(Number* array, std::size_t i, int lane, const Space<Number>& value) {
  array[3 * i][lane] = value.x[lane];
  array[3 * i + 1][lane] = value.y[lane];
  array[3 * i + 2][lane] = value.z[lane];
}

template <typename Number>
inline Number dot(const Plane<Number>& a, const Plane<Number>& b) {
  return a.x * b.x + a.z * b.z;
}
template <typename Number>
inline Number dot(const Space<Number>& a, const Space<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Number>
inline Number dot(const Number& a, const Number& b) {
  return a * b;
}
/// Positive if b points to the left of a: from x towards z.
template <typename Number>
inline Number cross(const Plane<Number>& a, const Plane<Number>& b) {
  return a.x * b.z - a.z * b.x;
}
template <typename Number>
inline Space<Number> cross(const Space<Number>& a, const Space<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A quarter turn from x towards z: the velocity of a point at r that turns at 1 rad/s.
template <typename Number>
inline Plane<Number> turned(const Plane<Number>& r) {
  return {-r.z, r.x};
}
/// The velocity of a point at r that turns in the plane.
template <typename Number>
inline Plane<Number> cross(const Number& spin, const Plane<Number>& r) {
  return turned(r) * spin;
}

/// A sum with what a link has of its own and what it has as a point. The order of additions decides the last bit.
template <typename Number>
inline Number with_link(const Number& sum, const Number& own, const Number& as_point) {
  return sum + (own + as_point);
}
template <template <typename> typename Quantity, typename Number>
inline Quantity<Number> with_link(const Quantity<Number>& sum, const Quantity<Number>& own,
                                  const Quantity<Number>& as_point) {
  return sum + own + as_point;
}

/// The inertia of a mass at a point about the origin.
template <typename Number>
inline Number point_inertia(const Number& mass, const Plane<Number>& p) {
  return mass * dot(p, p);
}
template <typename Number>
inline Tensor<Number> point_inertia(const Number& mass, const Space<Number>& p) {
  const Space<Number> m = p * mass;
  return {m.y * p.y + m.z * p.z, m.x * p.x + m.z * p.z, m.x * p.x + m.y * p.y, -m.x * p.y, -m.x * p.z, -m.y * p.z};
}

/// An inertia that has turned with its link.
template <typename Number>
inline Tensor<Number> turned_inertia(const Turn<Number>& t, const Tensor<Number>& own) {
  const Space<Number> a = t * Space<Number>{own.xx, own.xy, own.xz};
  const Space<Number> b = t * Space<Number>{own.xy, own.yy, own.yz};
  const Space<Number> c = t * Space<Number>{own.xz, own.yz, own.zz};
  return {a.x * t.x.x + b.x * t.y.x + c.x * t.z.x, a.y * t.x.y + b.y * t.y.y + c.y * t.z.y,
          a.z * t.x.z + b.z * t.y.z + c.z * t.z.z, a.x * t.x.y + b.x * t.y.y + c.x * t.z.y,
          a.x * t.x.z + b.x * t.y.z + c.x * t.z.z, a.y * t.x.z + b.y * t.y.z + c.y * t.z.z};
}

template <typename Number>
inline Number inverse_of(const Number& inertia) {
  return 1.0 / inertia;
}
/// Inverts by Cramer's rule.
template <typename Number>
inline Tensor<Number> inverse_of(const Tensor<Number>& t) {
  const Number xx = t.yy * t.zz - t.yz * t.yz;
  const Number xy = t.xz * t.yz - t.xy * t.zz;
  const Number xz = t.xy * t.yz - t.xz * t.yy;
  const Number factor = 1.0 / (t.xx * xx + t.xy * xy + t.xz * xz);
  return {xx * factor, (t.xx * t.zz - t.xz * t.xz) * factor, (t.xx * t.yy - t.xy * t.xy) * factor, xy * factor,
          xz * factor, (t.xy * t.xz - t.xx * t.yz) * factor};
}

}  // namespace
}  // namespace proleg::sim::reduced
