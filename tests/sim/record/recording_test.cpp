#include "sim/record/recording.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

/// Reads everything in a recording.
void read_all(const std::filesystem::path& path) {
  const Recording recording(path);
  (void)recording.parameters();
  (void)recording.distortions();
  (void)recording.restarts();
  (void)recording.sources();
  ServoPulseReader pulses(recording);
  while (pulses.next()) {
  }
  LossReader losses(recording);
  while (losses.next()) {
  }
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [](const RecordedTick& /*tick*/) {});
}

std::string refusal(const std::filesystem::path& path) {
  return message_of<InputError>([&] { read_all(path); });
}

class BadRecording : public testing::Test {
 protected:
  void damage(const char* sql) {
    record_small(path_, small_scenario(), 30);
    Database database(path_, SQLITE_OPEN_READWRITE);
    database.execute(sql);
  }
  void expect_refusal(const std::string& part) {
    const std::string message = refusal(path_);
    EXPECT_EQ(message.find(path_.string() + ": found "), 0U) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_NE(message.find(", expected a recording of proleg simulate or proleg hil"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "run.sqlite";
};

TEST_F(BadRecording, AMissingFileIsRefused) {
  expect_refusal("no such file");
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(BadRecording, AFolderIsRefused) {
  std::filesystem::create_directory(path_);
  expect_refusal("a folder");
}

TEST_F(BadRecording, ATextFileIsRefused) {
  std::ofstream(path_) << std::string(5000, 'x');
  expect_refusal("not a database");
}

TEST_F(BadRecording, AnEmptyFileIsRefused) {
  std::ofstream(path_).flush();
  expect_refusal("an empty file");
}

TEST_F(BadRecording, AForeignDatabaseIsRefused) {
  {
    Database database(path_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    database.execute("CREATE TABLE sample(tick, joint, setpoint_raw); INSERT INTO sample VALUES(1, 2, 3)");
  }
  expect_refusal("a database of another program");
}

TEST_F(BadRecording, ARecordingOfALaterFormatIsRefused) {
  damage("PRAGMA user_version = 999");
  expect_refusal("recording format 999");
}

TEST_F(BadRecording, ARecordingWithoutATickIsRefused) {
  const Scenario scenario = small_scenario();
  Recorder(path_, scenario, "test", "build").finish({});
  expect_refusal("no tick");
}

TEST_F(BadRecording, AMissingTableIsRefused) {
  damage("DROP TABLE pose");
  expect_refusal("no such table: pose");
}

TEST_F(BadRecording, WithoutItsSourcesItIsRefusedWhateverIsReadOfIt) {
  damage("DROP TABLE source");
  expect_refusal("a recording without the table 'source'");
  EXPECT_THROW(Recording{path_}, InputError);
}

TEST_F(BadRecording, AMissingRowIsRefused) {
  damage("DELETE FROM internal_value WHERE tick = 12 AND joint = 1 AND value_index = 2");
  expect_refusal("a gap in the table internal_value at tick 12");
}

TEST_F(BadRecording, AMissingTickIsRefused) {
  damage("DELETE FROM sample WHERE tick = 12");
  expect_refusal("a gap in the table sample at tick 12");
}

TEST_F(BadRecording, AJointOrChannelThatDoesNotExistIsRefused) {
  damage("UPDATE servo SET joint = 64 WHERE time_us = 120000 AND joint = 1");
  expect_refusal("joint 64 of 3");
  damage("INSERT INTO restart VALUES(4, 3, 'stopped')");
  expect_refusal("joint 3 of 3");
  damage("INSERT INTO loss VALUES(4, 0, 0, 5)");
  expect_refusal("joint 5 of 3");
  damage("INSERT INTO loss VALUES(4, 0, 2, 1)");
  expect_refusal("a loss on channel 2");
}

TEST_F(BadRecording, NumbersOutOfRangeAreRefused) {
  damage("UPDATE servo SET time_us = -5000 WHERE time_us = 0");
  expect_refusal("a time that is not a whole number of microseconds");
  damage("UPDATE sample SET setpoint_raw = 3000000000 WHERE tick = 3");
  expect_refusal("not a 32-bit integer");
  damage("UPDATE pose SET x_m = 9e999 WHERE tick = 3");
  expect_refusal("not a finite number");
  damage("UPDATE link SET link = -1 WHERE link = 0");
  expect_refusal("negative");
  damage("UPDATE run SET value = '0' WHERE key = 'tick_us'");
  expect_refusal("a tick of 0 us");
  damage("UPDATE run SET value = '10ms' WHERE key = 'tick_us'");
  expect_refusal("'10ms' as tick_us");
  damage("UPDATE internal_value_name SET unit = 'furlong' WHERE value_index = 1");
  expect_refusal("unknown unit 'furlong'");
  damage("UPDATE slot SET joint_group = '11'");
  expect_refusal("joint group");
}

TEST_F(BadRecording, ATruncatedFileIsRefusedWhereverItEnds) {
  record_small(path_, small_scenario(), 30);
  const auto size = std::filesystem::file_size(path_);
  const std::filesystem::path whole = folder_ / "whole.sqlite";
  std::filesystem::copy_file(path_, whole);
  for (std::uintmax_t length = 0; length < size; length += 1'237) {
    std::filesystem::copy_file(whole, path_, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(path_, length);
    EXPECT_NE(refusal(path_), "") << "cut to " << length << " of " << size << " bytes";
  }
}

TEST_F(BadRecording, OverwrittenPagesAreRefusedOrReadButNeverCrash) {
  record_small(path_, small_scenario(), 30);
  const auto size = std::filesystem::file_size(path_);
  const std::filesystem::path whole = folder_ / "whole.sqlite";
  std::filesystem::copy_file(path_, whole);
  int refused = 0;
  int tried = 0;
  for (std::uintmax_t place = 0; place + 64 < size; place += 997) {
    std::filesystem::copy_file(whole, path_, std::filesystem::copy_options::overwrite_existing);
    {
      std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
      file.seekp(static_cast<std::streamoff>(place));
      file << std::string(64, '\xA5');
    }
    ++tried;
    refused += refusal(path_).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, tried / 5);
}

TEST(Recording, ReadsTheLossesOneByOneInTheOrderOfTicksAndJoints) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), 30);
  Database(folder / "run.sqlite", SQLITE_OPEN_READWRITE)
      .execute("INSERT INTO loss VALUES(7, 0, 0, 1), (3, 2, 1, 0), (3, 2, 0, 1), (3, 0, 0, 2)");
  const Recording recording(folder / "run.sqlite");
  LossReader reader(recording);
  std::vector<std::vector<unsigned>> losses;
  while (const std::optional<Loss> loss = reader.next()) {
    losses.push_back({loss->tick, loss->sender, loss->channel, loss->receiver});
  }
  EXPECT_EQ(losses, (std::vector<std::vector<unsigned>>{{3, 0, 0, 2}, {3, 2, 0, 1}, {3, 2, 1, 0}, {7, 0, 0, 1}}));
}

TEST(Recording, ReadsAPartOfARun) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), 30);
  const Recording recording(folder / "run.sqlite");
  std::vector<std::uint32_t> ticks;
  recording.read_ticks(4, 6, [&](const RecordedTick& tick) { ticks.push_back(tick.tick); });
  EXPECT_EQ(ticks, (std::vector<std::uint32_t>{4, 5, 6}));
  EXPECT_DOUBLE_EQ(recording.time_s(4), 0.05);
  EXPECT_DOUBLE_EQ(recording.sync_time_s(4), 0.04);
}

}  // namespace
}  // namespace proleg::sim
