#include "tools/proleg/ui/recording_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/live_simulation.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

void record(const fs::path& path, unsigned ticks) {
  fs::remove(path);  // the page replaces no recording
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveSimulation live(scenario, {}, nullptr);
  ASSERT_TRUE(live.record(path, "simulate", "test", [] { return true; }));
  for (unsigned tick = 0; tick < ticks; ++tick) {
    live.advance();
  }
  live.end_recording();
}

nlohmann::json described_list(RecordingFolder& folder) {
  static_cast<void>(folder.list());
  while (folder.describe_some()) {
  }
  return folder.list();
}

TEST(RecordingFolder, ListsRecordingsAndSaysWhatIsWrongWithOthers) {
  const TemporaryFolder files;
  fs::create_directory(files / "monday");
  record(files / "monday/run.proleg", 25);
  std::ofstream(files / "notes.txt") << "no recording";
  std::ofstream(files / "broken.proleg") << "no recording";
  RecordingFolder folder(files.path());
  const nlohmann::json list = described_list(folder);
  ASSERT_EQ(list.size(), 2U);
  const bool is_first = list[0]["name"] == "monday/run.proleg";
  const nlohmann::json& run = list[is_first ? 0 : 1];
  const nlohmann::json& broken = list[is_first ? 1 : 0];
  EXPECT_EQ(run["name"], "monday/run.proleg");
  EXPECT_EQ(run["program"], "simulate");
  EXPECT_EQ(run["scenario"], "uniform.simulation.xml");
  EXPECT_EQ(run["algorithms"], nlohmann::json({"PatternGenerator_sinusoidal"}));
  EXPECT_EQ(run["joints"], 5);
  EXPECT_DOUBLE_EQ(run["seconds"].get<double>(), 0.25);
  EXPECT_EQ(run["finished"], true);
  EXPECT_EQ(run["bytes"], fs::file_size(files / "monday/run.proleg"));
  EXPECT_TRUE(run["problem"].is_null());
  EXPECT_EQ(broken["name"], "broken.proleg");
  EXPECT_NE(broken["problem"].get<std::string>().find("expected a recording"), std::string::npos) << broken;
}

TEST(RecordingFolder, ReadsAFileAgainThatHasChanged) {
  const TemporaryFolder files;
  record(files / "run.proleg", 25);
  RecordingFolder folder(files.path());
  EXPECT_DOUBLE_EQ(described_list(folder)[0]["seconds"].get<double>(), 0.25);
  record(files / "run.proleg", 50);
  EXPECT_DOUBLE_EQ(described_list(folder)[0]["seconds"].get<double>(), 0.5);
}

TEST(RecordingFolder, LetsNobodyOutOfTheFolder) {
  const TemporaryFolder outside;
  record(outside / "secret.proleg", 5);
  const TemporaryFolder files;
  record(files / "mine.proleg", 5);
  fs::create_directory(files / "deep");
  fs::create_symlink(outside / "secret.proleg", files / "link.proleg");
  fs::create_directory_symlink(outside.path(), files / "other");
  fs::create_symlink(files / "mine.proleg", files / "deep/near.proleg");
  // A folder whose name begins as that of ours.
  const fs::path neighbour = files.path().string() + "-too";
  fs::create_directory(neighbour);
  fs::copy_file(outside / "secret.proleg", neighbour / "secret.proleg");
  RecordingFolder folder(files.path());
  const std::string names[] = {"../" + outside.path().filename().string() + "/secret.proleg",
                               outside / "secret.proleg",
                               files / "mine.proleg",
                               "link.proleg",
                               "other/secret.proleg",
                               "deep/../../" + neighbour.filename().string() + "/secret.proleg",
                               "deep/..",
                               "",
                               ".",
                               "missing.proleg",
                               std::string("mine.proleg\0.proleg", 19),
                               std::string(100'000, 'a') + ".proleg",
                               "/etc/passwd"};
  for (const std::string& name : names) {
    EXPECT_THROW(static_cast<void>(folder.find(name)), InputError) << name.substr(0, 80);
  }
  EXPECT_EQ(folder.find("mine.proleg"), fs::canonical(files / "mine.proleg"));
  EXPECT_EQ(folder.find("deep/near.proleg"), fs::canonical(files / "mine.proleg"));
  for (const nlohmann::json& file : folder.list()) {
    EXPECT_TRUE(file["name"] == "mine.proleg" || file["name"] == "deep/near.proleg") << file;
  }
  fs::remove_all(neighbour);
}

TEST(RecordingFolder, NeedsAFolder) {
  const TemporaryFolder files;
  EXPECT_THROW(RecordingFolder(files / "missing"), InputError);
  std::ofstream(files / "file") << "text";
  EXPECT_THROW(RecordingFolder(files / "file"), InputError);
}

TEST(NewRecording, HasANameThatAPersonSees) {
  const TemporaryFolder folder;
  EXPECT_EQ(new_recording(folder.path(), "gait 1 \u00e4.proleg"), folder / "gait 1 \u00e4.proleg");
  for (const char* name : {"", "gait.txt", "../gait.proleg", "a\nb.proleg", "\u202egelorp.proleg", "a\u200b.proleg"}) {
    try {
      static_cast<void>(new_recording(folder.path(), name));
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_EQ(std::string(error.what()).find("\u202e"), std::string::npos) << "the message shows the character";
    }
  }
}

}  // namespace
}  // namespace proleg::tools
