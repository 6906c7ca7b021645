// More changes than the master can transfer in time.

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/verification.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {
namespace {

class DroppedChanges : public testing::Test {
 protected:
  void SetUp() override {
    for (std::uint32_t tick = 0; tick < changed_ticks; ++tick) {
      const std::string at = "@" + std::to_string(tick);
      apply_setting(scenario_, "amplitude=" + std::to_string(20 + tick % 20) + at);
      apply_setting(scenario_, "phase_difference=" + std::to_string(50 + tick % 20) + at);
      apply_setting(scenario_, "frequency=0." + std::to_string(50 + tick % 40) + at);
      apply_setting(scenario_, "offset=" + std::to_string(1 + tick % 20) + at);
      apply_setting(scenario_, "coupling=" + std::to_string(1 + tick % 20) + at);
      apply_setting(scenario_, "rate=" + std::to_string(10 + tick % 20) + at);
    }
    HardwareLoop loop(scenario_, {});
    Recorder recorder(path_, scenario_, "test", "build");
    while (loop.tick() < 100) {
      if (const Change* change = loop.advance()) {
        effective_.insert(change->tick);
        recorder.record_change(*change);
      }
      recorder.record_tick(loop.sample());
    }
    recorder.finish({});
    dropped_.insert(loop.dropped_changes().begin(), loop.dropped_changes().end());
    differences_ = loop.differences();
  }

  static constexpr std::uint32_t changed_ticks = 60;
  Scenario scenario_ = shipped("travelling_wave/coupled");
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "run.proleg";
  std::set<std::uint32_t> effective_;
  std::set<std::uint32_t> dropped_;
  std::uint64_t differences_ = 0;
};

TEST_F(DroppedChanges, AreReportedAndAllOthersTakeEffect) {
  EXPECT_GT(dropped_.size(), 5U);
  EXPECT_GT(effective_.size(), 5U);
  for (std::uint32_t tick = 0; tick < changed_ticks; ++tick) {
    EXPECT_NE(dropped_.contains(tick), effective_.contains(tick)) << "tick " << tick;
  }
  EXPECT_EQ(differences_, 0U) << "the gait in memory omits the dropped changes too";
}

TEST_F(DroppedChanges, AreNotInTheRecordingWhichVerifies) {
  const Recording recording(path_);
  std::set<std::uint32_t> recorded;
  for (const RecordedSetting& setting : recording.parameters()) {
    if (setting.commit) {
      recorded.insert(setting.tick);
    }
  }
  EXPECT_EQ(recorded, effective_);
  EXPECT_EQ(verify(recording).differences, 0U);
}

}  // namespace
}  // namespace proleg::sim
