// proleg hil, proleg replay and --losses as a user meets them.

#include <nlohmann/json.hpp>

#include "command_line.hpp"

namespace proleg::test {
namespace {

using nlohmann::json;

class Hil : public CommandLine {
 protected:
  [[nodiscard]] json succeed(std::vector<std::string> words) const {
    words.emplace_back("--json");
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
};

TEST_F(Hil, GivesTheSameHashesAsSimulate) {
  const json simulated = succeed({"simulate", scenario("coupled"), "--seconds", "3"});
  const json modules = succeed({"hil", scenario("coupled"), "--modules", "native", "--seconds", "3"});
  EXPECT_EQ(modules["modules"], 5);
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
  EXPECT_EQ(modules["servo_hash"], simulated["servo_hash"]);
  EXPECT_EQ(modules["displacement_m"], simulated["displacement_m"]);
  EXPECT_GT(modules["real_time_factor"], 0.0);
  EXPECT_NEAR(modules["bus_load"].get<double>(), 0.068, 0.007);
  EXPECT_NEAR(modules["frames"].get<double>(), 300 * 6.7, 40) << "5 state frames and SYNC a tick, TICK and heartbeats";
}

TEST_F(Hil, LosesTheFramesThatSimulateLoses) {
  const json clean = succeed({"simulate", scenario("coupled"), "--seconds", "2"});
  const json simulated = succeed({"simulate", scenario("coupled"), "--seconds", "2", "--losses", "7:5%"});
  const json modules = succeed({"hil", scenario("coupled"), "--seconds", "2", "--losses", "7:0.05"});
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_EQ(modules["lost_frames"], simulated["lost_frames"]);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
  EXPECT_NE(modules["setpoint_hash"], clean["setpoint_hash"]);
}

TEST_F(Hil, TakesLossesFromAFile) {
  std::ofstream(file("losses.txt")) << "30 J5 J4\n31 J5 *\n";
  const std::vector<std::string> losses{"--losses", file("losses.txt").string()};
  std::vector<std::string> simulate{"simulate", scenario("coupled"), "--seconds", "1"};
  std::vector<std::string> hil{"hil", scenario("coupled"), "--seconds", "1"};
  simulate.insert(simulate.end(), losses.begin(), losses.end());
  hil.insert(hil.end(), losses.begin(), losses.end());
  const json simulated = succeed(simulate);
  const json modules = succeed(hil);
  EXPECT_EQ(simulated["lost_frames"], 5);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
}

TEST_F(Hil, AModuleThatIsResetComesBackAndTheRecordingHoldsIt) {
  const json modules = succeed({"hil", scenario("coupled"), "--seconds", "3", "--reset", "3@100", "--set",
                                "amplitude=30@105", "--losses", "3:1%", "--record", file("run.proleg").string()});
  EXPECT_EQ(modules["differences"], 0);
  ASSERT_EQ(modules["restarts"].size(), 1U);
  EXPECT_EQ(modules["restarts"][0]["node"], 3);
  EXPECT_EQ(modules["restarts"][0]["tick"], 100);
  EXPECT_GT(modules["restarts"][0]["joined_tick"], 100);
  const json replayed = succeed({"replay", file("run.proleg").string(), "--verify"});
  EXPECT_EQ(replayed["differences"], 0);
  EXPECT_EQ(replayed["setpoint_hash"], modules["setpoint_hash"]);
  EXPECT_EQ(replayed["servo_hash"], modules["servo_hash"]);
  EXPECT_EQ(replayed["recorded_by"], "hil native");
}

TEST_F(Hil, LeavesALogOfTheBus) {
  (void)succeed({"hil", scenario("uniform"), "--seconds", "1", "--can-log", file("bus.log").string()});
  const std::string log = read_file(file("bus.log"));
  EXPECT_EQ(log.find("(0000000000.000056) can0 77F#05\n"), 0U) << "the host is the first: " << log.substr(0, 40);
  EXPECT_NE(log.find(" can0 000#0100\n"), std::string::npos) << "NMT start to all";
  EXPECT_NE(log.find(" can0 080#01\n"), std::string::npos) << "SYNC 0";
}

TEST_F(Hil, SendsAFrameAndLogsTheAnswer) {
  const json modules = succeed({"hil", scenario("uniform"), "--seconds", "1", "--send", "603#4034120000000000@50",
                                "--can-log", file("bus.log").string()});
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_NE(read_file(file("bus.log")).find(" can0 583#8034120000000206\n"), std::string::npos) << "no such object";
}

TEST_F(Hil, WhatCannotBeIsRefused) {
  const std::string file_name = scenario("uniform");
  expect_refused({"hil", file_name, "--modules", "mechanical"}, {"mechanical"});
  expect_refused({"hil", file_name, "--reset", "3"}, {"--reset", "'3'", "NODE@TICK"});
  expect_refused({"hil", file_name, "--reset", "9@100"}, {"node 9", "one of 1, 2, 3, 4, 5"});
  expect_refused({"hil", file_name, "--reset", "3@0"}, {"tick 0"});
  expect_refused({"hil", file_name, "--reset", "3@3000"}, {"tick 3000", "1 to 2999"});
  expect_refused({"hil", file_name, "--reset", "1@100"}, {"node 1, which produces the SYNC"});
  for (const char* word : {"603", "603#00", "3#00@5", "803#00@5", "603#0@5", "603#00@", "603#00112233445566778899@5",
                           "60G#00@5", "603#0G@5", "603@5#00"}) {
    expect_refused({"hil", file_name, "--send", word}, {"--send", "ID#DATA@TICK"});
  }
  expect_refused({"hil", file_name, "--send", "603#00@3000"}, {"tick 3000"});
  expect_refused({"hil", file_name, "--can-log", "/nowhere/bus.log"}, {"/nowhere/bus.log"});
  expect_refused({"hil", file_name, "--can-log", file_name}, {"found another file"});
  expect_refused({"hil", file_name, "--can-log", file("x").string(), "--record", file("x").string()}, {"found twice"});
  for (const char* command : {"simulate", "hil"}) {
    expect_refused({command, file_name, "--losses", "7:500%"}, {"rate '500'", "0 to 1"});
    expect_refused({command, file_name, "--losses", "7:5%@5000-6000"}, {"tick 5000", "0 to 2999"});
    expect_refused({command, file_name, "--losses", "/dev/zero"}, {"/dev/zero: found no file"});
    expect_refused({command, file_name, "--losses", "/"}, {"/: found no file"});
    expect_refused({command, file_name, "--losses", file("none").string()}, {"none': found no such file"});
  }
  EXPECT_TRUE(left_behind().empty());
}

class Replay : public Hil {};

TEST_F(Replay, HoldsOnARecordingOfSimulate) {
  (void)succeed({"simulate", scenario("coupled"), "--seconds", "2", "--record", file("run.proleg").string()});
  const json replayed = succeed({"replay", file("run.proleg").string(), "--verify"});
  EXPECT_EQ(replayed["ticks"], 200);
  EXPECT_EQ(replayed["setpoints"], 1000);
  EXPECT_EQ(replayed["servo_commands"], 10000);
  EXPECT_EQ(replayed["core_fingerprint"], replayed["recorded_core_fingerprint"]);
  EXPECT_EQ(proleg({"replay", file("run.proleg").string(), "--verify"}).status, 0);
}

TEST_F(Replay, RefusesWhatIsNoRecordingOrNoTask) {
  expect_refused({"replay", file("none").string(), "--verify"}, {"no file"});
  expect_refused({"replay", scenario("uniform"), "--verify"}, {"not a database"});
  expect_refused({"replay", scenario("uniform")}, {"--verify"});
}

}  // namespace
}  // namespace proleg::test
