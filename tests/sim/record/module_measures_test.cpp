#include "sim/record/module_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t ticks_of_trial = 40;

/// The measures of a recording of a small run whose samples are changed as a robot without sensors would have them.
MeasureValues measures_of(const Scenario& scenario, const std::function<void(TickSample&)>& change) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.proleg";
  {
    Recorder recorder(path, scenario, "drive", "test");
    run_small(scenario, ticks_of_trial, [&](const TickSample& sample, const Change* committed) {
      if (committed != nullptr) {
        recorder.record_change(*committed);
      }
      TickSample changed = sample;
      change(changed);
      recorder.record_tick(changed);
    });
    recorder.finish({});
  }
  return measure_modules(Recording(path), scenario);
}

TEST(ModuleMeasures, AreTheMeanCurrentAndTheEnergyOfTheSupply) {
  const Scenario scenario = small_scenario();
  double sum_ma = 0.0;
  for (std::uint32_t tick = 0; tick < ticks_of_trial; ++tick) {
    for (std::size_t joint = 0; joint < 3; ++joint) {
      sum_ma += made_up_current(tick, joint);
    }
  }
  const MeasureValues values = measures_of(scenario, [](TickSample&) {});
  EXPECT_NEAR(values[Measure::mean_current], sum_ma / (3.0 * ticks_of_trial), 1e-6);
  EXPECT_NEAR(values[Measure::electrical_energy], 6.0 * sum_ma * 1e-3 * scenario.kernel.tick_period_us * 1e-6, 1e-9);
}

TEST(ModuleMeasures, AreNotDefinedWithoutTheSensors) {
  const Scenario scenario = small_scenario();
  const std::vector<double> no_currents(3, 0.0);
  const std::vector<std::uint8_t> no_contacts(4, 0);
  const MeasureValues values = measures_of(scenario, [&](TickSample& sample) {
    sample.servo_currents = no_currents;
    sample.latched_contacts = no_contacts;
  });
  for (const Measure measure : measures_of_modules()) {
    EXPECT_TRUE(!is_sensed_by_modules(measure) || std::isnan(values[measure])) << declaration_of(measure).name;
  }
}

TEST(ModuleMeasures, HaveNothingThatNeedsThePathOfTheRobot) {
  const MeasureValues values = measures_of(small_scenario(), [](TickSample&) {});
  for (const Measure measure : {Measure::distance, Measure::speed, Measure::height, Measure::tracking_error,
                                Measure::cost_of_transport, Measure::stride_length}) {
    EXPECT_TRUE(std::isnan(values[measure])) << declaration_of(measure).name;
  }
}

TEST(ModuleMeasures, RefuseTheRecordingOfAnotherRobot) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.proleg";
  const Scenario scenario = small_scenario();
  record_small(path, scenario, ticks_of_trial);
  Scenario other = scenario;
  other.robot.joints.pop_back();
  other.robot.links.pop_back();
  EXPECT_EQ(message_of<InputError>([&] { static_cast<void>(measure_modules(Recording(path), other)); }),
            path.string() + ": found the recording of another robot, expected that of " + scenario.path);
}

}  // namespace
}  // namespace proleg::sim
