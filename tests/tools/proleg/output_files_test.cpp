// What the programs do with files that exist already, and with names.

#include <sys/resource.h>

#include <algorithm>

#include "command_line.hpp"
#include "sim/record/recording.hpp"

namespace proleg::test {
namespace {

class OutputFiles : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    ASSERT_EQ(proleg(record("kept.proleg")).status, 0);
    std::ofstream(file("kept.log")) << "(0000000000.000056) can0 77F#05\n";
    std::ofstream(file("kept.tsv")) << "node\ttick\tto_state_frame\twhole_tick\n1\t2\t3\t4\n";
    for (const char* name : {"kept.proleg", "kept.log", "kept.tsv"}) {
      kept_.emplace_back(name, read_file(file(name)));
    }
  }

  [[nodiscard]] std::vector<std::string> record(const std::string& name) const {
    return {"simulate", scenario("uniform"), "--seconds", "0.1", "--record", file(name).string()};
  }

  /// Refused, and no file is changed or created.
  void expect_nothing_written(const std::vector<std::string>& words, const std::vector<std::string>& message) const {
    const std::size_t files = left_behind().size();
    expect_refused(words, message);
    for (const auto& [name, text] : kept_) {
      EXPECT_EQ(read_file(file(name)), text) << name;
    }
    EXPECT_EQ(left_behind().size(), files);
  }

  /// Options that would replace all kept files.
  [[nodiscard]] std::vector<std::string> hil(const std::vector<std::string>& more,
                                             const std::string& scenario_file = scenario("uniform")) const {
    std::vector<std::string> words{"hil", scenario_file, "--seconds", "0.1", "--modules", "1=mcu"};
    words.insert(words.end(), {"--record", file("kept.proleg").string(), "--can-log", file("kept.log").string()});
    words.insert(words.end(), {"--trace", "1=" + file("kept.tsv").string()});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// 60 joints, whose frames do not fit into a tick of 5 ms.
  [[nodiscard]] std::string too_full_scenario() const {
    const std::string folder = source_path("/sim/scenarios/long_chain/");
    std::string text = read_file(folder + "sixty.simulation.xml");
    const auto replace = [&text](const std::string& old, const std::string& by) {
      const std::size_t at = text.find(old);
      EXPECT_NE(at, std::string::npos) << old;
      text.replace(at, old.size(), by);
    };
    replace(">sixty.robot", ">" + folder + "sixty.robot");
    replace(">sixty.actuation", ">" + folder + "sixty.actuation");
    replace(">../", ">" + folder + "../");
    replace(">10</tick>", ">5</tick>");
    std::ofstream(file("full.simulation.xml")) << text;
    return file("full.simulation.xml").string();
  }

 private:
  std::vector<std::pair<std::string, std::string>> kept_;
};

TEST_F(OutputFiles, ARefusedCommandChangesNone) {
  expect_nothing_written(hil({}, too_full_scenario()), {"of the bus"});
  expect_nothing_written(hil({"--reset", "9@5"}), {"node 9"});
  expect_nothing_written(hil({"--uart", "3"}), {"node 3, which is native"});
  expect_nothing_written(hil({"--image", "/missing/x.elf"}), {"/missing/x.elf"});
  expect_nothing_written(hil({"--gdb", "x"}), {"--gdb"});
  expect_nothing_written(hil({"--set", "amplitude=3@5000"}), {"tick 5000"});
  expect_nothing_written(hil({"--trace", "1=/missing/trace"}), {"node 1 twice"});
}

TEST_F(OutputFiles, AFileReplacesAFileOfItsKindAndNothingElse) {
  const std::string uniform = scenario("uniform");
  const std::string text = file("notes.txt").string();
  std::ofstream(text) << "precious\n";
  const std::string recording = file("kept.proleg").string();
  for (const std::string& other : {text, file("kept.log").string(), file("kept.tsv").string()}) {
    expect_nothing_written({"simulate", uniform, "--record", other}, {other, "no recording"});
    expect_nothing_written({"plot", recording, "--out", other}, {other, "no SVG picture"});
    expect_nothing_written({"export", recording, "--out", other}, {other, "no table"});
  }
  for (const std::string& other : {text, recording}) {
    expect_nothing_written({"hil", uniform, "--can-log", other}, {other, "no CAN log"});
    expect_nothing_written({"hil", uniform, "--modules", "1=mcu", "--trace", "1=" + other}, {other, "no trace"});
    expect_nothing_written({"plot", recording, "--out", other}, {other, "no SVG picture"});
    expect_nothing_written({"bus", uniform, "--pty", "--modules", "1=mcu", "--trace", "1=" + other},
                           {other, "no trace"});
    expect_nothing_written({"params", "save", other, "--bus", "sim:" + uniform}, {other, "no file of parameters"});
  }
  EXPECT_EQ(read_file(text), "precious\n");
  EXPECT_EQ(proleg(hil({})).status, 0) << "each replaces an earlier one";
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(proleg({"plot", recording}).status, 0);
    EXPECT_EQ(proleg({"export", recording, "--out", file("table").string()}).status, 0);
  }
}

TEST_F(OutputFiles, ABusWritesTheTraceOfAModule) {
  const std::string trace = file("bus.tsv").string();
  const Finished bus =
      proleg({"bus", scenario("uniform"), "--pty", "--seconds", "0.1", "--modules", "1=mcu", "--trace", "1=" + trace});
  EXPECT_EQ(bus.status, 0) << bus.err;
  const std::string table = read_file(trace);
  EXPECT_TRUE(table.starts_with("node\ttick\tto_state_frame\twhole_tick\n1\t0\t")) << table;
  EXPECT_GE(std::ranges::count(table, '\n'), 10) << "the ticks of the world without a host";
}

TEST_F(OutputFiles, ALimitOfTheSizeOfFilesIsReportedAsAFullDiskIs) {
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  const rlimit small{200'000, usual.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Finished simulated =
      proleg({"simulate", scenario("uniform"), "--seconds", "10", "--record", file("big.proleg").string()});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &usual), 0);
  EXPECT_EQ(simulated.status, 1);
  EXPECT_EQ(simulated.err.find("proleg simulate: " + file("big.proleg").string() + ": recording stopped: "), 0U)
      << simulated.err;
  EXPECT_EQ(std::ranges::count(simulated.err, '\n'), 1) << simulated.err;
}

TEST_F(OutputFiles, ARecordingThatIsReplacedIsNamed) {
  EXPECT_EQ(proleg(record("new.proleg")).err, "");
  EXPECT_EQ(proleg(record("new.proleg")).err, "proleg simulate: replaces " + file("new.proleg").string() + "\n");
  std::vector<std::string> words = record("new.proleg");
  words[0] = "hil";
  EXPECT_EQ(proleg(words).err, "proleg hil: replaces " + file("new.proleg").string() + "\n");
  std::ofstream(file("empty.proleg")).flush();
  EXPECT_EQ(proleg(record("empty.proleg")).err, "") << "nothing is lost";
}

TEST_F(OutputFiles, APictureIsSvgWhateverItsName) {
  const std::string recording = file("kept.proleg").string();
  for (const char* name : {"q.png", "q.PDF"}) {
    expect_nothing_written({"plot", recording, "--out", file(name).string()}, {"--out", name, "ends with .svg"});
  }
  EXPECT_EQ(proleg({"plot", recording, "--out", file("q.svg").string()}).status, 0);
}

TEST_F(OutputFiles, TwoNamesOfOneFileAreFound) {
  const auto expect_twice = [&](const std::string& record, const std::string& log) {
    expect_nothing_written({"hil", scenario("uniform"), "--record", record, "--can-log", log}, {"found twice"});
  };
  fs::create_symlink("run", file("link"));
  expect_twice(file("run").string(), file("./run").string());
  expect_twice(file("run").string(), file("link").string());
  expect_twice(file("run").string(), file("run-wal").string());
}

TEST_F(OutputFiles, ANameThatCannotBeWrittenIsBadInputForEveryOption) {
  const std::string recording = file("kept.proleg").string();
  const std::string missing = file("none/x").string();
  expect_nothing_written({"simulate", scenario("uniform"), "--record", missing}, {missing});
  expect_nothing_written({"hil", scenario("uniform"), "--can-log", missing}, {missing});
  expect_nothing_written({"hil", scenario("uniform"), "--modules", "1=mcu", "--trace", "1=" + missing}, {missing});
  expect_nothing_written({"plot", recording, "--out", missing}, {missing});
  expect_nothing_written({"export", recording, "--out", missing}, {missing});
}

TEST_F(OutputFiles, ARecordingWithoutRoomForSuffixesInItsNameIsRefusedAtTheStart) {
  expect_nothing_written(record(std::string(250, 'x')), {"the name is too long", "at most 247 bytes"});
  EXPECT_EQ(proleg(record(std::string(247, 'x'))).status, 0);
}

TEST_F(OutputFiles, ALinkToAFileThatDoesNotExistYetIsFollowed) {
  for (const char* name : {"run", "picture", "table", "log"}) {
    fs::create_symlink(std::string(name) + ".target", file(name));
  }
  EXPECT_EQ(proleg(record("run")).status, 0);
  EXPECT_EQ(proleg({"plot", file("run").string(), "--out", file("picture").string()}).status, 0);
  EXPECT_EQ(proleg({"export", file("run").string(), "--out", file("table").string()}).status, 0);
  EXPECT_EQ(proleg({"hil", scenario("uniform"), "--seconds", "0.1", "--can-log", file("log").string()}).status, 0);
  for (const char* name : {"run", "picture", "table", "log"}) {
    EXPECT_TRUE(fs::is_symlink(file(name))) << name;
    EXPECT_TRUE(fs::is_regular_file(file(std::string(name) + ".target"))) << name;
  }
}

TEST_F(OutputFiles, TwoRecordingsHaveTwoPictures) {
  for (const char* name : {"run.1", "run.2", "run"}) {
    ASSERT_EQ(proleg(record(name)).status, 0);
    const Finished drawn = proleg({"plot", file(name).string()});
    EXPECT_EQ(drawn.out, file(name).string() + ".svg\n");
    EXPECT_TRUE(fs::exists(file(std::string(name) + ".svg")));
  }
}

}  // namespace
}  // namespace proleg::test
