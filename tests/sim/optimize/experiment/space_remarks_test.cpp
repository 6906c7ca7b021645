#include "sim/optimize/experiment/space_remarks.hpp"

#include <gtest/gtest.h>

#include "experiment_files.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// "J1 highest J2 lowest" for a candidate.
std::string bounds_of(const Experiment& experiment, const Candidate& candidate) {
  std::string text;
  for (const ValueAtBound& bound : values_at_bounds(experiment, candidate)) {
    text += experiment.space.dimensions[bound.dimension].name + (bound.is_highest ? " highest;" : " lowest;");
  }
  return text;
}

/// The shipped experiment with these bounds of the amplitudes.
Experiment with_bounds(const std::string& lower, const std::string& upper) {
  FilesOverDisk files;
  sim::DiskFiles disk;
  std::string text = disk.read(travelling_wave + "genetic.optimise.xml").value();
  text.replace(text.find("<lowerBounds>0<"), 15, "<lowerBounds>" + lower + "<");
  text.replace(text.find("<upperBounds>40<"), 16, "<upperBounds>" + upper + "<");
  files.texts[travelling_wave + "genetic.optimise.xml"] = text;
  return read_experiment(travelling_wave + "genetic.optimise.xml", files);
}

TEST(ValuesAtBounds, AreThoseThatAWiderRangeCouldExceed) {
  const Experiment experiment = with_bounds("10", "40");
  const auto last = static_cast<std::uint32_t>(experiment.space.dimensions[0].values.size() - 1);
  EXPECT_EQ(bounds_of(experiment, {1, last, last - 1, 0, 7}), "amplitude:J4 highest;amplitude:J2 lowest;");
  EXPECT_EQ(bounds_of(experiment, {1, 2, 3, 4, 5}), "");
}

TEST(ValuesAtBounds, AreNotThoseThatTheParameterCannotExceed) {
  // docs/algorithms.md: an amplitude is from 0 to 90 degrees.
  const Experiment experiment = with_bounds("0", "90");
  const auto last = static_cast<std::uint32_t>(experiment.space.dimensions[0].values.size() - 1);
  EXPECT_EQ(bounds_of(experiment, {0, last, 0, last, 1}), "");
}

TEST(ValuesAtBounds, OfPhasesAreNoneIfTheValuesGoAround) {
  Experiment experiment = with_bounds("0", "40");
  Dimension& phase = experiment.space.dimensions[0];
  phase.unit = Unit::phase_degree;
  const auto degrees = [&](const std::vector<std::string>& texts) {
    phase.values.clear();
    for (const std::string& text : texts) {
      phase.values.push_back(parse_decimal(text, phase.unit).raw);
    }
  };
  degrees({"-180", "-90", "0", "90"});
  EXPECT_EQ(bounds_of(experiment, {0, 1, 1, 1, 1}), "");
  EXPECT_EQ(bounds_of(experiment, {3, 1, 1, 1, 1}), "");
  degrees({"20", "60", "120"});
  EXPECT_EQ(bounds_of(experiment, {0, 1, 1, 1, 1}), "amplitude:J5 lowest;");
  EXPECT_EQ(bounds_of(experiment, {2, 1, 1, 1, 1}), "amplitude:J5 highest;");
}

TEST(ValuesAtBounds, LeaveOutWhatHasNoChoice) {
  Experiment experiment = with_bounds("10", "40");
  experiment.space.dimensions[2].values.resize(1);
  EXPECT_EQ(bounds_of(experiment, {1, 1, 0, 1, 1}), "");
}

TEST(ValuesOutsideSpace, AreThoseThatTheNearestCandidateReplaces) {
  EXPECT_TRUE(values_outside_space(with_bounds("0", "40")).empty()) << "the scenario has 40 degrees on all joints";
  const std::vector<MovedValue> moved = values_outside_space(with_bounds("0", "38"));
  ASSERT_EQ(moved.size(), 5U);
  EXPECT_EQ(moved[0].name, "amplitude:J5");
  EXPECT_EQ(moved[0].own, "40");
  EXPECT_EQ(moved[0].nearest, "38");
  EXPECT_EQ(moved[0].unit, "deg");
}

TEST(ValuesOutsideSpace, HasADimensionOnSeveralJointsIfOneOfThemDiffers) {
  Experiment experiment = with_bounds("0", "40");
  std::vector<Setting>& targets = experiment.space.dimensions[0].targets;
  targets.push_back(experiment.space.dimensions[1].targets.front());
  EXPECT_TRUE(values_outside_space(experiment).empty());
  sim::apply_setting(experiment.scenario, "amplitude:J4=30");
  const std::vector<MovedValue> moved = values_outside_space(experiment);
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_EQ(moved[0].own, "30");
  EXPECT_EQ(moved[0].nearest, "40");
}

}  // namespace
}  // namespace proleg::optimize
