// Random gaits in the reduced engine. Oracle: ODE. tests/bench/reduced.cpp prints the same figures.

#include "tests/bench/engine_agreement.hpp"

#include <gtest/gtest.h>

#include "shipped.hpp"
#include "tests/bench/candidates.hpp"

namespace proleg::sim {
namespace {

TEST(EngineAgreement, TheReducedEngineRanksTwoHundredRandomGaitsAsOde) {
  const std::vector<Scenario> candidates =
      bench::candidates(shipped("travelling_wave/uniform"), 200, bench::candidate_seed);
  const std::vector<double> ode = bench::distances_alone(bench::with_engine(candidates, PhysicsEngine::ode));
  const std::vector<double> reduced = bench::distances_together(bench::with_engine(candidates, PhysicsEngine::reduced));
  EXPECT_NE(ode, reduced);
  EXPECT_GT(*std::ranges::min_element(ode), 0.0);
  EXPECT_GT(*std::ranges::max_element(ode), 4.0 * *std::ranges::min_element(ode)) << "the gaits are not alike";
  const bench::EngineAgreement agreement = bench::agreement_of(ode, reduced);
  EXPECT_GE(agreement.rank_correlation, 0.98);
  EXPECT_LE(bench::quantile(agreement.relative, 0.5), 0.02);
}

}  // namespace
}  // namespace proleg::sim
