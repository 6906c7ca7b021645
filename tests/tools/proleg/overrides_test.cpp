// Options of simulate and hil that replace values of the scenario.

#include <cmath>

#include "command_line.hpp"
#include "json_result.hpp"
#include "sim/record/recording.hpp"

namespace proleg::test {
namespace {

Json run(const Finished& finished) {
  EXPECT_EQ(finished.status, 0) << finished.err;
  return Json(finished.out);
}

TEST_F(CommandLine, ARunWithReplacedValuesIsRepeatedFromItsRecording) {
  const std::string recording = file("run.proleg").string();
  const std::vector<std::string> command{"simulate", scenario("coupled"), "--seconds", "1", "--json"};
  std::vector<std::string> words = command;
  for (const char* word : {"--seed", "12", "--friction", "0.35", "--at", "0.5,-1.25,0.1", "--heading", "-30.5"}) {
    words.emplace_back(word);
  }
  words.insert(words.end(), {"--record", recording});
  const Json first = run(proleg(words));

  std::vector<std::string> repeated = command;
  const sim::Recording recorded(recording);
  for (const char* name : {"seed", "friction", "at", "heading"}) {
    EXPECT_NE(recorded.run_value(std::string("override_") + name), "") << name;
    repeated.insert(repeated.end(), {std::string("--") + name, recorded.run_value(std::string("override_") + name)});
  }
  const Json second = run(proleg(repeated));
  for (const char* name : {"displacement_m", "setpoint_hash", "servo_hash", "seed", "overrides", "measures"}) {
    EXPECT_EQ(first[name], second[name]) << name;
  }
  const Json plain = run(proleg(command));
  EXPECT_NE(first["displacement_m"], plain["displacement_m"]);
  EXPECT_NE(first["setpoint_hash"], plain["setpoint_hash"]) << "the seed sets the noise of the start state";
  EXPECT_EQ(first["overrides"]["friction"], 0.35);
  EXPECT_EQ(first["overrides"]["at"], "0.5,-1.25,0.1");
  EXPECT_EQ(first["seed"], 12);
  EXPECT_EQ(plain["seed"], 1);
  for (const char* name : {"seed", "friction", "at", "heading_deg"}) {
    EXPECT_TRUE(plain["overrides"][name].is_null()) << name;
  }
}

TEST_F(CommandLine, ARecordingOfTheFilesAloneHasNoReplacedValues) {
  const std::string recording = file("run.proleg").string();
  ASSERT_EQ(proleg({"simulate", scenario("uniform"), "--seconds", "0.1", "--record", recording}).status, 0);
  const sim::Recording recorded(recording);
  for (const char* name : {"override_seed", "override_friction", "override_at", "override_heading"}) {
    EXPECT_EQ(recorded.run_value(name), "") << name;
  }
}

TEST_F(CommandLine, MeasuresAreRelativeToTheStartHeading) {
  const std::string recording = file("run.proleg").string();
  const Json measures = run(proleg({"simulate", scenario("uniform"), "--seconds", "5", "--at", "1,2", "--heading", "90",
                                    "--record", recording, "--json"}))["measures"];
  const double distance = measures["distance"].number();
  EXPECT_GT(distance, 0.1);
  EXPECT_NEAR(measures["speed"].number() * 5.0, distance, 0.05 * distance) << "it crawls where its head points";

  const sim::Recording recorded(recording);
  Eigen::Vector3d tail;
  recorded.read_ticks(recorded.last_tick(), recorded.last_tick(),
                      [&](const sim::RecordedTick& tick) { tail = tick.link_poses.back().position; });
  EXPECT_NEAR(tail.x(), 1.0 - distance, 0.05) << "to the left of the y axis is the negative x axis";
  EXPECT_NEAR(tail.y(), 2.0, 0.05);
}

TEST_F(CommandLine, TheOptionsThatReplaceValuesAreThoseOfSimulateAndHil) {
  for (const char* subcommand : {"simulate", "hil"}) {
    const Json result = run(proleg({subcommand, scenario("uniform"), "--seconds", "1", "--friction", "0.3", "--at",
                                    "1,1", "--heading", "45", "--seed", "5", "--json"}));
    EXPECT_EQ(result["overrides"]["heading_deg"], 45) << subcommand;
    EXPECT_EQ(result["seed"], 5) << subcommand;
  }
}

TEST_F(CommandLine, RefusesBadValuesThatReplaceThoseOfTheScenario) {
  for (const char* subcommand : {"simulate", "hil"}) {
    expect_refused({subcommand, scenario("uniform"), "--seed", "-1"}, {"--seed", "'-1'"});
    expect_refused({subcommand, scenario("uniform"), "--friction", "slippery"}, {"--friction", "0 to 1000"});
    expect_refused({subcommand, scenario("uniform"), "--at", "1"}, {"--at", "X,Y,Z"});
    expect_refused({subcommand, scenario("uniform"), "--heading", "1e3"}, {"--heading", "-360 to 360"});
  }
}

}  // namespace
}  // namespace proleg::test
