#include "tools/proleg/ui/live_simulation.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shared/computer/text/text.hpp"
#include "shipped.hpp"
#include "sim/record/recording.hpp"
#include "simulated_run.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

using StartValues = LiveSimulation::StartValues;

const sim::Scenario& uniform() {
  static const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  return scenario;
}

void advance(LiveSimulation& live, unsigned ticks) {
  for (unsigned tick = 0; tick < ticks; ++tick) {
    live.advance();
  }
}

ParameterPlace place(const LiveSimulation& live, const std::string& name) {
  return live.places_of(std::vector<std::string>{name}).front();
}

TEST(LiveSimulation, WithoutChangesItIsTheScenario) {
  LiveSimulation live(uniform(), {}, nullptr);
  advance(live, 200);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {}, 200));
  EXPECT_TRUE(live.repeating_words().empty());
}

TEST(LiveSimulation, AChangeTakesEffectAtTheComingTickAndIsConfirmedThen) {
  LiveSimulation live(uniform(), {}, nullptr);
  advance(live, 50);
  EXPECT_EQ(live.set({"amplitude:J2=30"}, std::nullopt), 50U);
  const ParameterPlace changed = place(live, "amplitude:J2");
  const ParameterTable::Values before = live.parameters().at(changed);
  EXPECT_EQ(before.confirmed, before.file);
  EXPECT_NE(before.wanted, before.file);
  live.advance();
  const ParameterTable::Values after = live.parameters().at(changed);
  EXPECT_EQ(after.confirmed, after.wanted);
  EXPECT_EQ(after.tick, 50U);
  EXPECT_EQ(after.file, before.file);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {"amplitude:J2=30@50"}, 51));
}

TEST(LiveSimulation, ARunOfRandomChangesRepeatsFromItsWords) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    LiveSimulation live(uniform(), {}, nullptr);
    const char* joints[] = {"", ":J1", ":J3", ":J5"};
    const auto advance_some = [&] { advance(live, static_cast<unsigned>(random() % 20)); };
    const auto change_something = [&] {
      switch (random() % 6) {
        case 0:
          live.set({"amplitude" + std::string(joints[random() % 4]) + "=" + std::to_string(random() % 60)},
                   std::nullopt);
          break;
        case 1:
          live.set(
              {"frequency=0." + std::to_string(random() % 9), "phase_difference=" + std::to_string(random() % 180)}, 7);
          break;
        case 2:
          live.undo();
          break;
        case 3:
          live.redo();
          break;
        case 4:
          live.swap_sets();
          break;
        default:
          live.set({"current_phase:J2=" + std::to_string(random() % 90)}, std::nullopt);
      }
    };
    for (int step = 0; step < 40; ++step) {
      change_something();
      advance_some();
    }
    EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), live.repeating_words(), live.simulation().tick()));

    live.restart(StartValues::wanted);
    advance_some();
    change_something();
    advance(live, 30);
    EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), live.repeating_words(), live.simulation().tick()));
  }
}

TEST(LiveSimulation, UndoTakesAGestureBackAsAWhole) {
  LiveSimulation live(uniform(), {}, nullptr);
  const ParameterPlace amplitude = place(live, "amplitude:J1");
  const std::int32_t file = live.parameters().at(amplitude).file;
  live.set({"amplitude=10"}, 1);
  advance(live, 3);
  live.set({"amplitude=20"}, 1);
  live.set({"amplitude=25"}, 1);
  live.set({"frequency=0.7"}, 2);
  EXPECT_TRUE(live.undo());
  EXPECT_EQ(live.history().to_undo()->name, "amplitude");
  EXPECT_TRUE(live.undo());
  EXPECT_EQ(live.parameters().at(amplitude).wanted, file);
  EXPECT_FALSE(live.undo());
  EXPECT_TRUE(live.redo());
  EXPECT_EQ(live.parameters().at(amplitude).wanted, raw(Unit::degree, 25));
  live.set({"amplitude=5"}, 3);
  EXPECT_TRUE(live.redo() == false) << "a new change ends what can be redone";
}

TEST(LiveSimulation, AWordThatCannotBeTakenChangesNothing) {
  LiveSimulation live(uniform(), {}, nullptr);
  const std::uint64_t revision = live.revision();
  for (const std::vector<std::string>& words : {std::vector<std::string>{},
                                                {"amplitude"},
                                                {"amplitude=1000"},
                                                {"amplitude=10@5"},
                                                {"nothing=1"},
                                                {"amplitude:J9=10"},
                                                {"amplitude=10", "frequency=-1e9"},
                                                {"amplitude=nan"}}) {
    EXPECT_THROW(live.set(words, std::nullopt), InputError);
  }
  EXPECT_EQ(live.revision(), revision);
  advance(live, 20);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {}, 20));
}

TEST(LiveSimulation, AChangeForOneTickNeverHasMoreValuesThanAModuleKeeps) {
  LiveSimulation live(uniform(), {}, nullptr);
  std::vector<std::uint32_t> ticks;
  for (int value = 0; value < 30; ++value) {
    ticks.push_back(live.set({"amplitude=" + std::to_string(value), "frequency=0.5", "phase_difference=60",
                              "offset=" + std::to_string(value)},
                             std::nullopt));
  }
  for (const Change& change : live.scenario().changes) {
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_LE(std::ranges::count(change.settings, joint, &Setting::joint),
                static_cast<std::ptrdiff_t>(max_staged_values));
    }
  }
  EXPECT_TRUE(std::ranges::is_sorted(ticks));
}

TEST(LiveSimulation, ARecordingHasTheWholeRunWheneverItBegan) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "run.proleg";
  LiveSimulation live(uniform(), {}, nullptr);
  advance(live, 80);
  live.set({"amplitude=30"}, std::nullopt);
  advance(live, 70);
  const Hashes before = hashes_of(live.simulation());
  ASSERT_TRUE(live.record(file, "simulate", "test", [] { return true; }));
  EXPECT_EQ(hashes_of(live.simulation()), before);
  live.set({"frequency=0.4"}, std::nullopt);
  advance(live, 50);
  const Hashes end = hashes_of(live.simulation());
  live.end_recording();
  const sim::Recording recording(file);
  EXPECT_TRUE(recording.finished());
  EXPECT_EQ(recording.first_tick(), 0U);
  EXPECT_EQ(recording.last_tick(), 199U);
  EXPECT_EQ(end, simulated(uniform(), {"amplitude=30@80", "frequency=0.4@150"}, 200));
  EXPECT_NE(std::ranges::find(recording.results(), std::pair<std::string, std::string>{"setpoint_hash", end.setpoints}),
            recording.results().end());
}

/// In a process whose files cannot grow. Exit status 0: the simulation goes on, and the failure was told.
[[noreturn]] void record_on_a_full_disk(const std::filesystem::path& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{300'000, 300'000};
  setrlimit(RLIMIT_FSIZE, &limit);
  LiveSimulation live(uniform(), {}, nullptr);
  live.record(path, "simulate", "test", [] { return true; });
  advance(live, 1'500);
  const bool has_failed = live.take_recording_failure().has_value();
  _exit(has_failed && !live.is_recording() && live.simulation().tick() == 1'500 ? 0 : 1);
}

TEST(LiveSimulation, GoesOnWhenTheDiskIsFullAndItsRecordingEnds) {
  const TemporaryFolder folder;
  EXPECT_EXIT(record_on_a_full_disk(folder / "run.proleg"), testing::ExitedWithCode(0), "");
}

TEST(LiveSimulation, RestartBeginsWithWhatIsWantedOrWithTheFile) {
  LiveSimulation live(uniform(), {}, nullptr);
  live.set({"amplitude=30"}, std::nullopt);
  advance(live, 10);
  live.restart(StartValues::wanted);
  EXPECT_EQ(live.repeating_words(), std::vector<std::string>({"1.amplitude=30"}));
  advance(live, 100);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {"amplitude=30"}, 100));
  live.restart(StartValues::file);
  advance(live, 100);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {}, 100));
}

TEST(LiveSimulation, ResetWantsTheFilesValueAgain) {
  LiveSimulation live(uniform(), {}, nullptr);
  live.set({"amplitude=30", "frequency=0.4"}, std::nullopt);
  advance(live, 10);
  live.reset(live.places_of(std::vector<std::string>{"amplitude"}));
  const ParameterTable::Values amplitude = live.parameters().at(place(live, "amplitude:J3"));
  EXPECT_EQ(amplitude.wanted, amplitude.file);
  const ParameterTable::Values frequency = live.parameters().at(place(live, "frequency:J3"));
  EXPECT_NE(frequency.wanted, frequency.file);
}

/// A place near the start, on the ground or above it.
std::string random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> metres(-0.5, 0.5);
  std::uniform_real_distribution<double> degrees(-180.0, 180.0);
  return exact_text(metres(random)) + ',' + exact_text(metres(random)) + ',' + exact_text(0.1 * metres(random)) + ',' +
         exact_text(degrees(random));
}

TEST(LiveSimulation, ARunWithMovesRepeatsFromItsWordsAndInARecordingFromMidRunOn) {
  const TemporaryFolder folder;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    sim::Scenario file = uniform();
    sim::add_move(file, "0.2,0.3,0.1,20@30");  // of the command line
    LiveSimulation live(file, {}, nullptr);
    unsigned moves = 1;
    for (int step = 0; step < 8; ++step) {
      advance(live, static_cast<unsigned>(random() % 20));
      if (random() % 2 == 0) {
        live.set({"amplitude=" + std::to_string(random() % 50)}, std::nullopt);
      }
      for (unsigned again = 0; again < random() % 3; ++again) {
        live.move(random_place(random));
        ++moves;
      }
    }
    ASSERT_TRUE(live.record(folder / std::to_string(seed), "simulate", "test", [] { return true; }));
    advance(live, 40);
    const std::uint32_t ticks = live.simulation().tick();
    EXPECT_EQ(hashes_of(live.simulation()), simulated(file, live.repeating_words(), ticks, live.repeating_moves()));
    live.end_recording();
    Database recording(folder / std::to_string(seed), SQLITE_OPEN_READONLY);
    Statement count(recording, "SELECT count(*) FROM move");
    ASSERT_TRUE(count.step());
    EXPECT_EQ(count.integer(0), moves);
  }
}

TEST(LiveSimulation, AMoveIsSeenAtOnceAndARestartForgetsIt) {
  LiveSimulation live(uniform(), {}, nullptr);
  advance(live, 20);
  live.move("1,2,0.1,0");
  EXPECT_TRUE(live.simulation().was_moved());
  EXPECT_NEAR(live.simulation().plant().link_poses().front().position.x(), 1.0, 1e-9);
  EXPECT_TRUE(live.repeating_moves().empty()) << "the run up to now does not have it yet";
  live.advance();
  EXPECT_FALSE(live.simulation().was_moved());
  EXPECT_EQ(live.repeating_moves(), (std::vector<std::string>{"1,2,0.1,0@20"}));
  live.restart(StartValues::wanted);
  advance(live, 30);
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {}, 30));
}

TEST(LiveSimulation, AMoveThatIsRefusedChangesNothing) {
  LiveSimulation live(uniform(), {}, nullptr);
  advance(live, 20);
  for (const char* place : {"1.5e3,0,0,0", "0,0,99,0", "nan,0,0,0", "0,0,0", "0,0,0,0@5", ""}) {
    EXPECT_THROW(live.move(place), InputError) << place;
  }
  advance(live, 20);
  EXPECT_TRUE(live.repeating_moves().empty());
  EXPECT_EQ(hashes_of(live.simulation()), simulated(uniform(), {}, 40));
}

}  // namespace
}  // namespace proleg::tools
