#include <gtest/gtest.h>

#include <cmath>

#include "experiment_files.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

std::int32_t degrees(const std::string& text) { return parse_decimal(text, Unit::degree).raw; }

TEST(SearchSpaceSize, IsTheProductOfTheSizesOfTheValueSets) {
  MemoryFiles files = small_experiment();
  EXPECT_EQ(read(files).space.size(), 61.0 * 61.0 * 3.0);
}

TEST(SearchSpaceSize, BeyondDoubleIsInfinite) {
  SearchSpace space;
  space.dimensions.resize(1000);
  for (Dimension& dimension : space.dimensions) {
    dimension.values.assign(10, 0);
  }
  EXPECT_EQ(space.size(), std::numeric_limits<double>::infinity());
}

TEST(SearchSpaceApply, GivesEachTargetItsStartValueAndLeavesTheRest) {
  MemoryFiles files = small_experiment();
  const Experiment experiment = read(files);
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply({0, 60, 2}, scenario);
  const auto start = [&](std::uint8_t slot, std::uint8_t joint) { return start_value(scenario, slot, joint, 0); };
  EXPECT_EQ(start(0, 0), degrees("10"));
  EXPECT_EQ(start(0, 1), degrees("40"));
  EXPECT_EQ(start(1, 0), degrees("12"));
  EXPECT_EQ(scenario.settings.size(), 2U) << "40 degrees are the default, which is not listed";
  EXPECT_TRUE(scenario.changes.empty());
}

TEST(SearchSpaceApply, GivesAllTargetsOfAUniformDimensionTheSame) {
  const Experiment experiment = read_with("<uniform>0</uniform>", "<uniform>1</uniform>");
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply({7, 0}, scenario);
  for (std::uint8_t joint = 0; joint < 2; ++joint) {
    EXPECT_EQ(start_value(scenario, 0, joint, 0), degrees("13.5"));
  }
}

TEST(SearchSpaceNearest, IsTheScenarioItselfWhereItsValuesAreAllowed) {
  MemoryFiles files = small_experiment();
  const Experiment experiment = read(files);
  // J2 has 30 degrees, J1 10; the angle of 5 degrees lies between 0 and 12.
  EXPECT_EQ(experiment.space.nearest(experiment.scenario), (Candidate{40, 0, 1}));
}

TEST(SearchSpaceNearest, TakesTheNearerEndOfARangeThatTheScenarioIsOutsideOf) {
  MemoryFiles files = small_experiment();
  const Experiment experiment = read(files);
  sim::Scenario scenario = experiment.scenario;
  sim::apply_setting(scenario, "amplitude=3");
  EXPECT_EQ(experiment.space.nearest(scenario), (Candidate{0, 0, 1}));
  sim::apply_setting(scenario, "amplitude=80");
  EXPECT_EQ(experiment.space.nearest(scenario), (Candidate{60, 60, 1}));
}

TEST(SearchSpaceNearest, TakesTheShorterWayRoundForPhases) {
  Experiment experiment = read_with("parameter=\"amplitude\"", "parameter=\"phase\"");
  experiment.space.dimensions.resize(1);
  experiment.space.dimensions[0].values = {parse_decimal("-170", Unit::phase_degree).raw,
                                           parse_decimal("100", Unit::phase_degree).raw};
  sim::apply_setting(experiment.scenario, "phase=170");
  EXPECT_EQ(experiment.space.nearest(experiment.scenario), (Candidate{0}));
}

TEST(SearchSpaceValue, IsTheNumberOfTheFile) {
  MemoryFiles files = small_experiment();
  const SearchSpace space = read(files).space;
  for (std::uint32_t i = 0; i < 61; ++i) {
    EXPECT_NEAR(space.value({i, 0, 0}, 0), 10.0 + 0.5 * i, 1e-6);
    EXPECT_EQ(std::stod(space.value_text({i, 0, 0}, 0)), 10.0 + 0.5 * i);
  }
  EXPECT_EQ(space.value_text({0, 0, 0}, 2), "-5.5");
  EXPECT_NEAR(space.value({0, 0, 0}, 2), -5.5, 1e-6);
}

}  // namespace
}  // namespace proleg::optimize
