// A recording in which any number may be wrong: each program that reads it succeeds or gives one error, and none
// crashes.

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/verification.hpp"
#include "sim/record/figure.hpp"
#include "sim/record/tsv.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {
namespace {

/// A recording that has rows in every table: changes, a distortion, losses, a restart, faults, a move, sensors,
/// readings.
void record_eventful_run(const std::filesystem::path& path) {
  Scenario scenario = shipped("travelling_wave/coupled");
  scenario.robot.sensors = shipped("retreat/wall").robot.sensors;
  apply_setting(scenario, "amplitude=20@3");
  apply_setting(scenario, "current_phase:J3=90@5");
  const Losses losses({{20, 0, 0, 1}, {21, 3, 0, 2}});
  HardwareOptions options;
  options.losses = &losses;
  options.restarts = {{8, 2}};
  HardwareLoop loop(scenario, options);
  Recorder recorder(path, scenario, "test", "build");
  // In the last tick, so that all before it is compared.
  const RecordedFault faults[] = {{290'000, 295'000, 1U, "at 290ms unplug J4 for 5ms"},
                                  {296'000, {}, {}, "at 296ms host-dies"}};
  recorder.record_faults(faults);
  recorder.record_module_event(297'000, 1, "limp");
  while (loop.tick() < 30) {
    const Change* change = loop.advance();
    if (change != nullptr) {
      recorder.record_change(*change);
    }
    for (const RestartEvent& event : loop.restart_events()) {
      recorder.record_restart(loop.tick() - 1, event.joint, event.joined);
    }
    TickSample sample = loop.sample();
    const RobotMove moves[] = {{sample.tick, {0.1, 0.2, 0.05}, 30.0}};
    if (sample.tick == 10) {
      sample.moves = moves;
    }
    const std::array<JointReadings, 5> readings{JointReadings{7, 50, 1 << 29, -(1 << 30), {1, 2, 9810}}};
    sample.readings = readings;
    recorder.record_tick(sample);
  }
  recorder.finish({{"setpoint_hash", loop.setpoint_hash().hex()}, {"servo_hash", loop.servo_hash().hex()}});
}

/// What every reader of a recording does with it. Empty, or the error of the first that refuses.
std::string read_in_all_ways(const std::filesystem::path& path) {
  return message_of<InputError>([&] {
    const Recording recording(path);
    (void)recording.sources();
    (void)draw_figure(recording, {});
    write_tsv(recording, [](std::string_view /*text*/) {});
    (void)verify(recording);
  });
}

class DamagedRecording : public testing::Test {
 protected:
  void SetUp() override { record_eventful_run(whole_); }

  /// The whole recording with this change.
  void damage(const std::string& sql) {
    std::filesystem::copy_file(whole_, path_, std::filesystem::copy_options::overwrite_existing);
    Database database(path_, SQLITE_OPEN_READWRITE);
    database.execute(("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY; " + sql).c_str());
  }

  void expect_one_line(const std::string& message) const {
    if (!message.empty()) {
      EXPECT_EQ(message.find(path_.string() + ": found "), 0U) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }

  [[nodiscard]] std::vector<std::string> texts(const std::string& sql) const {
    Database database(whole_, SQLITE_OPEN_READONLY);
    Statement query(database, sql);
    std::vector<std::string> found;
    while (query.step()) {
      found.push_back(query.text(0));
    }
    return found;
  }

  TemporaryFolder folder_;
  std::filesystem::path whole_ = folder_ / "whole.proleg";
  std::filesystem::path path_ = folder_ / "run.proleg";
};

TEST_F(DamagedRecording, IsReadInAllWaysIfItIsWhole) {
  damage("SELECT 1");
  EXPECT_EQ(read_in_all_ways(path_), "");
}

// In a row of the start and in one of the middle. PROLEG_ALL_DAMAGES: all of them, else an eighth.
TEST_F(DamagedRecording, WithAnyIntegerReplacedIsReadOrRefused) {
  const bool tries_all = std::getenv("PROLEG_ALL_DAMAGES") != nullptr;
  std::mt19937 random(20);
  int tried = 0;
  int refused = 0;
  for (const std::string& table : texts("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY 1")) {
    const std::string info = " FROM pragma_table_info('" + table + "')";
    const std::string key = texts("SELECT group_concat(name)" + info + " WHERE pk > 0").at(0);
    const std::string rows = texts("SELECT count(*) FROM " + table).at(0);
    if (table.starts_with("object")) {
      continue;  // this run has no objects that move
    }
    ASSERT_NE(rows, "0") << table;
    for (const std::string& column : texts("SELECT name" + info + " WHERE type = 'INTEGER'")) {
      for (const std::string value : {"-1", "-2147483649", "64", "1000000", "2147483647", "2147483648", "4294967296",
                                      "9223372036854775807", "%c + 1", "%c - 1", "-%c"}) {
        for (const std::string& row : {std::string("0"), rows + " / 2"}) {
          if (!tries_all && random() % 8 != 0) {
            continue;
          }
          std::string sql = "UPDATE OR REPLACE %t SET %c = " + value;
          sql += " WHERE (%k) = (SELECT %k FROM %t LIMIT 1 OFFSET " + row + ")";
          for (const auto& [mark, text] : {std::pair("%t", table), std::pair("%c", column), std::pair("%k", key)}) {
            for (std::size_t at = sql.find(mark); at != std::string::npos; at = sql.find(mark)) {
              sql.replace(at, 2, text);
            }
          }
          SCOPED_TRACE(sql);
          damage(sql);
          const std::string message = read_in_all_ways(path_);
          expect_one_line(message);
          ++tried;
          refused += message.empty() ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(tried, tries_all ? 800 : 100);
  EXPECT_GT(refused, tried / 2);
}

TEST_F(DamagedRecording, WithAnyTextReplacedByANumberIsReadOrRefused) {
  for (const std::string& key : texts("SELECT key FROM run")) {
    for (const char* value : {"-1", "0", "1", "131072", "4294967295", "18446744073709551616", ""}) {
      SCOPED_TRACE(key + " = " + value);
      damage("UPDATE run SET value = '" + std::string(value) + "' WHERE key = '" + key + "'");
      expect_one_line(read_in_all_ways(path_));
    }
  }
}

TEST_F(DamagedRecording, WithInternalValuesThatTheAlgorithmDoesNotDeclareIsRefused) {
  for (const char* sql :
       {"DELETE FROM internal_value_name; DELETE FROM internal_value",
        "DELETE FROM internal_value_name WHERE value_index = (SELECT max(value_index) FROM internal_value_name); "
        "DELETE FROM internal_value WHERE value_index = (SELECT max(value_index) FROM internal_value)",
        "UPDATE internal_value_name SET name = 'height' WHERE value_index = 1",
        "INSERT INTO internal_value_name SELECT slot, max(value_index) + 1, 'height', unit, 1.0 FROM "
        "internal_value_name; INSERT INTO internal_value SELECT tick, slot, joint, max(value_index) + 1, 0 FROM "
        "internal_value GROUP BY 1, 2, 3"}) {
    damage(sql);
    const std::string message = read_in_all_ways(path_);
    expect_one_line(message);
    EXPECT_NE(message.find(" as an internal value of joint "), std::string::npos) << sql << ": " << message;
  }
}

TEST_F(DamagedRecording, WithAChangeOfAJointOrSlotThatDoesNotExistIsRefused) {
  damage("UPDATE distortion SET joint = 1000000");
  EXPECT_NE(read_in_all_ways(path_).find("joint 1000000 of 5"), std::string::npos);
  damage("UPDATE parameter SET joint = 1000000 WHERE origin = 'commit'");
  EXPECT_NE(read_in_all_ways(path_).find("joint 1000000 of 5"), std::string::npos);
  damage("UPDATE parameter SET slot = 3 WHERE origin = 'commit'");
  EXPECT_NE(read_in_all_ways(path_).find("slot 3, which has no algorithm"), std::string::npos);
}

// The index of the table is read in the wrong order, as after a damage in one of its pages.
TEST_F(DamagedRecording, WithAnIndexThatDescendsIsRefused) {
  damage(
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'PRIMARY KEY(tick, joint)', 'PRIMARY "
      "KEY(tick DESC, joint)') WHERE name = 'sample'");
  EXPECT_NE(read_in_all_ways(path_).find("tick 0 after tick 29"), std::string::npos) << read_in_all_ways(path_);
}

}  // namespace
}  // namespace proleg::sim
