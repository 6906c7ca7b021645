// The programs as a user runs them.

#include <csignal>
#include <map>

#include "command_line.hpp"
#include "json_result.hpp"
#include "sim/record/recording.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {
namespace {

TEST_F(CommandLine, HelpListsTheSubcommands) {
  for (const char* word : {"--help", "-h", "help"}) {
    const Finished finished = proleg({word});
    EXPECT_EQ(finished.status, 0);
    for (const char* name : {"algorithms", "new", "simulate", "sweep", "hil", "faults", "replay", "receipt", "export",
                             "plot", "optimise", "atlas", "confirm", "experiment", "objects"}) {
      EXPECT_NE(finished.out.find(name), std::string::npos);
    }
  }
  for (const char* name : {"algorithms", "new", "simulate", "sweep", "hil", "faults", "replay", "receipt", "export",
                           "plot", "optimise", "atlas", "confirm", "experiment", "objects"}) {
    const Finished finished = proleg({name, "--help"});
    EXPECT_EQ(finished.status, 0);
    EXPECT_NE(finished.out.find(std::string("Usage: proleg ") + name), std::string::npos) << finished.out;
  }
}

TEST_F(CommandLine, WithoutASubcommandTheHelpGoesToStandardError) {
  const Finished finished = proleg({});
  EXPECT_EQ(finished.status, 2);
  EXPECT_EQ(finished.out, "");
  EXPECT_EQ(finished.err, proleg({"--help"}).out);
}

TEST_F(CommandLine, AMissingProgramSaysHowItIsBuiltOrInstalled) {
  const fs::path folder = file("bin");
  fs::create_directory(folder);
  fs::copy(PROLEG_PROGRAM, folder / "proleg");
  const auto start_it = [&] { return finish(start({(folder / "proleg").string(), "optimise", "--help"})); };
  Finished finished = start_it();
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("bin/proleg-optimise: it is not there; install all programs of Proleg"),
            std::string::npos)
      << finished.err;
  std::ofstream(file("CMakeCache.txt")).flush();
  finished = start_it();
  EXPECT_NE(
      finished.err.find("build it: cmake --build " + file("").parent_path().string() + " --target proleg-optimise\n"),
      std::string::npos)
      << finished.err;
}

TEST_F(CommandLine, VersionNamesTheBuild) {
  const Finished finished = proleg({"--version"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out.rfind("proleg " PROLEG_VERSION "-", 0), 0U) << finished.out;
}

TEST_F(CommandLine, RefusesUnknownWords) {
  expect_refused({"simulat"}, {"'simulat'", "; did you mean 'proleg simulate'?\n"});
  expect_refused({"optimize"}, {"did you mean 'proleg optimise'?"});
  expect_refused({"zzz"}, {"'zzz'", "expected one that 'proleg --help' lists\n"});
  expect_refused({"../../bin/sh"}, {"expected one that"});
  expect_refused({"simulate\n\x1b[31m"}, {"'simulate  [31m'", "expected one that"});
  expect_refused({"simulate"}, {"found no FILE"});
  expect_refused({"simulate", scenario("uniform"), "--fast"}, {"unknown '--fast'", "'proleg simulate --help' lists\n"});
  expect_refused({"simulate", scenario("uniform"), "--second", "3"},
                 {"unknown '--second'", "; did you mean --seconds?"});
  expect_refused({"hil", scenario("uniform"), "--reste=3@10"}, {"; did you mean --reset?"});
  expect_refused({"plot", "--form", "1", "run"}, {"; did you mean --from?"});
  expect_refused({"simulate", scenario("uniform"), "--seconds"}, {"--seconds"});
  expect_refused({"export", "run", "--tsv", "--binary"}, {"--binary"});
  expect_refused({"plot"}, {"RUN"});
  expect_refused({"plot", "run", "--from", "abc"}, {"found --from 'abc', expected a number"});
  expect_refused({"plot", "run", "--from", "1", "--from", "2"}, {"found --from 2 times, expected it at most once"});
  expect_refused({"plot", "run", "--out"}, {"found no value of --out, expected"});
}

TEST_F(CommandLine, RefusesBadInputAndWritesNothing) {
  const std::string recording = file("run.proleg").string();
  const auto simulate = [&](const std::vector<std::string>& rest, const std::vector<std::string>& message) {
    std::vector<std::string> words{"simulate", "--record", recording};
    words.insert(words.end(), rest.begin(), rest.end());
    expect_refused(words, message);
    EXPECT_TRUE(left_behind().empty());
  };
  simulate({"/missing/x.simulation.xml"}, {"/missing/x.simulation.xml", "expected"});
  simulate({source_path("/docs")}, {"found a folder, expected a *.simulation.xml file; there is none in the folder"});
  simulate({source_path("/sim/scenarios/obstacle")},
           {"found a folder, expected", "in the folder: plain.simulation.xml, reflex.simulation.xml"});
  for (const char* seconds : {"nan", "inf", "0", "-1", "1e9", "soon", ""}) {
    simulate({scenario("uniform"), "--seconds", seconds}, {"--seconds", "0.01 to 86400"});
  }
  simulate({scenario("uniform"), "--set", "amplitud=3"}, {"amplitud", "amplitude"});
  simulate({scenario("uniform"), "--set", "amplitude=91"}, {"91", "a number from 0 to 90 deg\n"});
  simulate({scenario("coupled"), "--set", "noise=30"}, {"'30' for parameter 'noise'", "a number from 0 to 4\n"});
  simulate({scenario("uniform"), "--set", "amplitude=nan"}, {"nan"});
  simulate({scenario("uniform"), "--set", "amplitude"}, {"amplitude", "=VALUE"});
  simulate({scenario("uniform"), "--set", "amplitude:J9=3"}, {"J9", "J1"});
  simulate({scenario("uniform"), "--set", "amplitude=3@-1"}, {"-1"});
  simulate({scenario("uniform"), "--set", "amplitude=3@3000"}, {"tick 3000", "below 3000"});
}

TEST_F(CommandLine, SimulatePrintsOneJsonObjectWithTheFiguresOfTheRun) {
  const Finished finished = proleg({"simulate", scenario("uniform"), "--seconds", "2", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const Json object(finished.out);
  EXPECT_GT(object["displacement_m"].number(), 0.03);
  EXPECT_DOUBLE_EQ(object["simulated_s"].number(), 2.0);
  EXPECT_GT(object["real_time_factor"].number(), 0.0);
  EXPECT_GT(object["contacts_mean"].number(), 1.0);
  EXPECT_EQ(object["setpoint_hash"].text().size(), 64U);
  EXPECT_EQ(object["servo_hash"].text().size(), 64U);
  EXPECT_NE(object["setpoint_hash"], object["servo_hash"]);
}

TEST_F(CommandLine, SimulatePrintsTheMeasuresOfTheRun) {
  const Finished finished = proleg({"simulate", scenario("uniform"), "--seconds", "4", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json object(finished.out);
  const Json measures = object["measures"];
  EXPECT_EQ(measures["distance"], object["displacement_m"]);
  for (const char* name : {"speed",
                           "sideways_speed",
                           "heading",
                           "yaw_rate",
                           "tracking_error",
                           "max_tracking_error",
                           "at_speed_limit",
                           "at_torque_limit",
                           "largest_acceleration",
                           "mean_current",
                           "mechanical_energy",
                           "electrical_energy",
                           "cost_of_transport",
                           "electrical_cost_of_transport",
                           "specific_resistance",
                           "smoothness",
                           "stability_margin",
                           "height",
                           "slip",
                           "duty_factor",
                           "froude_number",
                           "stride_length",
                           "stride_frequency"}) {
    EXPECT_TRUE(measures[name].is_number()) << name;
  }
  EXPECT_EQ(measures.size(), 30U);
  ASSERT_EQ(object["link_duty_factors"].size(), 6U);
  double sum = 0.0;
  for (const Json& factor : object["link_duty_factors"].elements()) {
    EXPECT_GE(factor.number(), 0.0);
    EXPECT_LE(factor.number(), 1.0);
    sum += factor.number();
  }
  EXPECT_NEAR(measures["duty_factor"].number(), sum / 6, 1e-9);

  const Finished table = proleg({"simulate", scenario("uniform"), "--seconds", "4", "--measures"});
  EXPECT_NE(table.out.find("\n  stride_frequency              1 Hz\n"), std::string::npos) << table.out;
  const std::string lines = proleg({"simulate", scenario("uniform"), "--seconds", "4"}).out;
  const std::size_t first = lines.find("all: --measures)\n");
  ASSERT_NE(first, std::string::npos) << lines;
  EXPECT_EQ(std::count(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), '\n'), 7) << lines;
}

TEST_F(CommandLine, SimulateWarnsOfServosThatCannotFollowTheGait) {
  const std::vector<std::string> words{"simulate", scenario("uniform"), "--seconds", "4", "--json"};
  std::vector<std::string> fast_words = words;
  fast_words.insert(fast_words.end(), {"--set", "frequency=2"});  // needs 8.8 rad/s, the servos have 4.5
  const Finished fast = proleg(fast_words);
  EXPECT_EQ(fast.status, 0);
  EXPECT_NE(fast.err.find("proleg simulate: warning: the servos cannot follow this gait: "), std::string::npos)
      << fast.err;
  EXPECT_NE(fast.err.find("speed limit"), std::string::npos) << fast.err;
  const Json object(fast.out);
  ASSERT_EQ(object["servos"].size(), 5U);
  double shares = 0.0;
  for (const Json& servo : object["servos"].elements()) {
    shares += servo["at_speed_limit"].number();
  }
  EXPECT_NEAR(object["measures"]["at_speed_limit"].number(), shares / 5, 1e-9);
  EXPECT_EQ(proleg(words).err, "");
}

TEST_F(CommandLine, AMeasureThatTheRunDoesNotDefineIsNull) {
  const std::string recording = file("run.proleg").string();
  const std::vector<std::string> words{"simulate", scenario("uniform"), "--seconds", "1",
                                       "--set",    "amplitude=0",       "--record",  recording};
  std::vector<std::string> json_words = words;
  json_words.emplace_back("--json");
  const Json measures = Json(proleg(json_words).out)["measures"];
  for (const char* name : {"cost_of_transport", "specific_resistance", "slip", "stride_length", "stride_frequency"}) {
    EXPECT_TRUE(measures[name].is_null()) << name;
  }
  EXPECT_TRUE(measures["distance"].is_number());
  EXPECT_EQ(proleg(words).out.find("stride_frequency"), std::string::npos) << "the table omits it";
  std::map<std::string, std::string> results;
  const sim::Recording recorded(recording);
  for (const auto& [name, value] : recorded.results()) {
    results[name] = value;
  }
  EXPECT_TRUE(results.contains("smoothness")) << "a recording has the defined ones";
  EXPECT_FALSE(results.contains("stride_frequency"));
  EXPECT_EQ(std::stod(results.at("distance")), measures["distance"].number());
  EXPECT_EQ(std::stod(results.at("duty_factor.Head")), 1.0) << "it lies on the ground";
}

TEST_F(CommandLine, TheSameCommandGivesTheSameHashesAndASettingChangesThem) {
  const auto hash = [&](const std::vector<std::string>& rest) {
    std::vector<std::string> words{"simulate", scenario("coupled"), "--seconds", "1", "--json"};
    words.insert(words.end(), rest.begin(), rest.end());
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return Json(finished.out)["setpoint_hash"].text();
  };
  const std::string plain = hash({});
  EXPECT_EQ(hash({}), plain);
  EXPECT_NE(hash({"--set", "amplitude=20"}), plain);
  EXPECT_NE(hash({"--set", "amplitude=20@50"}), plain);
  EXPECT_NE(hash({"--set", "amplitude=20@50"}), hash({"--set", "amplitude=20@51"}));
  EXPECT_NE(hash({"--set", "current_phase:J3=90@50"}), plain) << "an internal value is distorted";
}

TEST_F(CommandLine, VerbosePrintsTheJointMapAndEveryParameter) {
  const Finished finished = proleg({"simulate", scenario("tail_fixed"), "--seconds", "0.1", "--verbose"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.err.find("J5"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("amplitude [deg] J5=40 J4=40 J3=40 J2=40 J1=0"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find("[1]"), std::string::npos) << finished.err;
}

TEST_F(CommandLine, ARecordingCanBeExportedAndDrawn) {
  const std::string recording = file("run.proleg").string();
  ASSERT_EQ(proleg({"simulate", scenario("uniform"), "--seconds", "2", "--record", recording}).status, 0);
  const Finished table = proleg({"export", recording, "--tsv", "--out", "-"});
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_EQ(proleg({"export", recording, "--out", "-"}).out, table.out) << "the only format";
  EXPECT_EQ(std::count(table.out.begin(), table.out.end(), '\n'), 201) << "a header and 200 ticks";
  const Finished beside = proleg({"export", recording, "--tsv"});
  EXPECT_EQ(beside.status, 0) << beside.err;
  EXPECT_EQ(beside.out, file("run.tsv").string() + "\n");
  EXPECT_EQ(read_file(file("run.tsv")), table.out);
  const std::string picture = file("run.svg").string();
  const Finished drawn = proleg({"plot", recording, "--out", picture});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_NE(read_file(picture).find("<svg"), std::string::npos);
}

TEST_F(CommandLine, ExportDoesNotReplaceItsRecording) {
  const std::string recording = file("run.tsv").string();
  ASSERT_EQ(proleg({"simulate", scenario("uniform"), "--seconds", "0.1", "--record", recording}).status, 0);
  EXPECT_EQ(proleg({"export", recording}).out, recording + ".tsv\n");
  expect_refused({"export", recording, "--out", recording}, {"--out", "no table"});
  EXPECT_EQ(proleg({"export", recording, "--out", "-"}).status, 0) << "it is still a recording";
}

TEST_F(CommandLine, ARecordingFollowsALinkAndTakesItsNameLiterally) {
  const std::string target = file("target.proleg").string();
  const std::string link = file("link.proleg").string();
  fs::create_symlink(target, link);
  const std::vector<std::string> simulate{"simulate", scenario("uniform"), "--seconds", "0.1", "--record"};
  for (const std::string& name : {target, link, file(":memory:").string()}) {
    std::vector<std::string> words = simulate;
    words.push_back(name);
    EXPECT_EQ(proleg(words).status, 0) << name;
    EXPECT_EQ(proleg({"export", name, "--tsv"}).status, 0) << name;
  }
  EXPECT_TRUE(fs::is_symlink(link));
}

TEST_F(CommandLine, ExportAndPlotRefuseAFileThatIsNoRecording) {
  std::ofstream(file("text")) << "not a recording\n";
  std::ofstream(file("empty"));
  for (const char* tool : {"export", "plot"}) {
    for (const char* name : {"text", "empty", "missing"}) {
      std::vector<std::string> words{tool, file(name).string()};
      if (std::string(tool) == "export") {
        words.emplace_back("--tsv");
      }
      expect_refused(words, {name});
    }
  }
}

TEST_F(CommandLine, AlgorithmsListsWhatCanBeSet) {
  EXPECT_NE(proleg({"algorithms"}).out.find("PatternGenerator_sinusoidal\n"), std::string::npos);
  const Finished finished = proleg({"algorithms", "PatternGenerator_sinusoidal"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.out.find("amplitude [deg], 0 to 90, default 40"), std::string::npos) << finished.out;
  const Finished coupled = proleg({"algorithms", "PatternGenerator_coupled_oscillator"});
  EXPECT_NE(coupled.out.find("  noise, 0 to 4, default 1\n"), std::string::npos)
      << "a ratio has no unit: " << coupled.out;
  expect_refused({"algorithms", "MTRAN"}, {"'MTRAN'", "DirectJointAccess"});
}

TEST_F(CommandLine, ObjectsListsTheObjectDictionary) {
  const Finished finished = proleg({"objects"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.out.find("0x6040"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("PatternGenerator_coupled_oscillator: parameters 0x3080 to 0x3086"), std::string::npos);
  expect_refused({"objects", "--eds", "--markdown"}, {"--eds", "--markdown"});
  expect_refused({"objects", "--dbc", "--eds"}, {"--dbc", "--eds"});
  expect_refused({"objects", "--dbc", scenario("uniform"), "--nodes", "3"}, {"--nodes", "FILE"});
  expect_refused({"objects", scenario("uniform")}, {"FILE", "uniform", "only with --dbc"});
  expect_refused({"objects", "--units"}, {"--units", "only with --eds"});
  expect_refused({"objects", "--markdown", "--units"}, {"--units", "--markdown"});
  expect_refused({"objects", "--eds", "--nodes", "3"}, {"--nodes", "'3'", "only with --dbc"});
  expect_refused({"objects", "--dbc", "--nodes", "127"}, {"--nodes", "'127'", "1 to 126"});
  expect_refused({"objects", "--dbc", "--nodes", "0"}, {"--nodes", "'0'", "1 to 126"});
  expect_refused({"objects", "--dbc", file("none").string()}, {"none"});
}

/// The first line in which a text differs from another; empty if there is none.
std::string first_difference(const std::string& found, const std::string& expected) {
  std::istringstream a(found);
  std::istringstream b(expected);
  std::string in_a;
  std::string in_b;
  for (int line = 1;; ++line) {
    const bool more_a = static_cast<bool>(std::getline(a, in_a));
    const bool more_b = static_cast<bool>(std::getline(b, in_b));
    if (!more_a && !more_b) {
      return {};
    }
    if (more_a != more_b || in_a != in_b) {
      return "line " + std::to_string(line) + ": " + (more_a ? in_a : "nothing");
    }
  }
}

struct WrittenPage {
  const char* page;
  std::vector<std::string> words;
};

TEST_F(CommandLine, ThePagesThatProgramsWriteAgreeWithTheDeclarations) {
  for (const auto& [page, words] :
       {WrittenPage{"docs/algorithms.md", {"algorithms", "--markdown"}},
        WrittenPage{"docs/objects.md", {"objects", "--markdown"}}, WrittenPage{"docs/proleg.eds", {"objects", "--eds"}},
        WrittenPage{"docs/proleg.dbc", {"objects", "--dbc"}}}) {
    EXPECT_EQ(first_difference(proleg(words).out, read_file(source_path("/" + std::string(page)))), "")
        << "write it again: build/host/bin/proleg " << words[0] << ' ' << words[1] << " >" << page;
  }
}

TEST_F(CommandLine, ThePageOfGaitMeasuresHasTheTableOfTheDeclarations) {
  const std::string table = proleg({"algorithms", "--measures", "--markdown"}).out;
  EXPECT_NE(table.find("| `cost_of_transport` | m/s^2 | lower |"), std::string::npos) << table;
  EXPECT_NE(read_file(fs::path(source_path("/docs/gait-measures.md"))).find("\n\n" + table + "\n"), std::string::npos)
      << "docs/gait-measures.md must contain:\n"
      << table;
  EXPECT_NE(proleg({"algorithms", "--measures"}).out.find("smoothness [m/s^2], the lower, the better\n"),
            std::string::npos);
  expect_refused({"algorithms", "DirectJointAccess", "--measures"}, {"--measures"});
}

TEST_F(CommandLine, ThePageOfFaultsHasTheTableOfTheDeclarations) {
  const std::string table = proleg({"faults", "--markdown"}).out;
  EXPECT_NE(table.find("| `at TIME unplug JOINT for TIME` |"), std::string::npos) << table;
  EXPECT_NE(read_file(fs::path(source_path("/docs/faults.md"))).find("\n\n" + table + "\n"), std::string::npos)
      << "docs/faults.md must contain:\n"
      << table;
}

TEST_F(CommandLine, AFullDiskIsReported) {
  const Finished finished = proleg({"simulate", scenario("uniform"), "--seconds", "0.1"}, "/dev/full");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("standard output"), std::string::npos);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--help"}, {"--version"}, {"simulate", "--help"}, {"plot", "--help"}}) {
    const Finished help = proleg(words, "/dev/full");
    EXPECT_EQ(help.status, 1) << words[0];
    EXPECT_NE(help.err.find("cannot write to standard output"), std::string::npos) << help.err;
  }
}

TEST_F(CommandLine, ARecordingThatCannotBeWrittenIsRefusedBeforeTheRun) {
  const std::string notes = file("notes.txt").string();
  std::ofstream(notes) << "precious\n";
  const std::string missing = file("no/such/folder").string();
  for (const std::string& target : {missing, notes, std::string(), fs::temp_directory_path().string()}) {
    expect_refused({"simulate", scenario("uniform"), "--seconds", "0.1", "--record", target},
                   {target.empty() ? "--record" : target});
  }
  EXPECT_EQ(read_file(notes), "precious\n");
}

}  // namespace
}  // namespace proleg::test
