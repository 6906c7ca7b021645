// proleg sweep as a user runs it.

#include <csignal>
#include <thread>

#include "command_line.hpp"
#include "json_result.hpp"

namespace proleg::test {
namespace {

/// The cells of a table of tab-separated values, without its comment.
std::vector<std::vector<std::string>> cells(const std::string& table) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream stream(table);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("# ")) {
      continue;
    }
    std::istringstream line_stream(line);
    lines.emplace_back();
    for (std::string cell; std::getline(line_stream, cell, '\t');) {
      lines.back().push_back(cell);
    }
  }
  return lines;
}

TEST_F(CommandLine, ARunOfASweepIsThatOfSimulateWithTheSameValues) {
  const std::string out = file("out").string();
  const Finished finished =
      proleg({"sweep", scenario("coupled"), "--over", "amplitude=20:40:20", "--over", "seed=1:3", "--over",
              "friction=0.1:0.2:0.1", "--seconds", "1", "--set", "frequency=1.5", "--workers", "2", "--out", out});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const auto table = cells(read_file(out + "/sweep.tsv"));
  ASSERT_EQ(table.size(), 13U);
  EXPECT_EQ(table[0][0], "amplitude (deg)");
  EXPECT_EQ(table[0][3], "distance (m)");
  ASSERT_EQ(std::vector(table[8].begin(), table[8].begin() + 3), (std::vector<std::string>{"40", "1", "0.2"}));
  const Json single(proleg({"simulate", scenario("coupled"), "--seconds", "1", "--set", "frequency=1.5", "--set",
                            "amplitude=40", "--seed", "1", "--friction", "0.2", "--json"})
                        .out);
  EXPECT_EQ(std::stod(table[8][3]), single["measures"]["distance"].number());
  EXPECT_EQ(cells(read_file(out + "/summary.tsv")).size(), 5U) << "four combinations without the seed";
  EXPECT_NE(read_file(out + "/sweep.svg").find("<svg"), std::string::npos);
}

TEST_F(CommandLine, ASweepDoesNotDependOnTheNumberOfWorkers) {
  const std::string long_chain = source_path("/sim/scenarios/long_chain/twenty.simulation.xml");  // iterative solver
  std::vector<std::string> tables;
  for (const char* workers : {"1", "3"}) {
    const std::string out = file(workers).string();
    EXPECT_EQ(
        proleg({"sweep", long_chain, "--over", "seed=1:5", "--seconds", "0.5", "--workers", workers, "--out", out})
            .status,
        0);
    tables.push_back(read_file(out + "/sweep.tsv"));
  }
  EXPECT_EQ(cells(tables[0]).size(), 6U);
  EXPECT_EQ(tables[0], tables[1]);
}

TEST_F(CommandLine, ASweepPrintsMeanAndStandardDeviationAsJson) {
  const Finished finished = proleg({"sweep", scenario("coupled"), "--over", "amplitude=20:40:20", "--over", "seed=1:3",
                                    "--seconds", "1", "--measure", "speed", "--json", "--out", file("out").string()});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json object(finished.out);
  EXPECT_EQ(object["measure"], "speed");
  EXPECT_EQ(object["runs"], 6);
  ASSERT_EQ(object["groups"].size(), 2U);
  EXPECT_EQ(object["groups"][1]["at"]["amplitude"], 40);
  EXPECT_EQ(object["groups"][1]["values"], 3);
  EXPECT_GT(object["groups"][1]["standard_deviation"].number(), 0.0);
}

TEST_F(CommandLine, SeedsThatChangeNothingCauseAWarning) {
  const Finished finished =
      proleg({"sweep", scenario("uniform"), "--over", "seed=1:2", "--seconds", "0.1", "--out", file("out").string()});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.err.find("all seeds give the same run"), std::string::npos) << finished.err;
}

TEST_F(CommandLine, TablesAndPictureOfASweepStateWhatHoldsForAllRuns) {
  const std::string out = file("out").string();
  const Finished finished =
      proleg({"sweep", scenario("coupled"), "--over", "amplitude=20:40:20", "--seconds", "0.1", "--set",
              "frequency=1.5", "--friction", "0.2", "--at", "1,2", "--heading", "30", "--seed", "4", "--out", out});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const std::string options = "--set frequency=1.5 --seconds 0.1 --seed 4 --friction 0.2 --at 1,2 --heading 30";
  for (const char* name : {"/sweep.tsv", "/summary.tsv"}) {
    EXPECT_TRUE(
        read_file(out + name)
            .starts_with("# proleg sweep " + scenario("coupled") + " --over amplitude=20:40:20 " + options + "\n"))
        << name;
  }
  const std::string picture = read_file(out + "/sweep.svg");
  EXPECT_NE(picture.find(options), std::string::npos);
  EXPECT_NE(picture.find("coupled.simulation.xml"), std::string::npos);
}

TEST_F(CommandLine, ASweepWarnsOfRunsWhoseServosCannotFollow) {
  const Finished finished = proleg({"sweep", scenario("uniform"), "--over", "frequency=1:3", "--seconds", "2.5",
                                    "--json", "--out", file("out").string()});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(Json(finished.out)["servos_cannot_follow"], 2);
  // 40 degrees at 3 Hz need 13 rad/s, the servos have 4.5.
  EXPECT_EQ(finished.err.find(
                "proleg sweep: warning: the servos cannot follow the gait in 2 of 3 runs; worst at frequency 3: "),
            0U)
      << finished.err;
  EXPECT_EQ(std::ranges::count(finished.err, '\n'), 1) << finished.err;
  const Finished simulated = proleg({"simulate", scenario("uniform"), "--set", "frequency=1", "--seconds", "2.5"});
  EXPECT_EQ(simulated.err.find("cannot follow"), std::string::npos) << simulated.err;
}

class SweepOnASlope : public CommandLine {
 protected:
  /// A flat floor of 16 m on which gravity pulls the robot along its body: with little friction it slides off.
  void SetUp() override {
    CommandLine::SetUp();
    const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
    std::string environment = read_file(shipped + "flat.environment.xml");
    const auto replace = [&](const std::string& from, const std::string& to) {
      ASSERT_NE(environment.find(from), std::string::npos) << from;
      environment.replace(environment.find(from), from.size(), to);
    };
    replace("<gravity>0 0 ", "<gravity>0 40 ");
    replace("<extents>1000 1000 ", "<extents>8 8 ");
    std::ofstream(file("slope.environment.xml")) << environment;
    std::ofstream(file("slope.simulation.xml"))
        << "<simulation><robot>" + shipped + "caterpillar.robot.xml</robot><actuation>" + shipped +
               "uniform.actuation.xml</actuation><environment>slope.environment.xml</environment>"
               "<simulationProperties><duration>1.5</duration></simulationProperties></simulation>";
  }

  [[nodiscard]] Finished sweep(const std::string& over, std::vector<std::string> rest = {}) const {
    rest.insert(rest.begin(), {"sweep", file("slope.simulation.xml").string(), "--over", over, "--set", "amplitude=0",
                               "--out", file("out").string()});
    return proleg(rest);
  }
};

TEST_F(SweepOnASlope, RunsThatFailAreCountedAndAreGaps) {
  const Finished finished = sweep("friction=0:20:10");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("3 of 3, 1 of them failed"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("the first at friction 0: tick "), std::string::npos) << finished.out;
  EXPECT_NE(read_file(file("out/sweep.svg")).find("class=\"gaps\""), std::string::npos);
}

TEST_F(SweepOnASlope, IfAllRunsFailOneLineNamesTheFirstFailure) {
  for (const std::vector<std::string>& rest : {std::vector<std::string>{}, {"--json"}}) {
    const Finished finished = sweep("friction=0:0.2:0.1", rest);
    EXPECT_EQ(finished.status, 1);
    EXPECT_EQ(finished.out, "");
    EXPECT_NE(finished.err.find("\nproleg sweep: all 3 runs failed; the first at friction 0: tick "), std::string::npos)
        << finished.err;
    EXPECT_EQ(std::ranges::count(finished.err, '\n'), 2) << "besides it the warning on gravity: " << finished.err;
    EXPECT_TRUE(fs::exists(file("out/sweep.tsv"))) << "the failures can be looked at";
    EXPECT_FALSE(fs::exists(file("out/sweep.svg")));
    fs::remove_all(file("out"));
  }
}

TEST_F(CommandLine, ASweepOverAMeasureThatNoRunDefinesFails) {
  // A fifth of a second has no stride.
  const Finished finished = proleg({"sweep", scenario("uniform"), "--over", "friction=0.1:0.3:0.1", "--seconds", "0.2",
                                    "--measure", "stride_length", "--out", file("out").string()});
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(finished.err, "proleg sweep: none of 3 runs defines stride_length\n");
  EXPECT_FALSE(fs::exists(file("out/sweep.svg")));
}

/// Waits until the condition holds, or the sweep has ended.
template <typename Condition>
void wait_until(pid_t sweep, const Condition& condition) {
  while (!condition() && waitpid(sweep, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Waits until a sweep has its folder, from when on an interruption ends it, or has ended without.
void wait_for_folder(pid_t sweep, const fs::path& folder) {
  wait_until(sweep, [&] { return fs::exists(folder); });
}

TEST_F(CommandLine, AnInterruptedSweepLeavesATableOfWhatIsDoneOrNothing) {
  const std::string out = file("out").string();
  const pid_t child = start({PROLEG_PROGRAM, "sweep", scenario("coupled"), "--over", "seed=1:100000", "--seconds",
                             "0.05", "--workers", "1", "--out", out});
  wait_for_folder(child, out);
  kill(child, SIGINT);
  const Finished finished = finish(child);
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("interrupted "), std::string::npos) << finished.err;
  if (fs::exists(out)) {
    const auto table = cells(read_file(out + "/sweep.tsv"));
    EXPECT_GE(table.size(), 2U);
    EXPECT_LT(table.size(), 100'001U);
  }
}

TEST_F(CommandLine, ASweepThatWasKilledGoesOnAndHasTheTablesOfOneThatWasNot) {
  const std::vector<std::string> command{"sweep", scenario("coupled"), "--over", "seed=1:400", "--seconds",
                                         "0.2",   "--workers",         "1"};
  const auto with = [&](const char* option, const fs::path& folder) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {option, folder.string()});
    return words;
  };
  ASSERT_EQ(proleg(with("--out", file("whole"))).status, 0);

  const fs::path table = file("killed/sweep.tsv");
  const auto kill_after_some_runs = [&](std::vector<std::string> words) {
    words.insert(words.begin(), PROLEG_PROGRAM);
    const pid_t child = start(words);
    wait_until(child, [&] { return fs::exists(table) && cells(read_file(table)).size() >= 4; });
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);  // on a busy computer it may have ended: then there is less to go on with
  };
  kill_after_some_runs(with("--out", file("killed")));
  // As if it had been killed in its first line.
  const std::string written = read_file(table);
  std::ofstream(table) << written.substr(0, written.find("\n1\t") + 1) << "1\t0.";
  kill_after_some_runs(with("--resume", file("killed")));
  std::ofstream(table, std::ios::app) << "17\t0.";  // a line that was being written

  const auto repeated = proleg(with("--out", file("killed")));
  EXPECT_EQ(repeated.status, 2);
  EXPECT_NE(repeated.err.find("--resume " + file("killed").string()), std::string::npos) << repeated.err;
  std::vector<std::string> other = with("--resume", file("killed"));
  other[3] = "seed=1:401";
  EXPECT_EQ(proleg(other).status, 2);

  const auto resumed = proleg(with("--resume", file("killed")));
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_NE(resumed.out.find(" runs were there already"), std::string::npos) << resumed.out;
  for (const char* name : {"sweep.tsv", "summary.tsv"}) {
    EXPECT_EQ(read_file(file("killed") / name), read_file(file("whole") / name)) << name;
  }
  EXPECT_NE(proleg(with("--resume", file("nothing"))).err.find("there is nothing to resume"), std::string::npos);
}

TEST_F(CommandLine, ASweepThatIsInterruptedBeforeItsFirstRunEndsLeavesNothing) {
  const std::string out = file("out").string();
  const pid_t child =
      start({PROLEG_PROGRAM, "sweep", scenario("coupled"), "--over", "seed=1:2", "--seconds", "3600", "--out", out});
  wait_for_folder(child, out);
  kill(child, SIGINT);
  const Finished finished = finish(child);
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("interrupted before the first run of 2 ended; nothing was written"), std::string::npos)
      << finished.err;
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(CommandLine, TwoSweepsAtOnceDoNotWriteIntoOneFolder) {
  const std::string out = file("out").string();
  const pid_t first = start({PROLEG_PROGRAM, "sweep", scenario("coupled"), "--over", "seed=1:100000", "--seconds",
                             "0.05", "--workers", "1", "--out", out});
  wait_for_folder(first, out);
  const auto second = proleg({"sweep", scenario("coupled"), "--over", "seed=1:2", "--seconds", "0.05", "--out", out});
  EXPECT_EQ(second.status, 2);
  EXPECT_NE(second.err.find(out + ": found a folder into which another program writes its results"), std::string::npos)
      << second.err;
  kill(first, SIGINT);
  EXPECT_EQ(finish(first).status, 1);
}

TEST_F(CommandLine, SweepRefusesBadInputAndWritesNothing) {
  const auto refused = [&](std::vector<std::string> words, const std::vector<std::string>& message) {
    words.insert(words.begin(), {"sweep", scenario("uniform"), "--out", file("out").string()});
    expect_refused(words, message);
    EXPECT_TRUE(left_behind().empty());
  };
  refused({}, {"--over"});
  refused({"--over", "amplitude"}, {"--over amplitude", "NAME=FIRST:LAST:STEP"});
  refused({"--over", "amplitude=80:100:20"}, {"amplitude=100"});
  refused({"--over", "seed=1:100001"}, {"at most 100000 runs"});
  refused({"--over", "seed=1:2", "--measure", "fun"}, {"--measure", "distance"});
  refused({"--over", "seed=1:2", "--seed", "3"}, {"--over seed=1:2", "--seed 3"});
  refused({"--over", "friction=0:1", "--friction", "0.3"}, {"--over friction=0:1", "--friction 0.3"});
  refused({"--over", "amplitude=1:2", "--set", "1.amplitude=3"}, {"--over amplitude=1:2", "--set 1.amplitude=3"});
  refused({"--over", "seed=1:2", "--workers", "0"}, {"--workers", "1 to 1024"});
  fs::create_directories(file("done"));
  std::ofstream(file("done/sweep.tsv")) << "precious\n";
  expect_refused({"sweep", scenario("uniform"), "--over", "seed=1:2", "--out", file("done").string()},
                 {"sweep.tsv", "--out"});
}

}  // namespace
}  // namespace proleg::test
