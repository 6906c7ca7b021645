#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "made_up.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

/// 20 runs whose heights go from `lowest` to `highest`; `others` of them have the height `other`.
std::vector<std::string> remarks_on(const Experiment& experiment, double lowest, double highest, std::size_t others = 0,
                                    double other = 0.0) {
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const double share = static_cast<double>(i) / 19.0;
    evaluations.push_back(evaluation_at(i, {1.0, i < others ? other : lowest + share * (highest - lowest), share}));
  }
  return axis_remarks(experiment, evaluations);
}

TEST(AxisRemarks, NameAnAxisThatTheRunsAreOutsideOf) {
  Experiment experiment = map_experiment(2, 25);
  experiment.axes[0].lowest = 100;
  experiment.axes[0].highest = 200;
  EXPECT_EQ(remarks_on(experiment, 0.02, 0.05),
            (std::vector<std::string>{"height was 0.02 to 0.05 m in all 20 runs, below the lowest value 100 of its "
                                      "axis; are its bounds in another unit?"}));
  EXPECT_EQ(remarks_on(experiment, 300, 500).at(0).find("height was 300 to 500 m in all 20 runs, above"), 0U);
  EXPECT_EQ(remarks_on(experiment, 300, 500, 10, 3).at(0).substr(0, 59),
            "height was 3 to 500 m in all 20 runs, outside of its axis, ");
  EXPECT_NE(remarks_on(experiment, 0.02, 0.05, 2, 150).at(0).find("nearly always below"), std::string::npos);
  EXPECT_TRUE(remarks_on(experiment, 0.02, 0.05, 5, 150).empty()) << "a quarter of the runs is on the axis";
}

TEST(AxisRemarks, NameAnAxisThatIsSoWideThatOneCellHasAllRuns) {
  Experiment experiment = map_experiment(2, 25);
  experiment.axes[0].lowest = 0;
  experiment.axes[0].highest = 100;
  EXPECT_NE(remarks_on(experiment, 0.02, 0.05).at(0).find("in one of the 25 cells of its axis, 0 to 100"),
            std::string::npos);
  experiment.axes[0].highest = 0.1;
  EXPECT_TRUE(remarks_on(experiment, 0.02, 0.05).empty());
}

TEST(AxisRemarks, AreNoneForFewRunsOrRunsThatFailed) {
  Experiment experiment = map_experiment(2, 25);
  experiment.axes[0].lowest = 100;
  experiment.axes[0].highest = 200;
  std::vector<Evaluation> evaluations(9, evaluation_at(0, {1.0, 0.02, 0.5}));
  EXPECT_TRUE(axis_remarks(experiment, evaluations).empty());
  evaluations.resize(20, evaluation_at(0, {experiment.objectives.front().failed, 0.02, 0.5}));
  EXPECT_TRUE(axis_remarks(experiment, evaluations).empty());
}

}  // namespace
}  // namespace proleg::optimize
