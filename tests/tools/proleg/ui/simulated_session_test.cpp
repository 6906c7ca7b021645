#include "tools/proleg/ui/simulated_session.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/temporary_folder.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

class SimulatedSessionTest : public ::testing::Test {
 protected:
  void open(bool starts_paused) {
    open(std::make_unique<LiveSimulation>(scenario_, std::vector<std::string>{}, nullptr), starts_paused);
  }
  /// live: null: there is no simulation.
  void open(std::unique_ptr<LiveSimulation> live, bool starts_paused) {
    session_.reset();
    requests_.emplace();
    session_.emplace(std::move(live),
                     SimulatedSessionOptions{
                         folder_ / "", "proleg simulate uniform.simulation.xml", {}, false, "test", starts_paused},
                     *requests_, viewers_);
  }
  /// A run with changes of all kinds.
  void record_run(const std::string& name, std::uint32_t ticks) {
    open(true);
    ask("factor", {{"value", 0}});
    EXPECT_TRUE(ask("set", {{"words", {"amplitude:J3=25"}}}).is_done);  // a change at tick 0
    EXPECT_TRUE(ask("record", {{"file", name}}).is_done);
    step_to(50);
    EXPECT_TRUE(ask("set", {{"words", {"amplitude:J2=30", "current_phase:J1=90"}}}).is_done);
    step_to(80);
    EXPECT_TRUE(ask("move", {{"position", {0.5, 0.25, 0.125}}, {"turn", 30}}).is_done);
    step_to(ticks);
    EXPECT_TRUE(ask("record", {{"file", nullptr}}).is_done);
  }
  void step_to(std::uint32_t tick) {
    const json session = viewers_.session([](const json& document) { return document.contains("tick"); });
    ask("step", {{"ticks", tick - session["tick"].get<std::uint32_t>()}});
    viewers_.session([&](const json& document) { return document["tick"] == tick; });
  }
  /// When it stands at the tick of the recording.
  void wait_for_continued(std::uint32_t tick) {
    viewers_.session([&](const json& document) {
      return document["tick"] == tick + 1 && document["repeats"].is_null() && document["state"] == "paused";
    });
  }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> results(const std::string& name) const {
    return sim::Recording(folder_ / name).results();
  }
  Viewers::Answer ask(const std::string& name, const json& arguments = json::object()) {
    requests_->operate({++request_, name, arguments, 1, "a test"});
    return viewers_.answer(request_);
  }
  Viewers::Answer stop() {
    requests_->stop({++request_, "a test"});
    return viewers_.answer(request_);
  }

  sim::Scenario scenario_ = sim::shipped("travelling_wave/uniform");
  TemporaryFolder folder_;
  Viewers viewers_;
  std::uint64_t request_ = 0;
  std::optional<SessionRequests> requests_;
  std::optional<SimulatedSession> session_;
};

TEST_F(SimulatedSessionTest, MovesFromTheStartAndShowsEveryTick) {
  open(false);
  viewers_.wait_for_tick(30);
  EXPECT_TRUE(viewers_.is_gapless());
  EXPECT_EQ(viewers_.document("robot")["joints"].size(), 5U);
  EXPECT_EQ(viewers_.document("robot")["links"].size(), 6U);
}

TEST_F(SimulatedSessionTest, StepsByTicks) {
  open(true);
  EXPECT_EQ(viewers_.rows(), 0U);
  EXPECT_TRUE(ask("step", {{"ticks", 7}}).is_done);
  viewers_.session([](const json& session) { return session["tick"] == 7; });
  EXPECT_EQ(viewers_.rows(), 7U);
}

TEST_F(SimulatedSessionTest, ServesViewersAfterAnErrorUntilARestart) {
  viewers_.fails_at_tick = 3;
  open(false);
  EXPECT_EQ(viewers_.state("failed")["failure"], "a row without signals");
  EXPECT_EQ(viewers_.notices(), "a row without signals\n");
  EXPECT_EQ(ask("run").text, "the simulation has failed; restart it");
  viewers_.fails_at_tick = 0xFFFF'FFFF;
  EXPECT_TRUE(ask("restart").is_done);
  EXPECT_TRUE(ask("run").is_done);
  viewers_.state("running");
}

TEST_F(SimulatedSessionTest, StopHoldsFromEveryState) {
  for (const bool starts_paused : {true, false}) {
    open(starts_paused);
    EXPECT_EQ(stop().text, "5 of 5");
    viewers_.state("stopped");
    const std::uint64_t rows = viewers_.rows();
    EXPECT_TRUE(ask("set", {{"words", {"amplitude=30"}}}).is_done);
    EXPECT_EQ(viewers_.rows(), rows);
    EXPECT_TRUE(ask("run").is_done);
    viewers_.state("running");
  }
}

TEST_F(SimulatedSessionTest, WhatWasAskedForBeforeAStopHasNoEffectAfterIt) {
  open(true);
  for (int round = 0; round < 50; ++round) {
    requests_->operate({++request_, "run", json::object(), 1, "a test"});
    const std::uint64_t run = request_;
    stop();
    viewers_.answer(run);
    EXPECT_EQ(viewers_.state("stopped")["state"], "stopped");
    const std::uint64_t rows = viewers_.rows();
    ask("command_line");
    EXPECT_EQ(viewers_.rows(), rows);
  }
}

TEST_F(SimulatedSessionTest, ARunOfOperationsIsTheRunOfItsCommandLine) {
  open(true);
  ask("factor", {{"value", 0}});
  ask("step", {{"ticks", 100}});
  viewers_.session([](const json& session) { return session["tick"] == 100; });
  EXPECT_EQ(ask("set", {{"words", {"amplitude:J2=30"}}, {"gesture", 1}}).text, R"({"tick":100})");
  EXPECT_TRUE(ask("record", {{"file", "run.proleg"}}).is_done);
  ask("step", {{"ticks", 100}});
  viewers_.session([](const json& session) { return session["tick"] == 200; });
  EXPECT_EQ(json::parse(ask("command_line").text)["text"],
            "proleg simulate uniform.simulation.xml --set 1.amplitude:J2=30@100 --seconds 2");
  EXPECT_TRUE(ask("record", {{"file", nullptr}}).is_done);
  const sim::Recording recording(folder_ / "run.proleg");
  EXPECT_TRUE(recording.finished());
  EXPECT_EQ(recording.last_tick(), 199U);
}

TEST_F(SimulatedSessionTest, RefusesInOneLineWhatItCannotDo) {
  open(true);
  std::ofstream(folder_ / "there.proleg") << "a file of the user";
  std::filesystem::create_symlink(folder_ / "outside.proleg", folder_ / "link.proleg");
  const std::pair<const char*, json> operations[] = {
      {"fly", json::object()},
      {"step", {{"ticks", 0}}},
      {"step", {{"ticks", 1'000'000}}},
      {"step", {{"ticks", "many"}}},
      {"factor", {{"value", 0.01}}},
      {"factor", {{"value", 1e9}}},
      {"factor", json::object()},
      {"set", json::object()},
      {"set", {{"words", "amplitude=30"}}},
      {"set", {{"words", {"amplitude=30\nrun"}}}},
      {"reset", {{"names", {"nothing"}}}},
      {"reset", {{"names", {"9.amplitude"}}}},
      {"reset", {{"names", "amplitude"}}},
      {"restart", {{"parameters", "mine"}}},
      {"undo", json::object()},
      {"redo", json::object()},
      {"record", {{"file", "../run.proleg"}}},
      {"record", {{"file", "/tmp/run.proleg"}}},
      {"record", {{"file", "run.txt"}}},
      {"record", {{"file", ""}}},
      {"record", {{"file", "there.proleg"}}},
      {"record", {{"file", "link.proleg"}}},
  };
  for (const auto& [name, arguments] : operations) {
    SCOPED_TRACE(name + (' ' + arguments.dump()));
    const Viewers::Answer answer = ask(name, arguments);
    EXPECT_FALSE(answer.is_done);
    EXPECT_EQ(answer.text.find('\n'), std::string::npos);
    EXPECT_FALSE(answer.text.empty());
  }
  EXPECT_EQ(viewers_.rows(), 0U);
}

TEST_F(SimulatedSessionTest, ARestartIsAnotherRun) {
  open(true);
  ask("step", {{"ticks", 5}});
  const json before = viewers_.session([](const json& session) { return session["tick"] == 5; });
  ask("restart");
  const json after = viewers_.session([](const json& session) { return session["tick"] == 0; });
  EXPECT_NE(before["run"], after["run"]);
  EXPECT_EQ(after["state"], "paused");
}

TEST_F(SimulatedSessionTest, ARobotWithoutFilesRefusesToWriteThem) {
  open(true);
  EXPECT_TRUE(ask("set", {{"words", {"amplitude=30"}}}).is_done);
  for (const char* operation : {"file.diff", "file.apply"}) {
    const Viewers::Answer answer = ask(operation);
    EXPECT_FALSE(answer.is_done);
    EXPECT_EQ(answer.text,
              "this robot has no file yet; Save as writes its files, as `proleg new robot --joints 5` does");
  }
}

TEST_F(SimulatedSessionTest, SavesARobotIntoAFolderOfItsOwnAndGoesOnThere) {
  session_.reset();
  requests_.emplace();
  session_.emplace(
      std::make_unique<LiveSimulation>(scenario_, std::vector<std::string>{}, nullptr),
      SimulatedSessionOptions{folder_ / "", "proleg simulate shipped",
                              [](const std::string& file) { return "proleg simulate " + file; }, true, "test", true},
      *requests_, viewers_);
  EXPECT_TRUE(ask("set", {{"words", {"amplitude=30"}}}).is_done);
  const json shipped_diff = json::parse(ask("file.diff").text);
  EXPECT_EQ(shipped_diff["is_shipped"], true);
  const Viewers::Answer refused = ask("file.apply", {{"diff", shipped_diff["diff"]}, {"entries", {0}}});
  EXPECT_FALSE(refused.is_done);
  EXPECT_NE(refused.text.find("ships with Proleg"), std::string::npos) << refused.text;
  for (const char* name : {"", ".", "..", "../wave", "a/b", ".hidden", "two\nlines", "from\u202Eright"}) {
    EXPECT_FALSE(ask("file.save_as", {{"folder", name}}).is_done) << name;
  }
  EXPECT_TRUE(ask("file.save_as", {{"folder", "my wave"}}).is_done);
  EXPECT_FALSE(ask("file.save_as", {{"folder", "my wave"}}).is_done) << "no folder is replaced";
  const json diff = json::parse(ask("file.diff").text);
  EXPECT_EQ(diff["entries"], json::array()) << "the copy has the wanted values";
  EXPECT_EQ(diff["is_shipped"], false);
  EXPECT_TRUE(ask("set", {{"words", {"amplitude=20"}}}).is_done);
  const json again = json::parse(ask("file.diff").text);
  EXPECT_TRUE(ask("file.apply", {{"diff", again["diff"]}, {"entries", {0}}}).is_done);
  sim::DiskFiles files;
  const sim::Scenario saved = sim::read_scenario(folder_ / "my wave/uniform.simulation.xml", files);
  LiveSimulation wanted(scenario_, {"amplitude=20"}, nullptr);
  const ParameterPlace place = wanted.places_of(std::vector<std::string>{"amplitude:J3"}).front();
  EXPECT_EQ(sim::start_value(saved, place.slot, place.joint, place.number), wanted.parameters().at(place).wanted);
  const std::string command = json::parse(ask("command_line").text)["text"];
  EXPECT_NE(command.find("my wave/uniform.simulation.xml"), std::string::npos) << command;
}

TEST_F(SimulatedSessionTest, MovesAPausedRobotAndRepeatsItInTheCommand) {
  open(true);
  EXPECT_TRUE(ask("step", {{"ticks", 5}}).is_done);
  viewers_.session([](const json& session) { return session["tick"] == 5; });
  EXPECT_EQ(ask("move", {{"position", {0.5, 0.25, 0.125}}, {"turn", 30}}).text, R"({"tick":5})");
  const json session = viewers_.session([](const json& document) { return document["moved"] == true; });
  EXPECT_NEAR(session["head"][0].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(session["head"][2].get<double>(), 0.125, 1e-9);
  EXPECT_TRUE(ask("step", {{"ticks", 5}}).is_done);
  viewers_.session([](const json& document) { return document["tick"] == 10 && document["moved"] == false; });
  EXPECT_EQ(viewers_.document("session")["last_move"], 5);
  EXPECT_EQ(json::parse(ask("command_line").text)["text"],
            "proleg simulate uniform.simulation.xml --move 0.5,0.25,0.125,30@5 --seconds 0.1");
}

TEST_F(SimulatedSessionTest, RefusesToMoveARobotThatRunsOrToABadPlace) {
  open(true);
  for (const json& position : {json({1, 2}), json("here"), json(), json({1e300, 0, 0}), json({5000, 0, 0})}) {
    EXPECT_FALSE(ask("move", {{"position", position}}).is_done) << position;
  }
  EXPECT_EQ(ask("move", {{"position", {1e300, 0, 0}}}).text,
            "position: found 1e+300, expected numbers from -10000 to 10000 m");
  EXPECT_EQ(ask("move", {{"position", {0, 0, 0.1}}, {"turn", -361}}).text,
            "turn: found -361, expected numbers from -360 to 360 degrees");
  EXPECT_TRUE(ask("run").is_done);
  EXPECT_EQ(ask("move", {{"position", {0, 0, 0.1}}}).text,
            "move: found a simulation that is not paused, expected a paused one");
}

TEST_F(SimulatedSessionTest, ContinuesARecordingBitForBit) {
  record_run("run.proleg", 300);
  std::size_t read_notices = 0;  // those of the runs before
  for (const std::uint32_t tick : {0U, 79U, 80U, 120U, 299U}) {
    SCOPED_TRACE(tick);
    open(nullptr, false);
    const Viewers::Answer answer = ask("continue", {{"file", "run.proleg"}, {"tick", tick}});
    ASSERT_TRUE(answer.is_done) << answer.text;
    wait_for_continued(tick);
    EXPECT_EQ(viewers_.document("robot")["joints"].size(), 5U);
    const std::string notices = viewers_.notices().substr(read_notices);
    EXPECT_NE(notices.find("bit for bit"), std::string::npos) << notices;
    read_notices += notices.size();
    if (tick < 80) {
      // What was done later is left out.
      continue;
    }
    const std::string again = "again" + std::to_string(tick) + ".proleg";
    EXPECT_TRUE(ask("record", {{"file", again}}).is_done);
    if (tick < 299) {
      step_to(300);
    }
    EXPECT_TRUE(ask("record", {{"file", nullptr}}).is_done);
    EXPECT_EQ(results(again), results("run.proleg"));
  }
}

TEST_F(SimulatedSessionTest, AContinuedRunIsDrivenAsAnyOther) {
  record_run("run.proleg", 100);
  open(true);  // beside a simulation, which it replaces
  const json before = viewers_.session([](const json& document) { return document["tick"] == 0; });
  EXPECT_TRUE(ask("continue", {{"file", "run.proleg"}, {"tick", 60}}).is_done);
  wait_for_continued(60);
  EXPECT_NE(viewers_.document("session")["run"], before["run"]);
  EXPECT_EQ(ask("set", {{"words", {"amplitude=10"}}}).text, R"({"tick":61})");
  step_to(70);
  // The file has amplitudes of its own; J3 and J2 have the recorded changes, then all the new one.
  const std::string command = json::parse(ask("command_line").text)["text"];
  EXPECT_NE(command.find("uniform.simulation.xml --set 1.amplitude:J3=25@0 "), std::string::npos) << command;
  EXPECT_NE(command.find("--set 1.amplitude:J2=30@50"), std::string::npos) << command;
  EXPECT_NE(command.find("--set 1.amplitude=10@61"), std::string::npos) << command;
  EXPECT_EQ(command.find("--move"), std::string::npos) << command;
  EXPECT_FALSE(ask("file.diff").is_done);
  EXPECT_TRUE(ask("restart").is_done);
  viewers_.session([](const json& document) { return document["tick"] == 0; });
}

TEST_F(SimulatedSessionTest, ContinuesWithTheFramesThatWereLost) {
  const sim::Losses losses(sim::RandomLosses{7, 1U << 29U, 10, 200});
  const sim::Scenario coupled = sim::shipped("travelling_wave/coupled");
  LiveSimulation live(coupled, {}, &losses);
  ASSERT_TRUE(live.record(folder_ / "lossy.proleg", "simulate", "test", [] { return true; }));
  while (live.simulation().tick() < 250) {
    live.advance();
  }
  live.end_recording();
  open(nullptr, true);
  EXPECT_TRUE(ask("continue", {{"file", "lossy.proleg"}, {"tick", 100}}).is_done);
  wait_for_continued(100);
  EXPECT_TRUE(ask("record", {{"file", "again.proleg"}}).is_done);
  step_to(250);
  EXPECT_TRUE(ask("record", {{"file", nullptr}}).is_done);
  EXPECT_EQ(results("again.proleg"), results("lossy.proleg"));
  EXPECT_FALSE(ask("command_line").is_done);  // it would give another run
}

TEST_F(SimulatedSessionTest, SaysFromWhichTickOnARecordingIsNotItsOwn) {
  record_run("run.proleg", 100);
  Database(folder_ / "run.proleg", SQLITE_OPEN_READWRITE)
      .execute("UPDATE sample SET setpoint_raw = setpoint_raw + 1 WHERE tick = 30 AND joint = 2");
  open(nullptr, true);
  EXPECT_TRUE(ask("continue", {{"file", "run.proleg"}, {"tick", 60}}).is_done);
  wait_for_continued(60);
  EXPECT_NE(viewers_.notices().find("from tick 30 on"), std::string::npos) << viewers_.notices();
}

TEST_F(SimulatedSessionTest, SaysWhichLinkOfARecordingMovedOtherwise) {
  record_run("run.proleg", 100);
  Database(folder_ / "run.proleg", SQLITE_OPEN_READWRITE)
      .execute("UPDATE pose SET x_m = x_m + 1e-15 WHERE tick = 30 AND link = 5");
  open(nullptr, true);
  EXPECT_TRUE(ask("continue", {{"file", "run.proleg"}, {"tick", 60}}).is_done);
  wait_for_continued(60);
  EXPECT_NE(viewers_.notices().find("from tick 30 on"), std::string::npos) << viewers_.notices();
  EXPECT_NE(viewers_.notices().find("link 'Tail' is elsewhere"), std::string::npos) << viewers_.notices();
}

TEST_F(SimulatedSessionTest, StaysWhereARecordingIsDamaged) {
  record_run("run.proleg", 600);
  Database(folder_ / "run.proleg", SQLITE_OPEN_READWRITE).execute("DELETE FROM pose WHERE tick = 400");
  open(nullptr, true);
  EXPECT_TRUE(ask("continue", {{"file", "run.proleg"}, {"tick", 500}}).is_done);
  const json session = viewers_.session(
      [](const json& document) { return document["state"] == "paused" && document["repeats"].is_null(); });
  EXPECT_LE(session["tick"], 401);
  EXPECT_NE(viewers_.notices().find("run.proleg: found "), std::string::npos) << viewers_.notices();
  EXPECT_TRUE(ask("run").is_done);
}

TEST_F(SimulatedSessionTest, RefusesToContinueWhatIsNoSimulation) {
  record_run("run.proleg", 100);
  record_run("robot.proleg", 100);
  Database(folder_ / "robot.proleg", SQLITE_OPEN_READWRITE)
      .execute("UPDATE run SET value = 'drive' WHERE key = 'program'");
  open(true);
  const std::pair<json, const char*> refusals[] = {
      {{{"file", "robot.proleg"}, {"tick", 5}},
       "robot.proleg: found a recording of 'drive', whose robot had modules, expected a recording of a simulation: "
       "only "
       "that can be computed again"},
      {{{"file", "run.proleg"}, {"tick", 100}}, "run.proleg: found tick 100, expected 0 to 99"},
      {{{"file", "run.proleg"}}, "tick: found none, expected a tick of the recording"},
      {{{"file", "run.proleg"}, {"tick", -1}}, "tick: found -1, expected a tick of the recording"}};
  for (const auto& [arguments, text] : refusals) {
    EXPECT_EQ(ask("continue", arguments).text, text);
  }
  EXPECT_FALSE(ask("continue", {{"file", "../run.proleg"}, {"tick", 5}}).is_done);
  step_to(5);  // the simulation is still there
}

TEST_F(SimulatedSessionTest, NothingDisturbsTheTicksThatAreComputedAgainButAStop) {
  record_run("run.proleg", 1000);
  open(nullptr, true);
  EXPECT_EQ(stop().text, "0 of 0");
  EXPECT_EQ(ask("run").text,
            "there is no simulation; simulate what the page Make has, or continue one from a recording");
  EXPECT_TRUE(ask("ping").is_done);
  requests_->operate({++request_, "continue", {{"file", "run.proleg"}, {"tick", 999}}, 1, "a test"});
  EXPECT_EQ(ask("set", {{"words", {"amplitude=10"}}}).text,
            "the run of run.proleg is computed again; wait, or pause it");
  EXPECT_EQ(stop().text, "5 of 5");
  const json stopped = viewers_.state("stopped");
  EXPECT_LT(stopped["tick"], 1000);
  EXPECT_TRUE(stopped["repeats"].is_null());
  EXPECT_TRUE(ask("run").is_done);
}

}  // namespace
}  // namespace proleg::tools
