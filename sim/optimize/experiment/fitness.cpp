#include "sim/optimize/experiment/fitness.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::optimize {

double Objective::score(const sim::MeasureValues& measures) const {
  double sum = 0.0;
  for (const Term& term : terms) {
    sum += term.weight * measures[term.measure];
  }
  return std::isfinite(sum) ? sum : failed;
}

bool Objective::may_be_negative() const {
  return failed < 0.0 || std::ranges::any_of(terms, [](const Term& term) {
           return term.weight < 0.0 || sim::declaration_of(term.measure).may_be_negative;
         });
}

std::string_view Objective::unit() const {
  const bool is_measure = terms.size() == 1 && terms.front().weight == 1.0;
  return is_measure ? sim::declaration_of(terms.front().measure).unit : std::string_view();
}

}  // namespace proleg::optimize
