// The sensors of sim/scenarios/retreat in a run, in its recording and in what is made from it.

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/record/figure.hpp"
#include "sim/record/recorder.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t recorded_ticks = 95;

/// Values of all sensors after each tick of a recorded run.
std::vector<std::vector<double>> record_run(const std::filesystem::path& path) {
  const Scenario scenario = shipped("retreat/wall");
  Simulation simulation(scenario);
  Recorder recorder(path, scenario, "test", "build");
  std::vector<std::vector<double>> values;
  while (simulation.tick() < recorded_ticks) {
    simulation.advance();
    const auto now = simulation.plant().sensors().values();
    values.emplace_back(now.begin(), now.end());
    recorder.record_tick(simulation.sample());
  }
  recorder.finish({});
  return values;
}

class RecordedSensors : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("proleg-sensors-" + std::to_string(::getpid()) + ".sqlite");
};

TEST_F(RecordedSensors, AreThoseOfTheRunAtEveryTick) {
  const std::vector<std::vector<double>> measured = record_run(path_);
  const Recording recording(path_);
  ASSERT_EQ(recording.sensors().size(), 5U);
  EXPECT_EQ(recording.sensors()[0].name, "bumper");
  EXPECT_EQ(recording.sensors()[1].channels.size(), 13U) << "-30 to 30 degrees, every 5";
  EXPECT_EQ(recording.sensors()[3].channels[2].name, "acceleration_z");
  EXPECT_EQ(recording.sensors()[3].channels[2].unit, "m/s^2");
  recording.read_ticks(0, recorded_ticks - 1, [&](const RecordedTick& tick) {
    ASSERT_EQ(tick.sensor_values, measured[tick.tick]) << "tick " << tick.tick;
  });
  recording.read_ticks(57, 63, [&](const RecordedTick& tick) {
    ASSERT_EQ(tick.sensor_values, measured[tick.tick]) << "from the middle: the last scan was in tick 50";
  });
}

TEST_F(RecordedSensors, ALaserHasAScanEveryTenthTick) {
  const std::vector<std::vector<double>> measured = record_run(path_);
  const std::size_t first_ray = 4;
  std::size_t scans = 0;
  for (std::size_t tick = 1; tick < measured.size(); ++tick) {
    const bool changed = !std::equal(measured[tick].begin() + first_ray, measured[tick].begin() + first_ray + 13,
                                     measured[tick - 1].begin() + first_ray);
    EXPECT_TRUE(!changed || tick % 10 == 0) << "tick " << tick;
    scans += changed ? 1U : 0U;
  }
  EXPECT_GT(scans, 5U);
  Database database(path_, SQLITE_OPEN_READONLY);
  Statement rows(database, "SELECT count(DISTINCT tick), max(tick % 10), count(*) FROM sensor_value WHERE sensor = 1");
  ASSERT_TRUE(rows.step());
  EXPECT_EQ(rows.integer(0), 10) << "only scans are recorded";
  EXPECT_EQ(rows.integer(1), 0);
  EXPECT_EQ(rows.integer(2), 130);
  EXPECT_NEAR(measured[0][first_ray + 6], 0.7 - 0.288 - 0.027, 0.01) << "the wall ahead, before the robot moves";
}

TEST_F(RecordedSensors, HaveColumnsInTheTable) {
  record_run(path_);
  const Recording recording(path_);
  std::vector<std::string> lines;
  write_tsv(recording, [&](std::string_view line) { lines.emplace_back(line); });
  ASSERT_EQ(lines.size(), recorded_ticks + 1);
  const std::string& header = lines[0];
  for (const char* column : {"\tpressed.bumper\t", "\tdistance_0_m.eye\t", "\tdistance_12_m.eye\t",
                             "\tpitch_deg.level\t", "\tacceleration_z_m_per_s2.shock\t", "\tcurrent_mA.effort"}) {
    EXPECT_NE(header.find(column), std::string::npos) << column;
  }
  EXPECT_EQ(std::ranges::count(header, '\t'), std::ranges::count(lines[1], '\t'));
}

TEST_F(RecordedSensors, HaveAPanelForEachKindInThePicture) {
  record_run(path_);
  const std::string picture = draw_figure(Recording(path_), {});
  for (const char* heading :
       {"Attached touch sensors", "Laser scanners", "Servo currents", "Inclinometers", "Accelerometers"}) {
    EXPECT_NE(picture.find(heading), std::string::npos) << heading;
  }
}

TEST(SensorsInARun, AgreeWithTheRobot) {
  const Scenario scenario = shipped("retreat/wall");
  Simulation simulation(scenario);
  double highest = 0.0;
  while (simulation.tick() < 300) {
    simulation.advance();
    const auto values = simulation.plant().sensors().values();
    const Pose& level = simulation.plant().link_poses()[scenario.robot.sensors[2].part];
    const double height = (level.orientation * Eigen::Vector3d::UnitY()).z();
    EXPECT_NEAR(values[17], std::asin(height) * 180.0 / std::numbers::pi, 1e-6) << "pitch";
    EXPECT_EQ(values.back(), simulation.plant().servo_currents()[scenario.robot.sensors[4].part]);
    highest = std::max(highest, std::abs(height));
  }
  EXPECT_GT(highest, 0.2) << "the link moved";
}

}  // namespace
}  // namespace proleg::sim
