#include "tools/proleg/ui/bus_view.hpp"

#include <gtest/gtest.h>

#include "shipped.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::tools {
namespace {

using std::chrono::milliseconds;

class RobotRowsTest : public ::testing::Test {
 protected:
  std::vector<std::int32_t> values(std::span<const std::int32_t> row, const char* name) const {
    const host::SignalColumns* columns = rows.layout().find(name);
    return {row.begin() + static_cast<std::ptrdiff_t>(columns->offset),
            row.begin() + static_cast<std::ptrdiff_t>(columns->offset + columns->count)};
  }

  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::Simulation simulation{scenario};
  RobotRows rows{scenario};
  const std::vector<std::optional<std::int32_t>> unknown{std::vector<std::optional<std::int32_t>>(5)};
  const std::vector<std::int32_t> none{std::vector<std::int32_t>(5, host::no_value)};
};

TEST_F(RobotRowsTest, HaveNoValueForWhatNobodyMeasuresOrSimulates) {
  simulation.advance();
  const std::vector<bool> measured{true, false, true, true, true};
  const std::span<const std::int32_t> row = rows.fill(simulation.sample(), {}, measured);
  ASSERT_EQ(row.size(), rows.layout().row_size());
  EXPECT_NE(values(row, "angle")[0], host::no_value);
  EXPECT_EQ(values(row, "angle")[1], host::no_value);
  EXPECT_EQ(values(row, "simulated_angle"), none);
  EXPECT_EQ(values(row, "head"), std::vector<std::int32_t>(7, host::no_value));
  const std::vector<double> simulated{0.0, 0.1, -0.1, 1.5707963267948966, 0.3};
  const std::span<const std::int32_t> full = rows.fill(simulation.sample(), simulated, measured);
  ASSERT_EQ(full.size(), rows.layout().row_size());
  EXPECT_EQ(values(full, "simulated_angle")[0], 0);
  EXPECT_EQ(values(full, "simulated_angle")[3], 1 << 30);
  EXPECT_NE(values(full, "head"), std::vector<std::int32_t>(7, host::no_value));
}

TEST_F(RobotRowsTest, WithoutPowerComeAsOftenAsTicksAndDoNotCatchUpALongDelay) {
  const auto begin = RobotRows::Clock::time_point(std::chrono::hours(1));
  EXPECT_EQ(rows.idle(begin, unknown).size(), 1U);
  EXPECT_TRUE(rows.idle(begin + milliseconds(9), unknown).empty());
  EXPECT_EQ(rows.idle(begin + milliseconds(50), unknown).size(), 5U);
  const std::vector<RobotRows::Idle> late = rows.idle(begin + milliseconds(5'000), unknown);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late.front().tick, 6U) << "ticks have no gaps";
  EXPECT_EQ(values(late.front().values, "setpoint"), none);
}

TEST_F(RobotRowsTest, APowerOfAnotherStateIsAnotherRun) {
  const auto begin = RobotRows::Clock::time_point(std::chrono::hours(1));
  const std::uint16_t idle = rows.idle(begin, unknown).front().run;
  const std::uint16_t driven = rows.run_of(0);
  EXPECT_NE(driven, idle);
  EXPECT_EQ(rows.run_of(1), driven);
  const std::vector<RobotRows::Idle> after = rows.idle(begin + milliseconds(20), unknown);
  EXPECT_NE(after.front().run, driven);
  EXPECT_EQ(after.front().tick, 0U);
  EXPECT_NE(rows.run_of(0), after.front().run);
}

}  // namespace
}  // namespace proleg::tools
