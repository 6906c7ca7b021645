#pragma once

// Vectors, rotations and symmetric matrices in space, of several worlds.

#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {

struct Point3 {
  double x = 0.0, y = 0.0, z = 0.0;
  bool operator==(const Point3&) const = default;
};

namespace {

template <typename Number>
struct Space {
  Number x, y, z;
  Space operator+(const Space& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Space operator-(const Space& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Space operator*(Number f) const { return {x * f, y * f, z * f}; }
};
template <typename Number>
inline Number dot(const Space<Number>& a, const Space<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Number>
inline Space<Number> cross(const Space<Number>& a, const Space<Number>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Mask, typename Number>
inline Space<Number> select(Mask mask, const Space<Number>& a, const Space<Number>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// Columns: the axes of a link in the world.
template <typename Number>
struct Turn {
  Space<Number> x, y, z;
  Space<Number> operator*(const Point3& p) const { return x * (Number{} + p.x) + y * (Number{} + p.y) + z * (Number{} + p.z); }
  Space<Number> operator*(const Space<Number>& p) const { return x * p.x + y * p.y + z * p.z; }
  [[nodiscard]] Space<Number> back(const Space<Number>& p) const { return {dot(x, p), dot(y, p), dot(z, p)}; }
};

/// Symmetric.
template <typename Number>
struct Tensor {
  Number xx, yy, zz, xy, xz, yz;
  Space<Number> operator*(const Space<Number>& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  Tensor operator+(const Tensor& o) const {
    return {xx + o.xx, yy + o.yy, zz + o.zz, xy + o.xy, xz + o.xz, yz + o.yz};
  }
  /// Of a point mass.
  static Tensor of_point(Number mass, const Space<Number>& p) {
    const Space<Number> w = p * mass;
    return {w.y * p.y + w.z * p.z, w.x * p.x + w.z * p.z, w.x * p.x + w.y * p.y, -w.x * p.y, -w.x * p.z, -w.y * p.z};
  }
  [[nodiscard]] Tensor inverse() const {
    Tensor c{yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy, xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
    const Number f = 1.0 / (xx * c.xx + xy * c.xy + xz * c.xz);
    return {c.xx * f, c.yy * f, c.zz * f, c.xy * f, c.xz * f, c.yz * f};
  }
};

/// R I R^T of a diagonal tensor.
template <typename Number>
inline Tensor<Number> turned_tensor(const Turn<Number>& r, const Space<Number>& d) {
  const Space<Number> a = r.x * d.x, b = r.y * d.y, c = r.z * d.z;
  return {a.x * r.x.x + b.x * r.y.x + c.x * r.z.x, a.y * r.x.y + b.y * r.y.y + c.y * r.z.y,
          a.z * r.x.z + b.z * r.y.z + c.z * r.z.z, a.x * r.x.y + b.x * r.y.y + c.x * r.z.y,
          a.x * r.x.z + b.x * r.y.z + c.x * r.z.z, a.y * r.x.z + b.y * r.y.z + c.y * r.z.z};
}

template <typename Number>
inline Number root(Number value) {
  for (unsigned i = 0; i < sizeof(Number) / sizeof(double); ++i) {
    value[i] = __builtin_sqrt(value[i]);
  }
  return value;
}

}  // namespace
}  // namespace proleg::sim::reduced
