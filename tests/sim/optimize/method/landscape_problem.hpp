#pragma once

#include <utility>
#include <vector>

#include "deluge_log.hpp"

namespace proleg::optimize {

/// A landscape as a problem of pagmo.
struct LandscapeProblem {
  Landscape landscape;

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>& x) const { return {-landscape.level(x)}; }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {landscape.lower, landscape.upper};
  }
};

}  // namespace proleg::optimize
