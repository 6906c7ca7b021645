// --engine, and the environment that chooses an engine.

#include <regex>

#include "command_line.hpp"
#include "json_result.hpp"
#include "sim/record/recording.hpp"

namespace proleg::test {
namespace {

std::string result_of(const std::string& recording, const std::string& name) {
  const sim::Recording recorded(recording);
  for (const auto& [key, value] : recorded.results()) {
    if (key == name) {
      return value;
    }
  }
  return "";
}

class Engine : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    fs::copy(source_path("/sim/scenarios/travelling_wave"), file("wave"), fs::copy_options::recursive);
  }

  void edit(const std::string& name, const std::string& old, const std::string& by) const {
    std::string text = read_file(file("wave") / name);
    ASSERT_NE(text.find(old), std::string::npos) << old;
    text.replace(text.find(old), old.size(), by);
    std::ofstream(file("wave") / name) << text;
  }

  /// The copy that edit() changes.
  [[nodiscard]] std::string edited() const { return (file("wave") / "uniform.simulation.xml").string(); }

  [[nodiscard]] Json succeed(std::vector<std::string> words) const {
    words.emplace_back("--json");
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return Json(finished.out);
  }

  [[nodiscard]] Json reduced(const std::string& subcommand, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{subcommand, scenario("coupled"), "--engine", "reduced", "--seconds", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return succeed(words);
  }
};

void expect_same_motion(const Json& one, const Json& other) {
  EXPECT_EQ(one["world_hash"].text().size(), 64U);
  for (const char* name : {"setpoint_hash", "servo_hash", "world_hash", "displacement_m"}) {
    EXPECT_EQ(one[name], other[name]) << name;
  }
}

TEST_F(Engine, AWordThatIsNoEngineIsRefused) {
  const std::string search = source_path("/sim/scenarios/travelling_wave/cma_es.optimise.xml");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"simulate", scenario("uniform")},
        {"hil", scenario("uniform")},
        {"sweep", scenario("uniform"), "--over", "amplitude=10:20:10", "--out", file("out").string()},
        {"optimise", search, "--out", file("out").string()},
        {"experiment", "travelling_wave", "--out", file("out").string()},
        {"confirm", scenario("uniform")}}) {
    for (const char* word : {"bullet", "ODE", ""}) {
      std::vector<std::string> words = command;
      words.insert(words.end(), {"--engine", word});
      expect_refused(words, {"--engine", "'" + std::string(word) + "'", "expected 'ode', 'reduced' or 'mujoco'"});
    }
  }
  EXPECT_FALSE(fs::exists(file("out")));
}

TEST_F(Engine, TheEnvironmentChoosesItAsTheOptionDoes) {
  const Json by_option = succeed({"simulate", edited(), "--engine", "reduced", "--seconds", "2"});
  edit("flat.environment.xml", "<physicsengine type=\"ode\">", "<physicsengine type=\"reduced\">");
  const Json by_file = succeed({"simulate", edited(), "--seconds", "2"});
  expect_same_motion(by_file, by_option);
  EXPECT_TRUE(by_file["overrides"]["engine"].is_null());
  EXPECT_EQ(by_option["overrides"]["engine"], "reduced");
  expect_same_motion(succeed({"hil", edited(), "--seconds", "2"}), by_file);
  const Json ode = succeed({"simulate", edited(), "--engine", "ode", "--seconds", "2"});
  EXPECT_TRUE(ode["world_hash"].is_null());
  EXPECT_EQ(ode["displacement_m"], succeed({"simulate", scenario("uniform"), "--seconds", "2"})["displacement_m"]);
}

TEST_F(Engine, NativeModulesAndTheFlashedImageMoveTheWorldOfSimulate) {
  const Json simulated = reduced("simulate");
  for (const char* modules : {"native", "mcu", "1,3=mcu"}) {
    const Json in_the_loop = reduced("hil", {"--modules", modules});
    expect_same_motion(in_the_loop, simulated);
    EXPECT_EQ(in_the_loop["differences"], 0) << modules;
  }
}

TEST_F(Engine, ARunAndItsRecordingHaveTheSameHashInEveryRun) {
  const auto record = [&](const std::string& subcommand, const std::string& name) {
    const std::string recording = file(name).string();
    const Json run = reduced(subcommand, {"--record", recording});
    for (const char* hash : {"setpoint_hash", "servo_hash", "world_hash"}) {
      EXPECT_EQ(run[hash], result_of(recording, hash)) << subcommand << ", " << hash;
    }
    return run;
  };
  const Json first = record("simulate", "first.proleg");
  expect_same_motion(record("simulate", "second.proleg"), first);
  expect_same_motion(record("hil", "loop.proleg"), first);
  EXPECT_NE(proleg({"simulate", scenario("coupled"), "--engine", "reduced", "--seconds", "2"})
                .out.find("world hash        " + first["world_hash"].text() + "\n"),
            std::string::npos);
  const Json replayed = succeed({"replay", file("first.proleg").string()});
  EXPECT_EQ(replayed["differences"], 0);
  EXPECT_EQ(replayed["setpoint_hash"], first["setpoint_hash"]);
}

TEST_F(Engine, ARecordingNamesTheEngineThatRepeatsIt) {
  const std::string recording = file("run.proleg").string();
  static_cast<void>(reduced("simulate", {"--record", recording}));
  EXPECT_EQ(sim::Recording(recording).run_value("override_engine"), "reduced");
}

TEST_F(Engine, AnotherStartOrGaitMovesAnotherWorld) {
  const std::string hash = reduced("simulate")["world_hash"].text();
  for (const std::vector<std::string>& change : {std::vector<std::string>{"--at", "0,0,0.027"},
                                                 {"--at", "0.5,0"},
                                                 {"--heading", "90"},
                                                 {"--heading", "180"},
                                                 {"--friction", "0.11"},
                                                 {"--set", "amplitude=39@199"}}) {
    EXPECT_NE(reduced("simulate", change)["world_hash"].text(), hash) << change[0] << ' ' << change[1];
  }
}

TEST_F(Engine, WhatTheReducedEngineDoesNotHaveIsRefusedByNameBeforeAnythingIsWritten) {
  struct Refused {
    const char* file;
    const char* old;
    const char* by;
    const char* found;
  };
  const char* const segment = "modules/segment.kinbody.xml";
  const char* const floor = "flat.environment.xml";
  const char* const box =
      "<Geom type=\"box\">\n      <translation>0 0.036 0</translation>\n      <extents>0.026 0.018 0.026</extents>";
  const char* const sphere = "<Geom type=\"sphere\"><translation>0 0.036 0</translation><radius>0.026</radius>";
  const char* const ball =
      "<KinBody name=\"ball\"><Body type=\"static\"><Translation>0 1 0</Translation><Geom type=\"sphere\">"
      "<radius>0.1</radius></Geom></Body></KinBody></Environment>";
  const char* const ramp =
      "<KinBody name=\"ramp\"><Body type=\"static\"><Translation>0 1 0</Translation><RotationAxis>0 1 0 20"
      "</RotationAxis><Geom type=\"box\"><extents>1 0.2 0.05</extents></Geom></Body></KinBody></Environment>";
  const std::string recording = file("run.proleg").string();
  for (const Refused& refused :
       {Refused{segment, box, sphere, "link '4Seg' with a sphere"},
        Refused{floor, "</Environment>", ball, "object 'ball' with a sphere"},
        Refused{floor, "</Environment>", ramp, "object 'ramp' with a box that is oblique"},
        Refused{floor, "<gravity>0 0 -9.81<", "<gravity>1 0 -9.81<", "gravity across the plane"}}) {
    fs::remove_all(file("wave"));
    fs::copy(source_path("/sim/scenarios/travelling_wave"), file("wave"), fs::copy_options::recursive);
    edit(refused.file, refused.old, refused.by);
    for (std::vector<std::string> words :
         {std::vector<std::string>{"simulate", edited(), "--record", recording},
          {"hil", edited(), "--record", recording, "--can-log", file("bus.log").string()},
          {"hil", edited(), "--modules", "1=mcu", "--trace", "1=" + file("trace.tsv").string()},
          {"hil", edited(), "--faults", "1:2"},
          {"confirm", edited()}}) {
      words.insert(words.end(), {"--seconds", "3", "--engine", "reduced"});
      expect_refused(words, {edited() + ": found " + refused.found, "what the reduced engine has", "--engine ode"});
    }
    EXPECT_EQ(left_behind(), std::vector<std::string>{"wave"}) << refused.found;
    EXPECT_EQ(proleg({"simulate", edited(), "--seconds", "0.1"}).status, 0) << "ODE has it: " << refused.found;
  }
}

TEST_F(Engine, ARobotOfPitchAndYawJointsRunsInItOnALevelFloor) {
  edit("caterpillar.robot.xml", "<axis>1 0 0<", "<axis>0 0 1<");
  const std::vector<std::string> rest{"--seconds", "3", "--engine", "reduced", "--json"};
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), rest.begin(), rest.end());
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return Json(finished.out);
  };
  const Json simulated = run({"simulate", edited()});
  const Json driven = run({"hil", edited()});
  EXPECT_EQ(simulated["world_hash"], driven["world_hash"]);
  EXPECT_EQ(simulated["setpoint_hash"], driven["setpoint_hash"]);
  EXPECT_GT(simulated["displacement_m"].number(), 0.01);
  const Json confirmed = Json(proleg({"confirm", edited(), "--seconds", "3", "--worlds", "5", "--json"}).out);
  EXPECT_EQ(confirmed["runs"][2]["failure"], "") << "the other engine has it";
}

// Links of 1 mg between ends of 50 g.
TEST_F(Engine, ARunThatExplodesEndsWithALineThatNamesItsTick) {
  edit("modules/segment.kinbody.xml", "<total>0.1<", "<total>0.000001<");
  std::vector<std::string> ticks;
  for (const std::string subcommand : {"simulate", "hil"}) {
    const std::string recording = file(subcommand + ".proleg").string();
    const Finished run = proleg({subcommand, edited(), "--engine", "reduced", "--record", recording, "--json"});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_EQ(run.out, "");
    const std::regex line(
        "(^|\n)proleg " + subcommand +
        ": tick ([0-9]+) \\([0-9.]+ s\\): the simulation became unstable: [^\n]*; the run until then is in " +
        recording + "\n$");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(run.err, found, line)) << run.err;
    ticks.push_back(found[2]);
    EXPECT_EQ(std::to_string(sim::Recording(recording).last_tick() + 1), ticks.back());
    EXPECT_EQ(proleg({"replay", recording}).status, 0);
  }
  EXPECT_EQ(ticks[0], ticks[1]);
}

}  // namespace
}  // namespace proleg::test
