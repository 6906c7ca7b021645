#include "tools/proleg/ui/actuation_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "simulated_run.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/live_simulation.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// A copy of the files of a shipped scenario, which a test may change.
class ActuationFile : public ::testing::Test {
 protected:
  ActuationFile() {
    std::filesystem::copy(source_path("/sim/scenarios/travelling_wave"), folder_ / "",
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  }
  [[nodiscard]] sim::Scenario read() const {
    sim::DiskFiles files;
    return sim::read_scenario(folder_ / "tail_fixed.simulation.xml", files);
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "tail_fixed.actuation.xml"; }
  [[nodiscard]] std::string text() const { return file_contents(path()); }

  TemporaryFolder folder_;
};

TEST_F(ActuationFile, WrittenAndReadAgainHasTheWantedValues) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    LiveSimulation live(read(), {}, nullptr);
    for (int change = 0; change < 6; ++change) {
      const char* names[] = {"amplitude", "amplitude:J1", "amplitude:J4", "phase_difference:J2", "frequency"};
      live.set({names[random() % 5] + std::string("=0.") + std::to_string(random() % 1000)}, std::nullopt);
      live.advance();
    }
    live.apply_to_file(live.file_edits());
    const sim::Scenario again = read();
    for (const ParameterPlace& place : live.parameters().places()) {
      const ParameterTable::Values& values = live.parameters().at(place);
      EXPECT_EQ(sim::start_value(again, place.slot, place.joint, place.number), values.wanted);
      EXPECT_EQ(values.file, values.wanted);
    }
    EXPECT_TRUE(live.file_edits().empty());
    // The run began with the values that the file had before.
    EXPECT_EQ(hashes_of(live.simulation()), simulated(again, live.repeating_words(), live.simulation().tick()));
  }
}

TEST_F(ActuationFile, SettingsOfTheCommandLineAreNotOfTheFile) {
  const std::vector<std::string> settings{"amplitude=30", "frequency=0.5@20"};
  LiveSimulation live(read(), settings, nullptr);
  const ParameterPlace tail = live.places_of(std::vector<std::string>{"amplitude:J1"}).front();
  EXPECT_NE(live.parameters().at(tail).wanted, live.parameters().at(tail).file);
  EXPECT_EQ(live.file_edits().size(), 2U);  // the tags for all joints and for J1
  live.set({"amplitude:J2=12"}, std::nullopt);
  for (int tick = 0; tick < 30; ++tick) {
    live.advance();
  }
  live.apply_to_file(live.file_edits());
  std::vector<std::string> words = settings;
  std::ranges::copy(live.repeating_words(), std::back_inserter(words));
  EXPECT_EQ(hashes_of(live.simulation()), simulated(read(), words, 30));
  live.restart(LiveSimulation::StartValues::file);
  EXPECT_EQ(live.parameters().at(tail).wanted, sim::start_value(read(), tail.slot, tail.joint, tail.number));
}

TEST_F(ActuationFile, ThatHasChangedSinceItWasReadIsNotOverwritten) {
  LiveSimulation live(read(), {}, nullptr);
  live.set({"amplitude=30"}, std::nullopt);
  std::ofstream(path(), std::ios::app) << "<!-- another hand -->\n";
  const std::string changed = text();
  EXPECT_EQ(message_of<InputError>([&] { live.apply_to_file(live.file_edits()); }),
            path().string() +
                ": found a file that has changed since this program read it, expected the same file; start `proleg ui` "
                "again");
  EXPECT_EQ(text(), changed);
}

TEST_F(ActuationFile, OfAShippedScenarioIsNotWritten) {
  sim::DiskFiles files;
  const std::string shipped = source_path("/sim/scenarios/travelling_wave/tail_fixed.simulation.xml");
  LiveSimulation live(sim::read_scenario(shipped, files), {}, nullptr);
  const std::string before = file_contents(source_path("/sim/scenarios/travelling_wave/tail_fixed.actuation.xml"));
  live.set({"amplitude=30"}, std::nullopt);
  EXPECT_NE(message_of<InputError>([&] { live.apply_to_file(live.file_edits()); }).find("expected a copy of your own"),
            std::string::npos);
  EXPECT_EQ(file_contents(source_path("/sim/scenarios/travelling_wave/tail_fixed.actuation.xml")), before);
}

TEST_F(ActuationFile, ACopyHasAllFilesOfTheScenarioAndMovesAsItDoes) {
  for (const char* name : {"robots/mesh_world/mesh_world", "robots/y1/robot", "travelling_wave/uniform"}) {
    sim::DiskFiles files;
    LiveSimulation live(sim::read_scenario(source_path("/sim/scenarios/") + name + ".simulation.xml", files), {},
                        nullptr);
    live.set({"amplitude=25"}, std::nullopt);
    const std::filesystem::path copy = folder_ / ("copy of " + std::filesystem::path(name).filename().string());
    live.save_as(copy);
    EXPECT_TRUE(live.file_edits().empty());
    EXPECT_TRUE(live.file().path.starts_with(copy.string())) << live.file().path;
    for (const sim::SourceFile& source : live.file().sources) {
      EXPECT_TRUE(source.path.starts_with(copy.string())) << source.path;
    }
    live.restart(LiveSimulation::StartValues::file);
    for (int tick = 0; tick < 20; ++tick) {
      live.advance();
    }
    sim::DiskFiles again;
    EXPECT_EQ(hashes_of(live.simulation()), simulated(sim::read_scenario(live.file().path, again), {}, 20)) << name;
    const std::string file = live.file().path;
    EXPECT_THROW(live.save_as(copy), InputError) << "the folder exists";
    EXPECT_EQ(live.file().path, file);
  }
}

TEST_F(ActuationFile, OnlyAPresentListOfDifferencesIsApplied) {
  LiveSimulation live(read(), {}, nullptr);
  live.set({"amplitude:J1=5", "frequency=0.5"}, std::nullopt);
  const std::vector<sim::ActuationEdit> edits = live.file_edits();
  const json diff = file_diff_json(live.file(), edits);
  ASSERT_EQ(diff["entries"].size(), 2U);
  EXPECT_EQ(diff["entries"][0]["name"], "amplitude");
  EXPECT_EQ(diff["entries"][0]["joints"], json({4}));
  EXPECT_EQ(diff["entries"][0]["old"], R"(<parameter name="amplitude" value="0" unit="deg" joint="J1"/>)");
  EXPECT_EQ(diff["entries"][0]["new"], R"(<parameter name="amplitude" value="5" unit="deg" joint="J1"/>)");
  const auto chosen = [&](const json& numbers) {
    return chosen_edits(live.file(), live.file_edits(), {{"diff", diff["diff"]}, {"entries", numbers}});
  };
  ASSERT_EQ(chosen({1}).size(), 1U);
  EXPECT_EQ(chosen({1})[0].patch.position, edits[1].patch.position);
  for (const json& numbers : {json::array(), json({2}), json({0, 0}), json({-1}), json("all"), json()}) {
    EXPECT_THROW(chosen(numbers), InputError) << numbers;
  }
  live.set({"frequency=0.6"}, std::nullopt);
  EXPECT_THROW(chosen({1}), InputError);
}

}  // namespace
}  // namespace proleg::tools
