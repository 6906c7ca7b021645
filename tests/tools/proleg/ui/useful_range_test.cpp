#include "tools/proleg/document/useful_range.hpp"

#include <gtest/gtest.h>

#include "shared/gait/registry.hpp"

namespace proleg::tools {
namespace {

TEST(UsefulRange, IsWithinTheLimitsOfEachParameterAndHasItsDefault) {
  unsigned algorithms = 0;
  for (std::uint8_t id = 1; id < first_user_id; ++id) {
    const ActuationModule* const algorithm = find_algorithm(id);
    if (algorithm == nullptr) {
      continue;
    }
    ++algorithms;
    for (const Parameter& parameter : algorithm->declaration().parameters) {
      const UsefulRange useful = useful_range(parameter);
      EXPECT_LT(useful.lower, useful.upper) << parameter.name;
      EXPECT_GE(useful.lower, parameter.minimum) << parameter.name;
      EXPECT_LE(useful.upper, parameter.maximum) << parameter.name;
      EXPECT_LE(useful.lower, parameter.default_value) << parameter.name;
      EXPECT_GE(useful.upper, parameter.default_value) << parameter.name;
    }
  }
  EXPECT_GE(algorithms, 15U);
}

TEST(UsefulRange, OfAFrequencyIsWhatServosFollow) {
  const UsefulRange useful = useful_range({"frequency", Unit::hertz, 0, 0, raw(Unit::hertz, 20), "How often."});
  EXPECT_EQ(useful.lower, raw(Unit::hertz, 1, 10));
  EXPECT_EQ(useful.upper, raw(Unit::hertz, 2));
}

TEST(UsefulRange, OfAnUnknownNameAnotherUnitOrOtherLimitsIsTheWholeRange) {
  for (const Parameter& parameter :
       {Parameter{"steepness", Unit::ratio, 0, 0, 10, "How steep."},
        Parameter{"frequency", Unit::count, 5, 3, 9, "How often."},
        Parameter{"frequency", Unit::hertz, 0, raw(Unit::hertz, 5), raw(Unit::hertz, 9), "How often."}}) {
    const UsefulRange useful = useful_range(parameter);
    EXPECT_EQ(useful.lower, parameter.minimum);
    EXPECT_EQ(useful.upper, parameter.maximum);
  }
}

}  // namespace
}  // namespace proleg::tools
