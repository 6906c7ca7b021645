// proleg hil, proleg replay and --losses as a user runs them.

#include "command_line.hpp"
#include "json_result.hpp"
#include "shared/computer/sqlite/sqlite.hpp"

namespace proleg::test {
namespace {

class Hil : public CommandLine {
 protected:
  [[nodiscard]] Json succeed(std::vector<std::string> words) const {
    words.emplace_back("--json");
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return Json(finished.out);
  }
};

TEST_F(Hil, GivesTheSameHashesAsSimulate) {
  const Json simulated = succeed({"simulate", scenario("coupled"), "--seconds", "3"});
  const Json modules = succeed({"hil", scenario("coupled"), "--modules", "native", "--seconds", "3"});
  EXPECT_EQ(modules["modules"], 5);
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
  EXPECT_EQ(modules["servo_hash"], simulated["servo_hash"]);
  EXPECT_EQ(modules["displacement_m"], simulated["displacement_m"]);
  EXPECT_GT(modules["real_time_factor"], 0.0);
  EXPECT_NEAR(modules["bus_load"].number(), 0.073, 0.007);
  EXPECT_NEAR(modules["frames"].number(), 300 * 7.2, 40)
      << "5 state frames and SYNC a tick, monitoring, TICK and heartbeats";
}

TEST_F(Hil, LosesTheFramesThatSimulateLoses) {
  const Json clean = succeed({"simulate", scenario("coupled"), "--seconds", "2"});
  const Json simulated = succeed({"simulate", scenario("coupled"), "--seconds", "2", "--losses", "7:5%"});
  const Json modules = succeed({"hil", scenario("coupled"), "--seconds", "2", "--losses", "7:0.05"});
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_EQ(modules["lost_frames"], simulated["lost_frames"]);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
  EXPECT_NE(modules["setpoint_hash"], clean["setpoint_hash"]);
}

TEST_F(Hil, CountsALostFrameOnceForEachJointThatIsToReceiveIt) {
  // In each of 200 ticks 4 joints are to receive the frames of 5 senders; before the first tick nothing was sent.
  constexpr double receptions = 200.0 * 5 * 4;
  for (const char* subcommand : {"simulate", "hil"}) {
    const std::vector<std::string> words{subcommand, scenario("coupled"), "--seconds", "2", "--losses", "7:50%"};
    const Json result = succeed(words);
    EXPECT_NEAR(result["frame_receptions"].number(), receptions, 20);
    EXPECT_NEAR(result["lost_frames"].number(), receptions / 2, 150);
    const std::string text = proleg(words).out;
    EXPECT_NE(text.find(" %); a frame counts once for each joint that is to receive it"), std::string::npos) << text;
  }
}

TEST_F(Hil, AResetNamesANodeOrAJoint) {
  const std::vector<std::string> words{"hil", scenario("coupled"), "--seconds", "1.5", "--reset"};
  const auto reset = [&](const char* word) {
    std::vector<std::string> all = words;
    all.emplace_back(word);
    return succeed(all);
  };
  const Json by_name = reset("J4@100");
  EXPECT_EQ(by_name["restarts"][0]["node"], 2) << "node 1 is at the head, J5";
  EXPECT_EQ(by_name["setpoint_hash"], reset("2@100")["setpoint_hash"]);
}

TEST_F(Hil, PlaysFaultsFromAFileAndRecordsThem) {
  std::ofstream(file("faults.txt")) << "at 1.5s host-dies  # for ever\nat 1s unplug J4 for 30ms\n";
  const std::string recording = file("faults.proleg").string();
  const Json run = succeed(
      {"hil", scenario("uniform"), "--seconds", "4", "--faults", file("faults.txt").string(), "--record", recording});
  EXPECT_EQ(run["differences"], 0);
  EXPECT_EQ(run["faults"]["schedule"][0], "at 1s unplug J4 for 30ms") << "by ascending time";
  EXPECT_EQ(run["faults"]["violations"].size(), 0U);
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(run["faults"]["joints_ended"][joint], "hold");
  }
  const Json replayed = succeed({"replay", recording});
  EXPECT_EQ(replayed["first_fault_tick"], 100);
  EXPECT_EQ(replayed["ticks"], 100);
  EXPECT_EQ(proleg({"faults", "--recording", recording}).out, "at 1s unplug J4 for 30ms\nat 1.5s host-dies\n");
  const std::string picture = file("faults.svg").string();
  EXPECT_EQ(proleg({"plot", recording, "--from", "0", "--to", "2", "--out", picture}).status, 0);
  EXPECT_NE(read_file(picture).find("unplug J4 for 30ms"), std::string::npos);
}

TEST_F(Hil, TheScheduleOfASeedIsTheOneThatIsPrinted) {
  const std::vector<std::string> run{"hil", scenario("uniform"), "--seconds", "4", "--faults"};
  const auto with = [&](const std::string& word) {
    std::vector<std::string> all = run;
    all.push_back(word);
    return succeed(all);
  };
  const std::string schedule = proleg({"faults", scenario("uniform"), "--schedule", "11", "--seconds", "4"}).out;
  std::ofstream(file("printed.txt")) << schedule;
  EXPECT_EQ(with("11")["setpoint_hash"], with(file("printed.txt").string())["setpoint_hash"]) << schedule;
}

TEST_F(Hil, RunsACampaignOfRandomFaults) {
  const Json campaign = succeed({"hil", scenario("uniform"), "--seconds", "3", "--faults", "1:5"});
  EXPECT_EQ(campaign["runs"], 5);
  EXPECT_EQ(campaign["broken_runs"], 0);
  EXPECT_EQ(campaign["joints_ended"]["unsafe"], 0);
}

TEST_F(Hil, HashesOfCommandsAreNotTakenForThoseOfAWorld) {
  const std::string none =
      "world hash        none: the two above are of commands, and may be the same on another floor";
  for (const char* program : {"simulate", "hil"}) {
    EXPECT_NE(proleg({program, scenario("uniform"), "--seconds", "1"}).out.find(none), std::string::npos) << program;
    EXPECT_EQ(proleg({program, scenario("uniform"), "--seconds", "1", "--engine", "reduced"}).out.find(none),
              std::string::npos)
        << program;
  }
}

TEST_F(Hil, WarnsOfAFaultThatNativeModulesCannotPlay) {
  std::ofstream(file("chip.txt")) << "at 1s crystal J4 for 100ms\nat 1s unplug J2 for 30ms\n";
  const Finished run = proleg({"hil", scenario("uniform"), "--seconds", "4", "--faults", file("chip.txt").string()});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("found 'at 1s crystal J4 for 100ms', which a native module cannot play; it has no effect "
                         "without --modules mcu"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("unplug"), std::string::npos) << run.err;
}

TEST_F(Hil, FaultsThatDoNotExistAreRefused) {
  const std::string scenario_file = scenario("uniform");
  std::ofstream(file("wrong.txt")) << "at 1s unplug J7 for 1s\n";
  std::ofstream(file("empty.txt")) << "# nothing\n";
  expect_refused({"hil", scenario_file, "--faults", file("wrong.txt").string()}, {"wrong.txt:1: found the joint 'J7'"});
  expect_refused({"hil", scenario_file, "--faults", file("empty.txt").string()}, {"found no fault"});
  expect_refused({"hil", scenario_file, "--faults", "none.txt"}, {"no such file"});
  expect_refused({"hil", scenario_file, "--faults", "1:0"}, {"'1:0'", "SEED:COUNT"});
  expect_refused({"hil", scenario_file, "--seconds", "1", "--faults", "1"}, {"a run of 1s, expected at least 2.5s"});
  expect_refused({"faults", scenario_file, "--schedule", "x"}, {"'x'"});
  expect_refused({"faults", "--schedule", "1"}, {"no scenario"});
  expect_refused({"faults", "none.txt"}, {"'none.txt' without --schedule"});
  const std::string kept = file("kept").string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--record", kept}, {"--can-log", kept}, {"--trace", "3=" + kept}}) {
    std::vector<std::string> command{"hil", scenario_file, "--faults", "1:2", "--modules", "3=mcu"};
    command.insert(command.end(), words.begin(), words.end());
    expect_refused(command, {words[0], "SEED:COUNT"});
  }
}

TEST_F(Hil, ReadsLossesFromAFile) {
  std::ofstream(file("losses.txt")) << "30 J5 J4\n31 J5 *\n";
  const std::vector<std::string> losses{"--losses", file("losses.txt").string()};
  std::vector<std::string> simulate{"simulate", scenario("coupled"), "--seconds", "1"};
  std::vector<std::string> hil{"hil", scenario("coupled"), "--seconds", "1"};
  simulate.insert(simulate.end(), losses.begin(), losses.end());
  hil.insert(hil.end(), losses.begin(), losses.end());
  const Json simulated = succeed(simulate);
  const Json modules = succeed(hil);
  EXPECT_EQ(simulated["lost_frames"], 5);
  EXPECT_EQ(modules["setpoint_hash"], simulated["setpoint_hash"]);
}

TEST_F(Hil, AModuleThatIsResetJoinsAgainAndTheRecordingContainsIt) {
  const Json modules = succeed({"hil", scenario("coupled"), "--seconds", "3", "--reset", "3@100", "--set",
                                "amplitude=30@105", "--losses", "3:1%", "--record", file("run.proleg").string()});
  EXPECT_EQ(modules["differences"], 0);
  ASSERT_EQ(modules["restarts"].size(), 1U);
  EXPECT_EQ(modules["restarts"][0]["node"], 3);
  EXPECT_EQ(modules["restarts"][0]["tick"], 100);
  EXPECT_GT(modules["restarts"][0]["joined_tick"], 100);
  const Json replayed = succeed({"replay", file("run.proleg").string(), "--verify"});
  EXPECT_EQ(replayed["differences"], 0);
  EXPECT_EQ(replayed["setpoint_hash"], modules["setpoint_hash"]);
  EXPECT_EQ(replayed["servo_hash"], modules["servo_hash"]);
  EXPECT_EQ(replayed["recorded_by"], "hil native");
}

TEST_F(Hil, ChangesThatTheMasterCannotTransferInTimeFailTheRunAndAreNotRecorded) {
  const std::string recording = file("run.proleg").string();
  std::vector<std::string> words{"hil", scenario("coupled"), "--seconds", "1", "--json", "--record", recording};
  for (int tick = 0; tick < 60; ++tick) {
    for (const char* name :
         {"amplitude=2", "phase_difference=5", "frequency=0.5", "offset=1", "coupling=1", "rate=1"}) {
      words.insert(words.end(), {"--set", name + std::to_string(tick % 10) + "@" + std::to_string(tick)});
    }
  }
  const Finished finished = proleg(words);
  EXPECT_EQ(finished.status, 1);
  const Json result(finished.out);
  EXPECT_GT(result["dropped_changes"].size(), 5U);
  EXPECT_EQ(result["differences"], 0);
  EXPECT_NE(finished.err.find(" changes did not take effect, those for the ticks "), std::string::npos) << finished.err;
  EXPECT_EQ(succeed({"replay", recording, "--verify"})["differences"], 0);
}

TEST_F(Hil, WritesALogOfTheBus) {
  (void)succeed({"hil", scenario("uniform"), "--seconds", "1", "--can-log", file("bus.log").string()});
  const std::string log = read_file(file("bus.log"));
  EXPECT_EQ(log.find("(0000000000.000056) can0 77F#05\n"), 0U)
      << "the host sends the first frame: " << log.substr(0, 40);
  EXPECT_NE(log.find(" can0 000#0100\n"), std::string::npos) << "NMT start to all";
  EXPECT_NE(log.find(" can0 080#01\n"), std::string::npos) << "SYNC 0";
}

TEST_F(Hil, SendsAFrameAndLogsTheAnswer) {
  const Json modules = succeed({"hil", scenario("uniform"), "--seconds", "1", "--send", "603#4034120000000000@50",
                                "--can-log", file("bus.log").string()});
  EXPECT_EQ(modules["differences"], 0);
  EXPECT_NE(read_file(file("bus.log")).find(" can0 583#8034120000000206\n"), std::string::npos) << "no such object";
}

TEST_F(Hil, BadOptionsAreRefused) {
  const std::string file_name = scenario("uniform");
  expect_refused({"hil", file_name, "--modules", "mechanical"}, {"mechanical"});
  EXPECT_NE(proleg({"hil", "--help"}).out.find("a number is a node id (3@1000: node 3)"), std::string::npos);
  expect_refused({"hil", file_name, "--reset", "3"}, {"--reset", "'3'", "JOINT@TICK or NODE@TICK"});
  expect_refused({"hil", file_name, "--reset", "J5@100"}, {"node 1 (J5), which produces the SYNC"});
  expect_refused({"hil", file_name, "--reset", "J9@100"}, {"--reset", "'J9'", "J1, J2, J3, J4, J5"});
  expect_refused({"hil", file_name, "--reset", "@100"}, {"--reset", "JOINT@TICK or NODE@TICK"});
  expect_refused({"hil", file_name, "--reset", "9@100"}, {"node 9", "one of 1, 2, 3, 4, 5"});
  expect_refused({"hil", file_name, "--reset", "3@0"}, {"tick 0"});
  expect_refused({"hil", file_name, "--reset", "3@3000"}, {"tick 3000", "1 to 2999"});
  expect_refused({"hil", file_name, "--reset", "1@100"}, {"node 1 (J5), which produces the SYNC"});
  for (const char* word : {"603", "603#00", "3#00@5", "803#00@5", "603#0@5", "603#00@", "603#00112233445566778899@5",
                           "60G#00@5", "603#0G@5", "603@5#00"}) {
    expect_refused({"hil", file_name, "--send", word}, {"--send", "ID#DATA@TICK"});
  }
  expect_refused({"hil", file_name, "--send", "603#00@3000"}, {"tick 3000"});
  expect_refused({"hil", file_name, "--can-log", "/missing/bus.log"}, {"/missing/bus.log"});
  expect_refused({"hil", file_name, "--can-log", file_name}, {"found a file that is no CAN log"});
  expect_refused({"hil", file_name, "--can-log", file("x").string(), "--record", file("x").string()}, {"found twice"});
  for (const char* command : {"simulate", "hil"}) {
    expect_refused({command, file_name, "--losses", "7:500%"}, {"rate '500%'", "0 to 1"});
    expect_refused({command, file_name, "--losses", "7:5%@5000-6000"}, {"tick 5000", "0 to 2999"});
    expect_refused({command, file_name, "--losses", "/dev/zero"}, {"'/dev/zero': found a device, a pipe or a socket"});
    expect_refused({command, file_name, "--losses", "/"}, {"'/': found a folder"});
    expect_refused({command, file_name, "--losses", file("none").string()}, {"none': found no such file"});
  }
  std::ofstream(file("losses.txt")) << "# channel 2\n30 J5 J4 2\n";
  expect_refused({"simulate", file_name, "--losses", file("losses.txt").string()},
                 {"losses.txt:2: found a loss on channel 2 at tick 30"});
  std::filesystem::remove(file("losses.txt"));
  EXPECT_TRUE(left_behind().empty());
}

TEST_F(Hil, FramesDestroyedOnTheBusAreSentAgainAndChangeNothing) {
  const Json clean = succeed({"simulate", scenario("coupled"), "--seconds", "3"});
  const Json disturbed = succeed({"hil", scenario("coupled"), "--seconds", "3", "--bit-errors", "7:2%"});
  EXPECT_GT(disturbed["bit_errors"], 10);
  EXPECT_EQ(disturbed["setpoint_hash"], clean["setpoint_hash"]);
  EXPECT_EQ(disturbed["servo_hash"], clean["servo_hash"]);
  for (const char* word : {"7", "7:", "x:1%", "7:101%", "-1:1%"}) {
    expect_refused({"hil", scenario("coupled"), "--bit-errors", word}, {"--bit-errors", "SEED:RATE"});
  }
}

class VirtualModules : public Hil {
 protected:
  /// The part of a result that is the same in every run.
  [[nodiscard]] Json without_wall_clock(const Json& object) const { return object.without("real_time_factor"); }
};

TEST_F(VirtualModules, GiveTheSameHashesAsSimulate) {
  const Json simulated = succeed({"simulate", scenario("coupled"), "--seconds", "3"});
  for (const char* modules : {"mcu", "1,3=mcu"}) {
    const Json found = succeed({"hil", scenario("coupled"), "--modules", modules, "--seconds", "3"});
    EXPECT_EQ(found["differences"], 0);
    EXPECT_EQ(found["setpoint_hash"], simulated["setpoint_hash"]);
    EXPECT_EQ(found["servo_hash"], simulated["servo_hash"]);
    EXPECT_EQ(found["displacement_m"], simulated["displacement_m"]);
    EXPECT_GT(found["instructions_per_tick"], 100);
    EXPECT_LE(found["instructions_per_tick"], 20'000);
    EXPECT_TRUE(found["failures"].empty());
  }
}

TEST_F(VirtualModules, AreFlashedThroughTheirBootloaderFirst) {
  const Finished finished = proleg({"hil", scenario("uniform"), "--modules", "1,3=mcu", "--seconds", "0.1", "--json"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.err.find("proleg hil: flashed a chip through its bootloader, "), std::string::npos)
      << finished.err;
  EXPECT_NE(finished.err.find(" of its time; 2 modules start with its flash\n"), std::string::npos) << finished.err;
}

TEST_F(VirtualModules, AnImageWithoutABootloaderBesideItIsRefused) {
  const fs::path image = file("module.elf");
  fs::copy_file(source_path("/build/stm32f405/bin/proleg_stm32f405.elf"), image);
  const std::vector<std::string> words{"hil", scenario("uniform"), "--modules", "mcu", "--image", image.string()};
  expect_refused(words, {file("proleg_boot_stm32f405.elf").string(), "found no bootloader", "beside the image"});
  fs::copy_file(image, file("proleg_boot_stm32f405.elf"));
  expect_refused(words, {"found a program with bytes at 0x0802", "expected the bootloader"});
}

TEST_F(VirtualModules, ThatAreResetJoinAgainAtTheSameTickAsNativeOnes) {
  const std::vector<std::string> words{"hil", scenario("coupled"), "--seconds", "1.5", "--reset", "3@100"};
  std::vector<Json> results;
  for (const char* modules : {"native", "mcu"}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--modules", modules});
    results.push_back(succeed(all));
  }
  EXPECT_EQ(results[0]["restarts"][0]["joined_tick"], results[1]["restarts"][0]["joined_tick"]);
  EXPECT_EQ(results[0]["setpoint_hash"], results[1]["setpoint_hash"]);
  EXPECT_EQ(results[0]["servo_hash"], results[1]["servo_hash"]);
}

TEST_F(VirtualModules, TwoRunsPrintAndRecordTheSame) {
  std::vector<Json> results;
  for (const char* name : {"a", "b"}) {
    const std::string recording = file(std::string(name) + ".proleg").string();
    const std::string table = file(std::string(name) + ".tsv").string();
    const std::string log = file(std::string(name) + ".log").string();
    const Json result = succeed({"hil", scenario("coupled"), "--modules", "mcu", "--seconds", "2", "--losses", "7:5%",
                                 "--reset", "3@100", "--record", recording, "--can-log", log});
    results.push_back(without_wall_clock(result).without("recording").without("can_log"));
    EXPECT_EQ(proleg({"export", recording, "--tsv", "--out", table}).status, 0);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(read_file(file("a.tsv")), read_file(file("b.tsv")));
  EXPECT_EQ(read_file(file("a.log")), read_file(file("b.log")));
  EXPECT_EQ(proleg({"replay", file("a.proleg").string(), "--verify"}).status, 0);
}

TEST_F(VirtualModules, ShowTheirConsoleAndTheirInstructions) {
  const std::string table = file("trace.tsv").string();
  const Finished finished = proleg(
      {"hil", scenario("coupled"), "--modules", "3=mcu", "--seconds", "1", "--uart", "3", "--trace", "3=" + table});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.err.find("node 3: proleg module, node 3, board 1"), std::string::npos) << finished.err;
  const std::string text = read_file(file("trace.tsv"));
  EXPECT_EQ(text.substr(0, text.find('\n')), "node\ttick\tto_state_frame\twhole_tick");
  EXPECT_EQ(std::ranges::count(text, '\n'), 1 + 100) << "a title and one line for each tick";
}

TEST_F(VirtualModules, BadOptionsAreRefusedAndNoFileIsTouched) {
  const std::string name = scenario("uniform");
  const std::string kept = file("kept.txt").string();
  std::ofstream(kept) << "precious";
  const auto refused = [&](std::vector<std::string> words, const std::vector<std::string>& message) {
    words.insert(words.begin(), {"hil", name});
    expect_refused(words, message);
  };
  refused({"--modules", "9=mcu"}, {"--modules", "node '9'", "one of 1, 2, 3, 4, 5"});
  refused({"--modules", "1,,2=mcu"}, {"--modules", "node ''"});
  refused({"--modules", "=mcu"}, {"--modules"});
  refused({"--image", "x.elf"}, {"--image", "--modules mcu"});
  refused({"--uart", "3"}, {"node 3, which is native"});
  refused({"--modules", "mcu", "--uart", "33"}, {"node '33'"});
  refused({"--gdb", "3333"}, {"--gdb", "--modules mcu"});
  refused({"--modules", "mcu", "--gdb", "gdb"}, {"--gdb", "PORT or NODE:PORT"});
  refused({"--modules", "mcu", "--gdb", "0"}, {"--gdb", "PORT or NODE:PORT"});
  refused({"--modules", "2=mcu", "--gdb", "3:3333"}, {"node 3, which is native"});
  refused({"--modules", "mcu", "--trace", "9=" + kept}, {"node '9'"});
  refused({"--modules", "2=mcu", "--trace", "1=" + kept}, {"node 1, which is native"});
  const std::string trace = file("trace.tsv").string();
  refused({"--modules", "mcu", "--trace", "1=" + trace, "--trace", "2=" + trace}, {"trace.tsv", "twice"});
  refused({"--modules", "mcu", "--trace", "1=" + kept}, {"kept.txt", "a file that is no trace"});
  refused({"--modules", "mcu", "--trace", "1=" + trace, "--record", "/missing/x"}, {"/missing/x"});
  refused({"--modules", "mcu", "--trace", "1=/missing/x"}, {"/missing/x"});
  refused({"--modules", "mcu", "--trace", "1", "--trace", "1"}, {"node 1 twice"});
  for (const std::string image : {"/missing/x.elf", "/tmp", "/dev/zero", PROLEG_PROGRAM, name.c_str()}) {
    refused({"--modules", "mcu", "--image", image}, {image, "expected"});
  }
  EXPECT_EQ(read_file(file("kept.txt")), "precious");
  EXPECT_EQ(left_behind().size(), 1U);
}

class Replay : public Hil {};

TEST_F(Replay, FindsNoDifferenceInARecordingOfSimulate) {
  (void)succeed({"simulate", scenario("coupled"), "--seconds", "2", "--record", file("run.proleg").string()});
  const Json replayed = succeed({"replay", file("run.proleg").string(), "--verify"});
  EXPECT_EQ(replayed["ticks"], 200);
  EXPECT_EQ(replayed["setpoints"], 1000);
  EXPECT_EQ(replayed["servo_commands"], 10000);
  EXPECT_EQ(replayed["core_fingerprint"], replayed["recorded_core_fingerprint"]);
  EXPECT_EQ(proleg({"replay", file("run.proleg").string(), "--verify"}).status, 0);
}

TEST_F(Replay, ReportsResultsWhoseHashesAreNotThoseOfTheTables) {
  const std::string recording = file("run.proleg").string();
  (void)succeed({"simulate", scenario("coupled"), "--seconds", "1", "--record", recording});
  EXPECT_EQ(succeed({"replay", recording})["same_hashes"], Json("true"));
  Database(recording, SQLITE_OPEN_READWRITE).execute("UPDATE result SET value = 'abc' WHERE name = 'servo_hash'");
  const Finished finished = proleg({"replay", recording, "--json"});
  EXPECT_EQ(finished.status, 1);
  const Json result(finished.out);
  EXPECT_EQ(result["differences"], 0);
  EXPECT_EQ(result["same_hashes"], Json("false"));
  EXPECT_EQ(result["verified"], Json("false"));
  EXPECT_EQ(result["recorded_servo_hash"], "abc");
}

// A pose that another world would have: the commands are the recorded ones.
TEST_F(Replay, SaysWhereTheMotionDepartsAlthoughAllCommandsAreEqual) {
  const std::string recording = file("run.proleg").string();
  const Json simulated = succeed(
      {"simulate", scenario("coupled"), "--seconds", "2.5", "--move", "0.5,0,0.1,30@120", "--record", recording});
  const Json equal = succeed({"replay", recording});
  EXPECT_EQ(equal["differences"], 0);
  EXPECT_EQ(equal["motion"]["compared_ticks"], 250);
  EXPECT_EQ(equal["motion"]["table_hashes"], 3);
  EXPECT_EQ(equal["motion"]["hash"], simulated["motion_hash"]);
  EXPECT_EQ(equal["motion"]["recorded_hash"], simulated["motion_hash"]);
  Database(recording, SQLITE_OPEN_READWRITE).execute("UPDATE pose SET z_m = z_m + 1e-15 WHERE tick > 130 AND link = 3");
  const Finished finished = proleg({"replay", recording, "--json"});
  EXPECT_EQ(finished.status, 1);
  const Json result(finished.out);
  EXPECT_EQ(result["differences"], 119);
  EXPECT_EQ(result["command_differences"], 0);
  EXPECT_EQ(result["same_hashes"], Json("true"));
  EXPECT_EQ(result["motion"]["first_tick"], 131);
  EXPECT_NE(finished.err.find("the motion departs from that of this program: at tick 131 (1.32 s), link '"),
            std::string::npos)
      << finished.err;
  EXPECT_EQ(finished.err.find("the recording was made"), std::string::npos) << finished.err;
  EXPECT_EQ(succeed({"replay", recording, "--commands"})["differences"], 0);
  Database(recording, SQLITE_OPEN_READWRITE).execute("UPDATE run SET value = 'z80' WHERE key = 'processor'");
  EXPECT_NE(proleg({"replay", recording}).err.find("the recording was made on z80, this computer is "),
            std::string::npos);
}

TEST_F(Replay, ChecksTheHashesOfTheMotion) {
  const std::string recording = file("run.proleg").string();
  (void)succeed({"simulate", scenario("coupled"), "--seconds", "0.5", "--record", recording});
  EXPECT_EQ(succeed({"replay", recording})["motion"]["table_hashes"], 1) << "a run shorter than a second";
  for (const char* damage : {"UPDATE motion_hash SET hash = 'abc'", "UPDATE motion_hash SET tick = 4000"}) {
    Database(recording, SQLITE_OPEN_READWRITE).execute(damage);
    const Finished finished = proleg({"replay", recording, "--json"});
    EXPECT_EQ(finished.status, 1) << damage;
    EXPECT_EQ(Json(finished.out)["differences"], 0) << damage;
    EXPECT_NE(finished.err.find("expected an undamaged table 'motion_hash'"), std::string::npos) << finished.err;
  }
  Database(recording, SQLITE_OPEN_READWRITE).execute("DROP TABLE motion_hash; DELETE FROM run WHERE key = 'processor'");
  const Json old = succeed({"replay", recording});
  EXPECT_EQ(old["motion"]["table_hashes"], 0);
  EXPECT_EQ(old["motion"]["compared_ticks"], 50);
}

TEST_F(Replay, TheWorldOfModulesIsComparedUntilOneRestarts) {
  const std::string recording = file("run.proleg").string();
  const Json run = succeed({"hil", scenario("coupled"), "--seconds", "2", "--reset", "3@100", "--record", recording});
  const Json whole = succeed({"hil", scenario("coupled"), "--seconds", "2", "--record", file("whole.proleg").string()});
  const Json replayed = succeed({"replay", recording});
  EXPECT_EQ(replayed["motion"]["compared_ticks"], 100);
  EXPECT_EQ(replayed["motion"]["not_compared"], "a module restarted at tick 100");
  EXPECT_EQ(succeed({"replay", file("whole.proleg").string()})["motion"]["hash"], whole["motion_hash"]);
  EXPECT_EQ(whole["motion_hash"], succeed({"simulate", scenario("coupled"), "--seconds", "2"})["motion_hash"]);
}

TEST_F(Replay, RefusesAFileThatIsNoRecording) {
  expect_refused({"replay", file("none").string(), "--verify"}, {"no such file"});
  expect_refused({"replay", scenario("uniform"), "--verify"}, {"not a database"});
  expect_refused({"replay", scenario("uniform")}, {"not a database"});
}

}  // namespace
}  // namespace proleg::test
