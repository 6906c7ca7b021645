#pragma once

#include <cmath>

#include <Eigen/Core>

#include "sim/reduced/chain_form.hpp"

namespace proleg::sim::reduced {

// What is computed from files becomes a whole multiple of a power of two that is far above rounding errors, so it is
// the same on every machine.
inline double rounded(double value, int bits = 30) { return std::ldexp(std::round(std::ldexp(value, bits)), -bits); }
inline Point rounded(const Point& point) { return {rounded(point.x), rounded(point.z)}; }
inline Eigen::Vector3d rounded(const Eigen::Vector3d& vector) {
  return vector.unaryExpr([](double value) { return rounded(value); });
}

}  // namespace proleg::sim::reduced
