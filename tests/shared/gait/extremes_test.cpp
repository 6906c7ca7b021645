// The corners of what users can set. Under the sanitizers these tests also look for overflow.

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "robot.hpp"

namespace proleg {
namespace {

class EveryAlgorithm : public testing::TestWithParam<std::size_t> {
 protected:
  static constexpr unsigned joints = 3;

  [[nodiscard]] static const ActuationModule& algorithm() { return algorithm_at(GetParam()); }
};

TEST_P(EveryAlgorithm, StaysWithinTheLimitsAtTheCornersOfItsParameterRanges) {
  const std::span<const Parameter> parameters = algorithm().declaration().parameters;
  for (const std::uint32_t tick_us : {1'000U, 100'000U}) {
    for (unsigned corner = 0; corner < 1U << parameters.size(); ++corner) {
      KernelOf<joints> kernel;
      ASSERT_EQ(kernel.configure(test::one_slot(algorithm(), joints, tick_us), 0), Status::ok);
      for (std::size_t p = 0; p < parameters.size(); ++p) {
        const bool high = ((corner >> p) & 1U) != 0;
        test::set_all(kernel, 0, parameters[p].name, high ? parameters[p].maximum : parameters[p].minimum);
      }
      kernel.reset();
      for (int tick = 0; tick < 50; ++tick) {
        kernel.advance();
        for (unsigned joint = 0; joint < joints; ++joint) {
          ASSERT_LE(kernel.setpoint(joint), 1 << 30) << "corner " << corner << " tick " << tick;
          ASSERT_GE(kernel.setpoint(joint), -(1 << 30)) << "corner " << corner << " tick " << tick;
        }
      }
    }
  }
}

TEST_P(EveryAlgorithm, ReturnsToItsGaitAfterTheMostExtremeDistortion) {
  const std::span<const InternalValue> values = algorithm().declaration().internal_values;
  for (unsigned v = 0; v < values.size(); ++v) {
    for (const std::int32_t extreme :
         {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()}) {
      KernelOf<joints> kernel;
      ASSERT_EQ(kernel.configure(test::one_slot(algorithm(), joints), 0), Status::ok);
      test::run(kernel, 300);
      ASSERT_EQ(test::distort(kernel, 0, 1, v, extreme), Status::ok);
      test::run(kernel, 1000);
      std::int32_t lowest = std::numeric_limits<std::int32_t>::max();
      std::int32_t highest = std::numeric_limits<std::int32_t>::min();
      for (int tick = 0; tick < 100; ++tick) {
        kernel.advance();
        lowest = std::min(lowest, kernel.setpoint(1));
        highest = std::max(highest, kernel.setpoint(1));
      }
      const double amplitude = find_parameter(algorithm().declaration(), "amplitude") >= 0 ? 40 : 0;
      EXPECT_NEAR(test::in_degrees(highest), amplitude, 0.1) << values[v].name << " = " << extreme;
      EXPECT_NEAR(test::in_degrees(lowest), -amplitude, 0.1) << values[v].name << " = " << extreme;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryAlgorithm, testing::Range(std::size_t{0}, algorithm_count()),
                         [](const testing::TestParamInfo<std::size_t>& index) {
                           return std::string(algorithm_at(index.param).declaration().name);
                         });

}  // namespace
}  // namespace proleg
