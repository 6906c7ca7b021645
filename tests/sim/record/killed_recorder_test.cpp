#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/record/recording.hpp"
#include "small_run.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

/// Sent through a pipe for every tick that was recorded.
struct Report {
  std::uint32_t tick;
  std::chrono::steady_clock::time_point time;  ///< before it was recorded: so the recorder cannot have been later
};

/// The child process: a tick every 5 ms, until the test kills it.
[[noreturn]] void record_until_killed(const std::filesystem::path& path, int pipe) {
  const Scenario scenario = small_scenario();
  Recorder recorder(path, scenario, "test", "build");
  run_small(scenario, 100'000, [&](const TickSample& sample, const Change* change) {
    const Report report{sample.tick, std::chrono::steady_clock::now()};
    if (change != nullptr) {
      recorder.record_change(*change);
    }
    recorder.record_tick(sample);
    if (write(pipe, &report, sizeof report) != sizeof report) {
      _exit(1);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  });
  _exit(1);
}

class KilledRecorder : public testing::Test {
 protected:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      close(ends[0]);
      record_until_killed(path_, ends[1]);
    }
    close(ends[1]);
    std::vector<Report> reports;
    for (Report report{}; read(ends[0], &report, sizeof report) == sizeof report;) {
      reports.push_back(report);
      if (report.time - reports.front().time > std::chrono::milliseconds(1500)) {
        kill(child, SIGKILL);  // the loop reads the reports that are still in the pipe
      }
    }
    close(ends[0]);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    // Counted from the last tick of the child, not from its end, so that the test also holds on a busy machine.
    for (const Report& report : reports) {
      due_ += report.time < reports.back().time - std::chrono::seconds(1) ? 1U : 0U;
    }
    ASSERT_GT(due_, 0U);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "run.sqlite";
  std::uint32_t due_ = 0;  ///< number of ticks that must not be lost
};

TEST_F(KilledRecorder, LosesAtMostTheLastSecond) {
  const Recording recording(path_);
  EXPECT_FALSE(recording.finished());
  EXPECT_GE(recording.last_tick() + 1, due_);
  std::uint32_t count = 0;
  recording.read_ticks(0, recording.last_tick(), [&](const RecordedTick& tick) {
    EXPECT_EQ(tick.tick, count++);
    EXPECT_EQ(tick.joint_angles[1], made_up_angle(tick.tick, 1));
  });
  EXPECT_EQ(count, recording.last_tick() + 1);
  if (recording.last_tick() >= 7) {
    EXPECT_EQ(recording.distortions().size(), 1U);
  }
}

TEST_F(KilledRecorder, IsNotChangedByReading) {
  const std::uint32_t last = Recording(path_).last_tick();
  for (const bool has_log : {true, false}) {
    for (const bool has_index : {true, false}) {
      const TemporaryFolder folder;
      const std::filesystem::path copy = folder / "a #1 100%?.proleg";
      std::filesystem::copy_file(path_, copy);
      if (has_log) {
        std::filesystem::copy_file(path_.string() + "-wal", copy.string() + "-wal");
      }
      if (has_index) {
        std::filesystem::copy_file(path_.string() + "-shm", copy.string() + "-shm");
      }
      const std::vector<std::string> names = folder.names();
      const std::string file = file_contents(copy);
      const std::string log = has_log ? file_contents(copy.string() + "-wal") : "";
      try {
        EXPECT_EQ(Recording(copy).last_tick(), last);
        EXPECT_TRUE(has_log);
      } catch (const InputError& error) {
        EXPECT_FALSE(has_log) << error.what();  // all ticks are in the log of such a short run
      }
      EXPECT_EQ(folder.names(), names);
      EXPECT_EQ(file_contents(copy), file);
      EXPECT_EQ(has_log ? file_contents(copy.string() + "-wal") : "", log);
    }
  }
}

TEST_F(KilledRecorder, LeavesARecordingThatCanBeReplaced) {
  record_small(path_, small_scenario(), 10);
  EXPECT_TRUE(Recording(path_).finished());
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"run.sqlite"}));
}

}  // namespace
}  // namespace proleg::sim
