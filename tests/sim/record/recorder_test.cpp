#include "sim/record/recorder.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <limits>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/kernel/servo_pulses.hpp"
#include "sim/record/recording.hpp"
#include "small_run.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t recorded_ticks = 60;

/// All rows of a query, as the sqlite3 shell would show them.
std::vector<std::string> rows(const std::filesystem::path& path, const std::string& sql, int columns) {
  Database database(path, SQLITE_OPEN_READONLY);
  Statement query(database, sql);
  std::vector<std::string> result;
  while (query.step()) {
    std::string& row = result.emplace_back(query.text(0));
    for (int column = 1; column < columns; ++column) {
      row += "|" + query.text(column);
    }
  }
  return result;
}

TickSample with_measurements(TickSample sample, std::span<const Pose> poses, std::span<const double> angles) {
  sample.link_poses = poses;
  sample.joint_angles = angles;
  return sample;
}

void expect_left_alone(const std::filesystem::path& path, const std::string& contents) {
  std::ofstream(path, std::ios::binary) << contents;
  const Scenario scenario = small_scenario();
  const std::string message = message_of<FileError>([&] { Recorder(path, scenario, "test", "build"); });
  EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  EXPECT_NE(message.find("is not a recording"), std::string::npos) << message;
  EXPECT_EQ(file_contents(path), contents);
}

TEST(Recorder, NamesTheEngineAndTheOptionThatChoseIt) {
  const TemporaryFolder folder;
  Scenario scenario = small_scenario();
  const auto engines = [&](const std::string& file) {
    record_small(folder / file, scenario, 1);
    return rows(folder / file, "SELECT key, value FROM run WHERE key LIKE '%engine' ORDER BY key", 2);
  };
  EXPECT_EQ(engines("ode.sqlite"), (std::vector<std::string>{"engine|ode"}));
  scenario.environment.engine = PhysicsEngine::reduced;
  scenario.overrides.engine = PhysicsEngine::reduced;
  EXPECT_EQ(engines("reduced.sqlite"), (std::vector<std::string>{"engine|reduced", "override_engine|reduced"}));
}

TEST(Recorder, KeepsEverySampleBitForBit) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  record_small(folder / "run.sqlite", scenario, recorded_ticks);

  const Recording recording(folder / "run.sqlite");
  EXPECT_EQ(recording.first_tick(), 0U);
  EXPECT_EQ(recording.last_tick(), recorded_ticks - 1);
  std::vector<RecordedTick> recorded;
  recording.read_ticks(0, recorded_ticks - 1, [&](const RecordedTick& tick) { recorded.push_back(tick); });
  ASSERT_EQ(recorded.size(), recorded_ticks);

  run_small(scenario, recorded_ticks, [&](const TickSample& sample, const Change* /*change*/) {
    const RecordedTick& tick = recorded[sample.tick];
    ASSERT_EQ(tick.tick, sample.tick);
    for (unsigned joint = 0; joint < 3; ++joint) {
      EXPECT_EQ(tick.setpoints[joint], sample.setpoints[joint]);
      EXPECT_EQ(tick.servo_commands[joint], made_up_command(sample.tick, joint));
      EXPECT_EQ(tick.joint_angles[joint], made_up_angle(sample.tick, joint));
      EXPECT_EQ(tick.motor_torques[joint], made_up_torque(sample.tick, joint));
      EXPECT_EQ(tick.servo_currents[joint], made_up_current(sample.tick, joint));
    }
    for (std::size_t link = 0; link < 4; ++link) {
      const Pose pose = made_up_pose(sample.tick, link);
      EXPECT_EQ(tick.link_poses[link].position, pose.position);
      EXPECT_EQ(tick.link_poses[link].orientation.coeffs(), pose.orientation.coeffs());
      EXPECT_EQ(tick.latched_contacts[link], made_up_contacts(sample.tick, link));
      EXPECT_EQ(tick.contact_forces[link], made_up_contact_force(sample.tick, link));
    }
    // Slot 0 drives all joints and has three internal values; slot 2 has none.
    ASSERT_EQ(tick.internal_values.size(), 9U);
    for (unsigned i = 0; i < 9; ++i) {
      EXPECT_EQ(tick.internal_values[i], sample.internal_values[i]);
    }
  });
}

TEST(Recorder, KeepsThePosesOfObjectsThatMove) {
  const TemporaryFolder folder;
  Scenario scenario = small_scenario();
  scenario.environment.moving_objects.push_back({"ball", {}, {}, {}, {}});
  scenario.environment.moving_objects.push_back({"crate", {}, {}, {}, {}});
  {
    Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) {
      const std::array<Pose, 2> poses{made_up_pose(sample.tick, 5), made_up_pose(sample.tick, 6)};
      TickSample with_objects = sample;
      with_objects.object_poses = poses;
      recorder.record_tick(with_objects);
    });
    recorder.finish({});
  }
  const Recording recording(folder / "run.sqlite");
  EXPECT_EQ(recording.objects(), (std::vector<std::string>{"ball", "crate"}));
  recording.read_ticks(0, 19, [](const RecordedTick& tick) {
    ASSERT_EQ(tick.object_poses.size(), 2U);
    for (std::size_t object = 0; object < 2; ++object) {
      const Pose pose = made_up_pose(tick.tick, 5 + object);
      EXPECT_EQ(tick.object_poses[object].position, pose.position);
      EXPECT_EQ(tick.object_poses[object].orientation.coeffs(), pose.orientation.coeffs());
    }
  });
}

TEST(Recorder, OfARealRobotHasNoPosesOfObjects) {
  const TemporaryFolder folder;
  Scenario scenario = small_scenario();
  scenario.environment.moving_objects.push_back({"ball", {}, {}, {}, {}});
  record_small(folder / "run.sqlite", scenario, 3);  // samples without objects
  const Recording recording(folder / "run.sqlite");
  EXPECT_TRUE(recording.objects().empty());
  recording.read_ticks(0, 2, [](const RecordedTick& tick) { EXPECT_TRUE(tick.object_poses.empty()); });
}

TEST(Recorder, ARecordingOfAnOlderProgramHasNoObjects) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), 3);
  Database(folder / "run.sqlite", SQLITE_OPEN_READWRITE).execute("DROP TABLE object; DROP TABLE object_pose");
  const Recording recording(folder / "run.sqlite");
  EXPECT_TRUE(recording.objects().empty());
}

TEST(Recorder, KeepsEveryServoPulseWithItsTime) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), recorded_ticks);
  std::vector<ServoPulse> recorded;
  const Recording recording(folder / "run.sqlite");
  ServoPulseReader reader(recording);
  while (const auto pulse = reader.next()) {
    recorded.push_back(*pulse);
  }
  ASSERT_EQ(recorded.size(), recorded_ticks * 2 * 3);
  std::size_t i = 0;
  for (std::uint32_t tick = 0; tick < recorded_ticks; ++tick) {
    for (const ServoPulse& expected : made_up_pulses(tick, 3)) {
      EXPECT_EQ(recorded[i].time_us, expected.time_us);
      EXPECT_EQ(recorded[i].joint, expected.joint);
      EXPECT_EQ(recorded[i].command, expected.command);
      ++i;
    }
  }
}

TEST(Recorder, KeepsTimesOfADay) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  constexpr std::uint64_t day_us = 86'400'000'000;
  {
    Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
    run_small(scenario, 1, [&](const TickSample& sample, const Change* /*change*/) {
      TickSample late = sample;
      const std::vector<ServoPulse> pulses{{day_us, 0, 1}, {day_us, 1, 2}, {day_us, 2, 3}};
      late.servo_pulses = pulses;
      recorder.record_tick(late);
    });
  }
  std::vector<std::uint64_t> times;
  const Recording recording(folder / "run.sqlite");
  ServoPulseReader reader(recording);
  while (const auto pulse = reader.next()) {
    times.push_back(pulse->time_us);
  }
  EXPECT_EQ(times, (std::vector<std::uint64_t>{day_us, day_us, day_us}));
}

TEST(Recorder, KeepsScenarioAndProgram) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  record_small(folder / "run.sqlite", scenario, recorded_ticks);

  const Recording recording(folder / "run.sqlite");
  EXPECT_TRUE(recording.finished());
  EXPECT_EQ(recording.run_value("build_id"), "build-7");
  EXPECT_EQ(recording.run_value("seed"), "18446744073709551557");
  EXPECT_EQ(recording.run_value("scenario"), scenario.path);
  EXPECT_EQ(recording.run_value("robot"), "Small");
  EXPECT_EQ(recording.run_value("tick_us"), "10000");
  EXPECT_EQ(recording.run_value("step_s"), "0.001");
  EXPECT_EQ(recording.run_value("no such key"), "");
  EXPECT_EQ(recording.results(),
            (std::vector<std::pair<std::string, std::string>>{{"displacement_m", "1.625"}, {"setpoint_hash", "abc"}}));
  ASSERT_EQ(recording.sources().size(), 2U);
  EXPECT_EQ(recording.sources()[1].first, "robot.xml");
  EXPECT_EQ(recording.sources()[1].second, "tab\there \"quoted\"\n");
  EXPECT_EQ(recording.links(), (std::vector<std::string>{"Head", "Link2", "Link1", "Tail"}));
  ASSERT_EQ(recording.joints().size(), 3U);
  EXPECT_EQ(recording.joints()[0].name, "J3");
  EXPECT_EQ(recording.joints()[0].file_index, 2U);
  EXPECT_EQ(recording.joints()[0].lower_limit, -500'000'000);
  EXPECT_EQ(recording.joints()[0].upper_limit, 600'000'000);
  ASSERT_EQ(recording.slots().size(), 2U);
  EXPECT_EQ(recording.slots()[1].slot, 2U);
  EXPECT_EQ(recording.slots()[1].algorithm, "DirectJointAccess");
  EXPECT_EQ(recording.slots()[1].joint_group, (std::vector<bool>{false, false, true}));
}

TEST(Recorder, KeepsEveryParameterWithItsChangesInFlight) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  record_small(folder / "run.sqlite", scenario, recorded_ticks);
  const std::vector<RecordedSetting> parameters = Recording(folder / "run.sqlite").parameters();

  const std::span<const Parameter> declared = scenario.kernel.slots[0].algorithm->declaration().parameters;
  ASSERT_EQ(parameters.size(), 3 * declared.size() + 2);  // one of slot 2 at the start, one commit
  for (std::size_t i = 0; i < 3 * declared.size(); ++i) {
    const Parameter& parameter = declared[i % declared.size()];
    EXPECT_EQ(parameters[i].joint, i / declared.size());
    EXPECT_EQ(parameters[i].name, parameter.name);
    EXPECT_FALSE(parameters[i].commit);
    const bool set = parameters[i].joint == 1 && parameter.name == "amplitude";
    EXPECT_EQ(parameters[i].raw, set ? scenario.settings[0].value : parameter.default_value);
  }
  const RecordedSetting& commit = parameters.back();
  EXPECT_TRUE(commit.commit);
  EXPECT_EQ(commit.tick, 5U);
  EXPECT_EQ(commit.slot, 2U);
  EXPECT_EQ(commit.joint, 2U);
  EXPECT_EQ(commit.name, "angle");
  EXPECT_EQ(commit.raw, raw(Unit::degree, -7));
}

TEST(Recorder, KeepsDistortions) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), recorded_ticks);
  const std::vector<RecordedSetting> distortions = Recording(folder / "run.sqlite").distortions();
  ASSERT_EQ(distortions.size(), 1U);
  EXPECT_EQ(distortions[0].tick, 7U);
  EXPECT_EQ(distortions[0].joint, 0U);
  EXPECT_EQ(distortions[0].name, "current_phase");
  EXPECT_EQ(distortions[0].raw, 1 << 30);
}

TEST(Recorder, WritesTablesThatAPersonCanQuery) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.sqlite";
  record_small(path, small_scenario(), recorded_ticks);
  EXPECT_EQ(rows(path, "SELECT raw, value_text, unit FROM parameter WHERE joint = 1 AND name = 'amplitude'", 3),
            (std::vector<std::string>{"146744716|12.3|deg"}));
  EXPECT_EQ(rows(path, "SELECT value_text, unit FROM distortion", 2), (std::vector<std::string>{"90|deg"}));
  EXPECT_EQ(rows(path, "SELECT joint, time_s FROM sample_by_name WHERE tick = 9 ORDER BY joint", 2),
            (std::vector<std::string>{"J1|0.1", "J2|0.1", "J3|0.1"}));
  // The head's joint at 1 Hz, 80 ms after the start.
  EXPECT_EQ(rows(path,
                 "SELECT round(value, 3), unit FROM internal_value_by_name WHERE tick = 7 AND joint = 'J3' AND name = "
                 "'current_phase'",
                 2),
            (std::vector<std::string>{"28.8|deg"}));
  EXPECT_EQ(
      rows(path, "SELECT abs(setpoint_deg - 40 * sin(radians(28.8))) < 1e-4 FROM sample WHERE tick = 7 AND joint = 0",
           1),
      (std::vector<std::string>{"1"}));
  EXPECT_EQ(rows(path,
                 "SELECT count(*) FROM sample WHERE setpoint_deg <> setpoint_raw * 90.0 / 1073741824 OR servo_us <> "
                 "servo_command / 12.0 OR abs(angle_deg - degrees(angle_rad)) > 1e-12",
                 1),
            (std::vector<std::string>{"0"}));
  EXPECT_EQ(rows(path, "PRAGMA integrity_check", 1), (std::vector<std::string>{"ok"}));
}

TEST(Recorder, LeavesOneFile) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), recorded_ticks);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"run.sqlite"}));
}

TEST(Recorder, CommitsAnUnfinishedRunWhenItIsDestroyed) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  {
    Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"run.sqlite"}));
  const Recording recording(folder / "run.sqlite");
  EXPECT_FALSE(recording.finished());
  EXPECT_EQ(recording.last_tick(), 19U);
}

TEST(Recorder, RecordsTheSameRunTwiceTheSame) {
  const TemporaryFolder folder;
  record_small(folder / "a.sqlite", small_scenario(), recorded_ticks);
  record_small(folder / "b.sqlite", small_scenario(), recorded_ticks);
  const std::string sql = "SELECT tick, joint, setpoint_raw, servo_command, hex(angle_rad) FROM sample";
  EXPECT_EQ(rows(folder / "a.sqlite", sql, 5), rows(folder / "b.sqlite", sql, 5));
}

TEST(Recorder, ReplacesAnEarlierRecording) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), recorded_ticks);
  record_small(folder / "run.sqlite", small_scenario(), 10);
  EXPECT_EQ(Recording(folder / "run.sqlite").last_tick(), 9U);
}

TEST(Recorder, ChangesNoOtherFileWhenItReplacesARecording) {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"run", "run-new", "run.part", "run2"};
  for (const std::string& name : names) {
    record_small(folder / name, small_scenario(), recorded_ticks);
  }
  record_small(folder / "run", small_scenario(), 10);
  EXPECT_EQ(folder.names(), names);
  EXPECT_EQ(Recording(folder / "run-new").last_tick(), recorded_ticks - 1);
}

TEST(Recorder, ReplacesADamagedRecording) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", small_scenario(), recorded_ticks);
  std::filesystem::resize_file(folder / "run.sqlite", 10'000);
  record_small(folder / "run.sqlite", small_scenario(), 10);
  EXPECT_EQ(Recording(folder / "run.sqlite").last_tick(), 9U);
}

TEST(Recorder, WritesIntoAnEmptyFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "run.sqlite").flush();
  record_small(folder / "run.sqlite", small_scenario(), 10);
  EXPECT_TRUE(Recording(folder / "run.sqlite").finished());
}

TEST(Recorder, LeavesATextFileAlone) {
  const TemporaryFolder folder;
  expect_left_alone(folder / "notes.txt", "notes of a summer\n");
}

TEST(Recorder, LeavesAForeignDatabaseAlone) {
  const TemporaryFolder folder;
  {
    Database database(folder / "other.sqlite", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    database.execute("CREATE TABLE addresses(name TEXT)");
  }
  expect_left_alone(folder / "other.sqlite", file_contents(folder / "other.sqlite"));
}

TEST(Recorder, LeavesAFolderAlone) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  EXPECT_NE(message_of<FileError>([&] { Recorder(folder.path(), scenario, "test", "build"); }).find("is not a file"),
            std::string::npos);
}

TEST(Recorder, LeavesTheFilesBesideARecordingAlone) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  for (const std::string suffix : {"-wal", "-shm", "-journal"}) {
    EXPECT_NE(message_of<FileError>([&] {
                Recorder(folder / ("run.proleg" + suffix), scenario, "test", "build");
              }).find("the name ends in " + suffix),
              std::string::npos);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(Recorder, IfItMustNotReplaceAFileLeavesRecordingsAndLinksAlone) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  record_small(folder / "run.proleg", scenario, 10);
  std::filesystem::create_symlink(folder / "outside", folder / "link.proleg");
  for (const char* const name : {"run.proleg", "link.proleg"}) {
    EXPECT_NE(message_of<FileError>([&] {
                Recorder(folder / name, scenario, "test", "build", EarlierFile::is_refused);
              }).find("exists already"),
              std::string::npos)
        << name;
  }
  EXPECT_EQ(Recording(folder / "run.proleg").last_tick(), 9U);
  EXPECT_FALSE(std::filesystem::exists(folder / "outside"));
  Recorder(folder / "new.proleg", scenario, "test", "build", EarlierFile::is_refused).finish({});
  EXPECT_TRUE(is_recording(folder / "new.proleg"));
}

TEST(Recorder, DoesNotReplaceARecordingThatIsBeingWritten) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  Recorder first(folder / "run.sqlite", scenario, "test", "build");
  EXPECT_NE(message_of<FileError>([&] {
              Recorder(folder / "run.sqlite", scenario, "test", "build");
            }).find("another program is recording"),
            std::string::npos);
  first.finish({});
}

TEST(Recorder, ReportsWhyAFileCannotBeCreated) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  const std::string message =
      message_of<FileError>([&] { Recorder(folder / "no such folder" / "run.sqlite", scenario, "test", "build"); });
  EXPECT_NE(message.find("run.sqlite"), std::string::npos) << message;
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_TRUE(folder.names().empty());
}

TEST(Recorder, RefusesNumbersThatAreNotFinite) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
  run_small(scenario, 3, [&](const TickSample& sample, const Change* /*change*/) {
    if (sample.tick < 2) {
      recorder.record_tick(sample);
      return;
    }
    std::vector<double> angles(sample.joint_angles.begin(), sample.joint_angles.end());
    angles[1] = std::nan("");
    std::vector<Pose> poses(sample.link_poses.begin(), sample.link_poses.end());
    poses[3].position.x() = std::numeric_limits<double>::infinity();
    for (const TickSample& bad : {with_measurements(sample, sample.link_poses, angles),
                                  with_measurements(sample, poses, sample.joint_angles)}) {
      const std::string message = message_of<FileError>([&] { recorder.record_tick(bad); });
      EXPECT_NE(message.find("at tick 2"), std::string::npos) << message;
      EXPECT_NE(message.find("unstable"), std::string::npos) << message;
    }
  });
  recorder.finish({});
  EXPECT_EQ(Recording(folder / "run.sqlite").last_tick(), 1U);
}

TEST(Recorder, RejectsCallsAfterTheEnd) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
  recorder.finish({});
  EXPECT_THROW(recorder.finish({}), FileError);
  EXPECT_THROW(recorder.record_change(scenario.changes[0]), FileError);
}

TEST(Recorder, ReportsADiskThatIsFull) {
  // For the child process a limit on the size of files acts as a full disk.
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.sqlite";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{400'000, 400'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const Scenario scenario = small_scenario();
    const std::string message = message_of<FileError>([&] {
      Recorder recorder(path, scenario, "test", "build");
      try {
        run_small(scenario, 20'000,
                  [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
        recorder.finish({});
      } catch (const FileError& first) {
        // The recorder rejects calls after an error, so that a recording has no gap.
        if (message_of<FileError>([&] { recorder.finish({}); }) != first.what()) {
          _exit(3);
        }
        throw;
      }
    });
    const bool one_line = message.find('\n') == std::string::npos;
    _exit(message.find(path.string() + ": recording stopped: ") == 0 && one_line ? 0 : 4);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(Recorder, ReportsThatItsFileIsRenamedOrOverwritten) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.sqlite";
  const Scenario scenario = small_scenario();
  const auto message_after = [&](const std::function<void()>& change) {
    Recorder recorder(path, scenario, "test", "build");
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
    change();
    return message_of<FileError>([&] { recorder.finish({}); });
  };
  const std::string renamed = message_after([&] { std::filesystem::rename(path, folder / "renamed.sqlite"); });
  EXPECT_EQ(renamed.find(path.string() + ": recording stopped: another program removed, renamed or replaced"), 0U)
      << renamed;
  EXPECT_EQ(Recording(folder / "renamed.sqlite").last_tick(), 19U);
  const std::string overwritten = message_after([&] { std::ofstream(path, std::ios::binary) << "other"; });
  EXPECT_EQ(overwritten.find(path.string() + ": recording stopped: another program shortened or overwrote"), 0U)
      << overwritten;
  EXPECT_EQ(file_contents(path), "other");
}

TEST(Recorder, CanBeReadWhileItWrites) {
  const TemporaryFolder folder;
  const Scenario scenario = small_scenario();
  std::uint32_t seen = 0;
  Recorder recorder(folder / "run.sqlite", scenario, "test", "build");
  EXPECT_NE(message_of<std::runtime_error>([&] { Recording(folder / "run.sqlite"); }).find("no tick"),
            std::string::npos);
  run_small(scenario, 40, [&](const TickSample& sample, const Change* /*change*/) {
    if (sample.tick == 20) {
      usleep(600'000);  // longer than a commit may wait
    }
    recorder.record_tick(sample);
    if (sample.tick == 21) {
      const Recording recording(folder / "run.sqlite");
      EXPECT_FALSE(recording.finished());
      EXPECT_GE(recording.last_tick(), 20U);  // 21 if that came half a second later
      recording.read_ticks(0, 20, [&](const RecordedTick& /*tick*/) { ++seen; });
    }
  });
  const Recording reader(folder / "run.sqlite");  // so that finish() cannot merge the log into the file
  recorder.finish({});
  EXPECT_EQ(seen, 21U);
  const Recording finished(folder / "run.sqlite");
  EXPECT_TRUE(finished.finished());
  EXPECT_EQ(finished.last_tick(), 39U);
}

}  // namespace
}  // namespace proleg::sim
