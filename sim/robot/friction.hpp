#pragma once

#include <cmath>
#include <optional>

namespace proleg::sim {

/// Coulomb coefficient of two geometries that touch, from those that they have. unspecified: where neither has one.
[[nodiscard]] inline double friction_of(std::optional<double> a, std::optional<double> b, double unspecified) {
  if (a && b) {
    return std::sqrt(*a * *b);
  }
  return a.value_or(b.value_or(unspecified));
}

}  // namespace proleg::sim
