#include "tools/proleg/ui/recorded_run.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/live_simulation.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// An answer as a viewer reads it (docs/page-interface.md, Recordings).
struct Answer {
  std::uint32_t tick = 0;
  std::uint32_t stride = 0;
  std::uint32_t rows = 0;
  std::uint32_t last_tick = 0;
  std::vector<std::int32_t> values;

  explicit Answer(const std::vector<std::uint8_t>& bytes) : values(bytes.size() / 4) {
    std::memcpy(values.data(), bytes.data(), bytes.size());
    tick = static_cast<std::uint32_t>(values.at(0));
    stride = static_cast<std::uint32_t>(values.at(1));
    rows = static_cast<std::uint32_t>(values.at(2));
    last_tick = static_cast<std::uint32_t>(values.at(3));
    values.erase(values.begin(), values.begin() + 4);
  }
};

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Set-points of all ticks, as another program reads them from the file: five for each tick.
std::vector<std::int32_t> setpoints_of(const fs::path& path) {
  Database database(path, SQLITE_OPEN_READONLY);
  Statement query(database, "SELECT setpoint_raw FROM sample ORDER BY tick, joint");
  std::vector<std::int32_t> values;
  while (query.step()) {
    values.push_back(static_cast<std::int32_t>(query.integer(0)));
  }
  return values;
}

class RecordedRunTest : public ::testing::Test {
 protected:
  static constexpr unsigned joints = 5;

  void SetUp() override {
    ASSERT_TRUE(live_.record(path_, "simulate", "test", [] { return true; }));
  }
  void advance(unsigned ticks) {
    for (unsigned tick = 0; tick < ticks; ++tick) {
      live_.advance();
    }
  }
  static void index(RecordedRun& run) {
    while (run.index_some()) {
    }
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "run.proleg";
  sim::Scenario scenario_ = sim::shipped("travelling_wave/uniform");
  LiveSimulation live_{scenario_, {}, nullptr};
};

TEST_F(RecordedRunTest, GivesTheRowsOfTheFileAndItsExtremes) {
  advance(700);
  live_.end_recording();
  const std::string before = contents(path_);
  const std::vector<std::int32_t> setpoints = setpoints_of(path_);
  ASSERT_EQ(setpoints.size(), 700 * joints);
  RecordedRun run(path_);
  index(run);
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 60; ++round) {
    const std::uint32_t from = random() % 700;
    const std::uint32_t to = from + random() % (700 - from);
    const std::uint32_t points = 1 + random() % 200;
    const Answer answer(run.rows({{"setpoint"}, from, to, points}));
    SCOPED_TRACE(std::to_string(from) + " to " + std::to_string(to) + ", points " + std::to_string(points));
    ASSERT_LE(answer.rows, points);
    ASSERT_EQ(answer.last_tick, 699U);
    const bool is_raw = to - from + 1 <= points;
    ASSERT_EQ(answer.stride == 1, is_raw);
    ASSERT_EQ(answer.values.size(), answer.rows * joints * (is_raw ? 1 : 3));
    ASSERT_LE(answer.tick, from);
    ASSERT_GT(answer.tick + answer.stride, from);
    for (std::uint32_t row = 0; row < answer.rows; ++row) {
      for (unsigned joint = 0; joint < joints; ++joint) {
        const std::uint32_t first = answer.tick + row * answer.stride;
        std::int32_t least = INT32_MAX;
        std::int32_t greatest = INT32_MIN;
        for (std::uint32_t tick = first; tick < std::min(700U, first + answer.stride); ++tick) {
          least = std::min(least, setpoints[tick * joints + joint]);
          greatest = std::max(greatest, setpoints[tick * joints + joint]);
        }
        const std::size_t at = std::size_t{row} * joints * (is_raw ? 1 : 3) + joint;
        ASSERT_EQ(answer.values[at], setpoints[first * joints + joint]);
        if (!is_raw) {
          ASSERT_EQ(answer.values[at + joints], least);
          ASSERT_EQ(answer.values[at + 2 * std::size_t{joints}], greatest);
        }
      }
    }
  }
  EXPECT_EQ(contents(path_), before);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"run.proleg"});
}

TEST_F(RecordedRunTest, FollowsAFileThatGrows) {
  live_.end_recording();
  sim::Recorder recorder(path_, scenario_, "simulate", "test");
  sim::Simulation simulation(scenario_, nullptr);
  std::uint32_t ticks = 0;
  const auto grow = [&](std::uint32_t more) {
    for (std::uint32_t end = ticks + more; ticks < end; ++ticks) {
      simulation.advance();
      recorder.record_tick(simulation.sample());
    }
  };
  grow(1);
  // The first commit comes half a second after the start.
  std::unique_ptr<RecordedRun> run;
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
       run == nullptr && std::chrono::steady_clock::now() < end;) {
    grow(1);
    try {
      run = std::make_unique<RecordedRun>(path_);
    } catch (const InputError&) {
    }
  }
  ASSERT_NE(run, nullptr);
  EXPECT_EQ(run->documents()["recording"]["finished"], false);
  index(*run);
  grow(300);
  recorder.finish({});
  const nlohmann::json recording = run->documents()["recording"];
  EXPECT_EQ(recording["finished"], true);
  EXPECT_EQ(recording["last_tick"], ticks - 1);
  index(*run);
  EXPECT_EQ(run->documents()["recording"]["indexed"], ticks);
  const Answer all(run->rows({{"setpoint"}, 0, ticks, 1}));
  EXPECT_EQ(all.last_tick, ticks - 1);
  EXPECT_GE(all.stride, ticks);
  EXPECT_EQ(all.rows, 1U);
}

TEST_F(RecordedRunTest, AnswersHugeRangesWithinItsBounds) {
  advance(300);
  live_.end_recording();
  RecordedRun run(path_);
  EXPECT_EQ(Answer(run.rows({{"angle"}, 0, UINT32_MAX, 100})).rows, 0U);  // not yet in the pyramid
  index(run);
  EXPECT_EQ(Answer(run.rows({{"angle"}, 0, UINT32_MAX, RecordedRun::max_points})).rows, 300U);
  EXPECT_EQ(Answer(run.rows({{"angle"}, 300, UINT32_MAX, 5})).rows, 0U);
  EXPECT_EQ(Answer(run.rows({{"angle"}, 200, 100, 5})).rows, 0U);
  const Answer few(run.rows({{"angle"}, 0, UINT32_MAX, 2}));
  EXPECT_EQ(few.rows, 1U);
  EXPECT_EQ(few.stride, 512U);
}

TEST_F(RecordedRunTest, RejectsRequestsThatMeanNothing) {
  advance(10);
  live_.end_recording();
  RecordedRun run(path_);
  const RecordedRun::Request requests[] = {{{}, 0, 9, 10},
                                           {{"angle", "angle"}, 0, 9, 10},
                                           {{"no such signal"}, 0, 9, 10},
                                           {{"angle"}, 0, 9, 0},
                                           {{"angle"}, 0, 9, RecordedRun::max_points + 1}};
  for (const RecordedRun::Request& request : requests) {
    EXPECT_THROW(static_cast<void>(run.rows(request)), InputError);
  }
}

TEST_F(RecordedRunTest, ShowsTheRobotAndTheChangesThatTheFileHas) {
  advance(5);
  live_.set({"amplitude=30"}, std::nullopt);
  advance(5);
  live_.end_recording();
  RecordedRun run(path_);
  const nlohmann::json documents = run.documents();
  EXPECT_EQ(documents["robot"]["kind"], "recording");
  EXPECT_EQ(documents["robot"]["joints"].size(), joints);
  EXPECT_EQ(documents["recording"]["first_tick"], 0);
  EXPECT_EQ(documents["recording"]["last_tick"], 9);
  ASSERT_EQ(documents["recording"]["marks"].size(), 1U);
  EXPECT_EQ(documents["recording"]["marks"][0]["tick"], 5);
  EXPECT_EQ(documents["recording"]["marks"][0]["kind"], "change");
}

TEST_F(RecordedRunTest, MarksMovesByHandAndLostFrames) {
  advance(4);
  live_.move("1,0.5,0.1,30");
  advance(400);
  live_.end_recording();
  {
    // As a run with lost frames has them.
    Database database(path_, SQLITE_OPEN_READWRITE);
    database.execute("INSERT INTO loss VALUES(100, 0, 0, 1), (100, 0, 0, 2), (101, 3, 0, 1), (300, 0, 0, 1)");
  }
  const nlohmann::json marks = RecordedRun(path_).documents()["recording"]["marks"];
  ASSERT_EQ(marks.size(), 3U) << marks;
  EXPECT_EQ(marks[0], nlohmann::json({{"kind", "move"}, {"tick", 4}, {"text", "moved by hand"}}));
  // 404 ticks in at most 200 parts: 3 ticks each.
  EXPECT_EQ(marks[1], nlohmann::json({{"kind", "loss"}, {"tick", 100}, {"text", "3 frames lost from here on"}}));
  EXPECT_EQ(marks[2], nlohmann::json({{"kind", "loss"}, {"tick", 300}, {"text", "1 frame lost from here on"}}));
}

TEST_F(RecordedRunTest, ARecordingOfAnOlderProgramHasNoMoves) {
  advance(5);
  live_.end_recording();
  Database(path_, SQLITE_OPEN_READWRITE).execute("DROP TABLE move");
  EXPECT_TRUE(RecordedRun(path_).documents()["recording"]["marks"].empty());
}

TEST_F(RecordedRunTest, SaysInOneLineWhatIsWrongWithAFile) {
  advance(300);
  live_.end_recording();
  const std::string whole = contents(path_);
  const auto expect_refusal = [&](const std::string& what) {
    try {
      RecordedRun run(path_);
      index(run);
      FAIL() << what << ": it was accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  std::ofstream(path_, std::ios::binary) << whole.substr(0, whole.size() / 2);
  expect_refusal("cut");
  std::ofstream(path_, std::ios::binary) << "";
  expect_refusal("empty");
  std::ofstream(path_, std::ios::binary) << "SQLite format 3";
  expect_refusal("foreign");
  std::ofstream(path_, std::ios::binary) << whole;
  {
    Database database(path_, SQLITE_OPEN_READWRITE);
    database.execute("PRAGMA user_version = 99");
  }
  expect_refusal("newer");
  std::ofstream(path_, std::ios::binary) << whole;
  {
    Database database(path_, SQLITE_OPEN_READWRITE);
    database.execute("DELETE FROM pose WHERE tick = 200");
  }
  expect_refusal("with a gap");
}

TEST_F(RecordedRunTest, NoticesThatTheFileWasReplaced) {
  advance(10);
  live_.end_recording();
  const RecordedRun run(path_);
  EXPECT_TRUE(run.is_current());
  fs::rename(path_, folder_ / "old.proleg");
  EXPECT_FALSE(run.is_current());
  fs::copy_file(folder_ / "old.proleg", path_);
  EXPECT_FALSE(run.is_current());
}

}  // namespace
}  // namespace proleg::tools
