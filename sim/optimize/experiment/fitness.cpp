#include "sim/optimize/experiment/fitness.hpp"

#include <cmath>

namespace proleg::optimize {

double Objective::score(const sim::MeasureValues& measures) const {
  double sum = 0.0;
  for (const Term& term : terms) {
    sum += term.weight * measures[term.measure];
  }
  return std::isfinite(sum) ? sum : failed;
}

}  // namespace proleg::optimize
