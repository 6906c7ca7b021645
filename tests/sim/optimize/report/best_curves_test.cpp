#include "sim/optimize/report/method_runs.hpp"

#include "made_up.hpp"

namespace proleg::optimize {
namespace {

TEST(BestCurves, KeepTheLastBestOfARunThatHasEnded) {
  const BestCurves curves = best_curves(method_of("genetic", {{1.0, 0.5, 3.0}, {2.0}, {}}));
  EXPECT_EQ(curves.min, (std::vector<double>{1.0, 1.0, 2.0}));
  EXPECT_EQ(curves.mean, (std::vector<double>{1.5, 1.5, 2.5}));
  EXPECT_EQ(curves.max, (std::vector<double>{2.0, 2.0, 3.0}));
  EXPECT_EQ(best_so_far(run_of({0.0, 2.0, 1.0, 2.5})), (std::vector<double>{0.0, 2.0, 2.0, 2.5}));
}

TEST(Overtaking, IsTheLastEvaluationAtWhichTheFollowerIsNotAbove) {
  const BestCurves leader = best_curves(method_of("genetic", {{1.0, 3.0}}));
  EXPECT_EQ(overtaking(best_curves(method_of("great-deluge", {{0.0, 1.0, 2.0, 3.0, 4.0}})), leader), 4U);
  EXPECT_EQ(overtaking(best_curves(method_of("great-deluge", {{2.0, 2.0, 5.0}})), leader), 2U);
  EXPECT_EQ(overtaking(best_curves(method_of("great-deluge", {{2.0, 4.0}})), leader), 0U);
  EXPECT_EQ(overtaking(best_curves(method_of("great-deluge", {{2.0, 3.0}})), leader), std::nullopt);
  EXPECT_EQ(overtaking(leader, {}), std::nullopt);
}

TEST(EvaluationsToReach, CountsFromOne) {
  const BestCurves curves = best_curves(method_of("cmaes", {{1.0, 2.0, 3.0}}));
  EXPECT_EQ(evaluations_to_reach(curves, 1.0), 1U);
  EXPECT_EQ(evaluations_to_reach(curves, 2.5), 3U);
  EXPECT_EQ(evaluations_to_reach(curves, 3.5), std::nullopt);
}

}  // namespace
}  // namespace proleg::optimize
