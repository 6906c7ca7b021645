#pragma once

#include <functional>
#include <utility>
#include <vector>

namespace proleg::optimize {

/// A box of whole numbers with any level.
struct Landscape {
  std::vector<double> lower = {0.0, 0.0, 0.0};
  std::vector<double> upper = {160.0, 160.0, 160.0};
  std::function<double(const std::vector<double>&)> level;
};

/// A landscape as a problem of pagmo.
struct LandscapeProblem {
  Landscape landscape;

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>& x) const { return {-landscape.level(x)}; }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {landscape.lower, landscape.upper};
  }
};

}  // namespace proleg::optimize
