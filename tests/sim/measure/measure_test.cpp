#include "sim/measure/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace proleg::sim {
namespace {

TEST(Measures, HaveUniqueNamesByWhichTheyAreFound) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < measure_count; ++i) {
    const MeasureDeclaration& declaration = measures()[i];
    EXPECT_EQ(static_cast<std::size_t>(declaration.measure), i);
    EXPECT_EQ(&declaration_of(declaration.measure), &declaration);
    EXPECT_EQ(find_measure(declaration.name), declaration.measure);
    EXPECT_TRUE(names.insert(declaration.name).second) << declaration.name;
    EXPECT_FALSE(declaration.help.empty()) << declaration.name;
  }
  EXPECT_EQ(find_measure("distance"), Measure::distance);
  EXPECT_EQ(find_measure("stride_frequency"), Measure::stride_frequency);
  for (const char* name : {"", "Distance", "distance ", "length"}) {
    EXPECT_EQ(find_measure(name), std::nullopt) << name;
  }
}

TEST(Measures, AreListedByName) {
  const std::vector<std::string> names = measure_names();
  ASSERT_EQ(names.size(), measure_count);
  EXPECT_EQ(names.front(), "distance");
  EXPECT_EQ(names.back(), "mean_current");
}

TEST(Measures, StateWhetherHigherIsBetter) {
  EXPECT_TRUE(declaration_of(Measure::distance).higher_is_better);
  EXPECT_TRUE(declaration_of(Measure::stability_margin).higher_is_better);
  EXPECT_FALSE(declaration_of(Measure::cost_of_transport).higher_is_better);
  EXPECT_FALSE(declaration_of(Measure::smoothness).higher_is_better);
  EXPECT_FALSE(declaration_of(Measure::slip).higher_is_better);
}

TEST(Measures, StateWhichMayBeNegative) {
  // By their definitions: projections, angles, a distance to an edge that may be behind, a difference.
  const std::set<Measure> with_both_signs{Measure::speed,    Measure::sideways_speed,   Measure::heading,
                                          Measure::yaw_rate, Measure::stability_margin, Measure::height};
  for (const MeasureDeclaration& declaration : measures()) {
    EXPECT_EQ(declaration.may_be_negative, with_both_signs.contains(declaration.measure)) << declaration.name;
  }
}

TEST(MeasureValues, AreUndefinedUntilTheyAreSet) {
  MeasureValues values;
  for (const double value : values.all()) {
    EXPECT_TRUE(std::isnan(value));
  }
  values[Measure::slip] = 0.25;
  EXPECT_EQ(values.all()[static_cast<std::size_t>(Measure::slip)], 0.25);
}

}  // namespace
}  // namespace proleg::sim
