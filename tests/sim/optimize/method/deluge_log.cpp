#include "deluge_log.hpp"

#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include "sim/optimize/evaluation/fitness_source.hpp"

namespace proleg::optimize {

std::vector<GreatDeluge::LogLine> log_of(const GreatDelugeSettings& settings, const Landscape& landscape,
                                         const std::vector<std::vector<double>>& starts, std::uint64_t seed) {
  pagmo::population population{pagmo::problem{LandscapeProblem{landscape}}, 0U, 1U};
  for (const auto& start : starts) {
    population.push_back(start);
  }
  pagmo::algorithm algorithm{GreatDeluge{settings, seed}};
  algorithm.set_verbosity(1);
  try {
    static_cast<void>(algorithm.evolve(population));
  } catch (const SearchEnded&) {
  }
  return algorithm.extract<GreatDeluge>()->get_log();
}

}  // namespace proleg::optimize
