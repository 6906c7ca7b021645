#include "sim/record/axis.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace proleg::sim {

double nice_step(double min) {
  const double decade = std::pow(10.0, std::floor(std::log10(min)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    // The tolerance lets 0.3 / 3 count as 0.1.
    if (factor * decade >= min * (1.0 - 1e-9)) {
      return factor * decade;
    }
  }
  return 10.0 * decade;
}

std::vector<double> multiples(double low, double high, double step) {
  const double tolerance = 1e-6;  // of a step: ends of the range that are multiples belong to it
  std::vector<double> values;
  for (double i = std::ceil(low / step - tolerance); i <= std::floor(high / step + tolerance); i += 1.0) {
    values.push_back(i * step);
  }
  return values;
}

std::vector<double> spread(std::vector<double> positions, double gap, double low, double high) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  double free_from = low;
  for (const std::size_t i : order) {
    positions[i] = std::max(positions[i], free_from);
    free_from = positions[i] + gap;
  }
  double free_to = high;
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    positions[*i] = std::min(positions[*i], free_to);
    free_to = positions[*i] - gap;
  }
  return positions;
}

}  // namespace proleg::sim
