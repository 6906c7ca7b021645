// The extreme values that users can set. Under the sanitizers these tests also find overflow.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "robot.hpp"
#include "wave_meter.hpp"

namespace proleg {
namespace {

class EveryAlgorithm : public testing::TestWithParam<std::size_t> {
 protected:
  static constexpr unsigned joints = 3;
  /// With more parameters, as many corners are drawn as this many parameters have.
  static constexpr std::size_t most_dimensions = 12;

  [[nodiscard]] static const ActuationModule& algorithm() { return algorithm_at(GetParam()); }
};

TEST_P(EveryAlgorithm, StaysWithinTheLimitsAtTheCornersOfItsParameterRanges) {
  const std::span<const Parameter> parameters = algorithm().declaration().parameters;
  for (const std::uint32_t tick_us : {1'000U, 100'000U}) {
    std::mt19937 random(1);
    const std::size_t dimensions = std::min(parameters.size(), most_dimensions);
    for (unsigned i = 0; i < 1U << dimensions; ++i) {
      const auto corner = parameters.size() > dimensions ? static_cast<unsigned>(random()) : i;
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

/// The angles between which joint 1 moves over two seconds from tick 1300 on.
struct Range {
  double lowest;
  double highest;
};

Range range_of(Kernel& kernel) {
  test::run(kernel, 1000);
  const std::vector<test::WaveMeter> meters = test::meter(kernel, 200);
  return {meters[1].lowest(), meters[1].highest()};
}

TEST_P(EveryAlgorithm, ReturnsToItsGaitAfterTheMostExtremeDistortion) {
  KernelOf<joints> undisturbed;
  ASSERT_EQ(undisturbed.configure(test::one_slot(algorithm(), joints), 0), Status::ok);
  test::run(undisturbed, 300);
  const Range expected = range_of(undisturbed);
  // A steep crest between two ticks is seen lower. The bursts of the push-pull network are chaotic: they repeat only
  // statistically.
  const double tolerance = algorithm().declaration().name == test::push_pull ? 2.0 : 0.5;
  const std::span<const InternalValue> values = algorithm().declaration().internal_values;
  for (unsigned v = 0; v < values.size(); ++v) {
    for (const std::int32_t extreme :
         {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()}) {
      KernelOf<joints> kernel;
      ASSERT_EQ(kernel.configure(test::one_slot(algorithm(), joints), 0), Status::ok);
      test::run(kernel, 300);
      ASSERT_EQ(test::distort(kernel, 0, 1, v, extreme), Status::ok);
      const Range found = range_of(kernel);
      EXPECT_NEAR(found.highest, expected.highest, tolerance) << values[v].name << " = " << extreme;
      EXPECT_NEAR(found.lowest, expected.lowest, tolerance) << values[v].name << " = " << extreme;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryAlgorithm, testing::Range(std::size_t{0}, algorithm_count()),
                         [](const testing::TestParamInfo<std::size_t>& index) {
                           return std::string(algorithm_at(index.param).declaration().name);
                         });

}  // namespace
}  // namespace proleg
