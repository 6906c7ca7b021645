#pragma once

#include <cstddef>

#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

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

template <typename Mask, typename Number>
inline Space<Number> select(Mask mask, const Space<Number>& a, const Space<Number>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
template <typename Number>
inline Number dot(const Space<Number>& a, const Space<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Number>
inline Space<Number> cross(const Space<Number>& a, const Space<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Number i of an array of points.
template <typename Number>
inline Space<Number> space_at(const Number* array, std::size_t i) {
  return {array[3 * i], array[3 * i + 1], array[3 * i + 2]};
}
template <typename Number>
inline void put(Number* array, std::size_t i, const Space<Number>& value) {
  array[3 * i] = value.x;
  array[3 * i + 1] = value.y;
  array[3 * i + 2] = value.z;
}

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

/// Number i of an array of tensors.
template <typename Number>
inline Tensor<Number> tensor_at(const Number* array, std::size_t i) {
  const Number* t = array + 6 * i;
  return {t[0], t[1], t[2], t[3], t[4], t[5]};
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

/// The inertia of a mass at a point about the origin.
template <typename Number>
inline Tensor<Number> point_inertia(Number mass, const Space<Number>& p) {
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

/// By Cramer's rule.
template <typename Number>
inline Tensor<Number> inverse_of(const Tensor<Number>& t) {
  const Number xx = t.yy * t.zz - t.yz * t.yz;
  const Number xy = t.xz * t.yz - t.xy * t.zz;
  const Number xz = t.xy * t.yz - t.xz * t.yy;
  const Number factor = 1.0 / (t.xx * xx + t.xy * xy + t.xz * xz);
  return {xx * factor, (t.xx * t.zz - t.xz * t.xz) * factor, (t.xx * t.yy - t.xy * t.xy) * factor, xy * factor,
          xz * factor, (t.xy * t.xz - t.xx * t.yz) * factor};
}

/// IEEE 754 rounds it in one way, like a division.
template <typename Number>
inline Number square_root(Number value) {
  for (unsigned lane = 0; lane < sizeof(Number) / sizeof(double); ++lane) {
    value[lane] = __builtin_sqrt(value[lane]);
  }
  return value;
}

}  // namespace
}  // namespace proleg::sim::reduced
