#include "tools/proleg/ui/gallery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shipped.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/gait_preview.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/scenario_picture.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds no_limit = std::chrono::hours(1);

class GalleryTest : public ::testing::Test {
 protected:
  /// A copy of a shipped scenario, as a user has it.
  std::string copy(const std::string& shipped, const std::string& folder) {
    const sim::Scenario scenario = sim::shipped(shipped);
    return copy_sources(scenario.sources, folder_ / folder).at(scenario.sources.front().path);
  }
  void open(std::chrono::milliseconds longest = no_limit) {
    gallery_.emplace(files_, requests_, viewers_, GalleryOptions{longest, std::chrono::milliseconds(0)});
  }
  json look() {
    requests_.operate({++request_, "gallery.look", json::object(), 1, "a test"});
    EXPECT_TRUE(viewers_.answer(request_).is_done);
    return entries([](const json& entry) { return entry["picture"].is_object() || entry["failure"].is_string(); });
  }
  /// The entries of the document, when all of them are as they are waited for.
  json entries(const std::function<bool(const json&)>& is_so) {
    return viewers_.document_when("gallery", [&](const json& document) {
      return document.contains("entries") && std::ranges::all_of(document["entries"], is_so);
    })["entries"];
  }

  TemporaryFolder folder_;
  ProjectFiles files_{folder_.path(), std::nullopt, RecentFiles(std::nullopt)};
  SessionRequests requests_;
  Viewers viewers_;
  std::optional<Gallery> gallery_;
  std::uint64_t request_ = 0;
};

TEST_F(GalleryTest, NothingIsComputedBeforeSomebodyLooks) {
  copy("gaits/forward", "mine");
  open();
  requests_.operate({++request_, "gallery.list", json::object(), 1, "a test"});
  EXPECT_FALSE(viewers_.answer(request_).is_done);
  EXPECT_TRUE(viewers_.document("gallery").is_null());
}

TEST_F(GalleryTest, AnEntrySaysWhatTheScenarioIs) {
  const std::string file = copy("gaits/forward", "mine");
  open();
  const json entries = look();
  ASSERT_EQ(entries.size(), 1U);
  const json& entry = entries[0];
  EXPECT_EQ(entry["file"], file);
  EXPECT_EQ(entry["folder"], "My project");
  EXPECT_EQ(entry["text"], "Forward: the travelling wave of the thesis with smooth starts and changes.");
  EXPECT_EQ(entry["joints"], 5);
  EXPECT_EQ(entry["algorithms"], json({"PatternGenerator_sinusoidal_extended"}));
  EXPECT_NEAR(entry["distance"].get<double>(), 0.57, 0.06);  // a third of the 1.71 m in 30 s of docs/gaits.md
  EXPECT_EQ(entry["is_shipped"], false);
  EXPECT_EQ(entry["failure"], json());
  EXPECT_EQ(entry["missing"], json::array());
  EXPECT_EQ(entry["picture"]["view"], "side");
}

TEST_F(GalleryTest, ARefusedScenarioIsListedWithItsError) {
  std::ofstream(folder_ / "broken.simulation.xml") << "<simulation><robot>none.robot.xml</robot></simulation>";
  open();
  const json entries = look();
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_NE(entries[0]["failure"].get<std::string>().find("broken.simulation.xml:1: found"), std::string::npos);
  EXPECT_EQ(entries[0]["picture"], json());
}

TEST_F(GalleryTest, AScenarioThatNeedsOtherAlgorithmsNamesThem) {
  copy("gaits/forward", "mine");
  const std::string gait = folder_ / "mine/gaits/forward.actuation.xml";
  std::string text = file_contents(gait);
  const std::string name = "PatternGenerator_sinusoidal_extended";
  text.replace(text.find(name), name.size(), "my_wave");
  std::ofstream(gait) << text;
  open();
  const json entries = look();
  EXPECT_EQ(entries[0]["missing"], json({"my_wave"}));
  EXPECT_NE(entries[0]["failure"].get<std::string>().find("unknown algorithm 'my_wave'"), std::string::npos);
}

TEST_F(GalleryTest, TheNextLookFindsNewAndChangedFiles) {
  const std::string file = copy("gaits/forward", "mine");
  open();
  const json before = look();
  const std::string gait = folder_ / "mine/gaits/forward.actuation.xml";
  std::string text = file_contents(gait);
  text.replace(text.find("value=\"40\""), 10, "value=\"20\"");
  std::ofstream(gait) << text;
  copy("gaits/reverse", "other");
  requests_.operate({++request_, "gallery.look", json::object(), 1, "a test"});
  EXPECT_TRUE(viewers_.answer(request_).is_done);
  const json after = viewers_.document_when("gallery", [&](const json& document) {
    const json& entries = document["entries"];
    return entries.size() == 2 &&
           std::ranges::all_of(entries, [](const json& e) { return e["picture"].is_object(); }) &&
           std::ranges::any_of(
               entries, [&](const json& e) { return e["file"] == file && e["distance"] != before[0]["distance"]; });
  })["entries"];
  EXPECT_EQ(after.size(), 2U);
}

TEST_F(GalleryTest, ALongRunHasAPictureOfItsStart) {
  copy("gaits/forward", "mine");
  open(std::chrono::milliseconds(0));
  const json entries = look();
  EXPECT_EQ(entries[0]["distance"], json());
  EXPECT_EQ(entries[0]["picture"]["ghosts"], json::array());
  EXPECT_EQ(entries[0]["picture"]["path"], json::array());
  EXPECT_EQ(entries[0]["picture"]["links"].size(), 6U);
}

TEST_F(GalleryTest, ItEndsInTheMiddleOfItsWork) {
  copy("long_chain/sixty", "mine");
  open();
  requests_.operate({++request_, "gallery.look", json::object(), 1, "a test"});
  EXPECT_TRUE(viewers_.answer(request_).is_done);
  gallery_.reset();
}

json picture_of(const std::string& shipped, std::chrono::milliseconds longest = no_limit) {
  const sim::Scenario scenario = sim::shipped(shipped);
  return picture_json(scenario, preview_of(scenario, longest, [] { return false; }));
}

/// The number of numbers of a line that are between 0 and the size of the picture.
std::size_t points_inside(const json& line) {
  std::size_t inside = 0;
  for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
    const int x = line[i];
    const int y = line[i + 1];
    inside += x >= 0 && x <= 1000 && y >= 0 && y <= 500 ? 1 : 0;
  }
  return inside;
}

TEST(ScenarioPicture, ShowsTheWholeRobotAtFourMoments) {
  const json picture = picture_of("gaits/forward");
  EXPECT_EQ(picture["links"].size(), 6U);
  EXPECT_EQ(picture["body"].size(), 2 * 7U);
  EXPECT_EQ(picture["ghosts"].size(), 3U);
  EXPECT_EQ(points_inside(picture["body"]), 7U);
  for (const json& ghost : picture["ghosts"]) {
    EXPECT_EQ(points_inside(ghost), 7U);
    EXPECT_NE(ghost, picture["body"]);
  }
  EXPECT_GT(picture["path"].size(), 20U);
  EXPECT_EQ(std::ranges::count_if(picture["links"], [](const json& link) { return link[0] == 1; }), 1);
}

TEST(ScenarioPicture, IsOfTheSideOfAPitchGaitAndFromAboveOtherwise) {
  EXPECT_EQ(picture_of("gaits/rectilinear")["view"], "side");
  EXPECT_EQ(picture_of("gaits/turning")["view"], "above");
  EXPECT_EQ(picture_of("gaits/sidewinding")["view"], "above");
}

TEST(ScenarioPicture, ShowsTheStepsOfTheWorld) {
  const auto heights = [](const json& section) {
    int low = 1000;
    int high = -1000;
    for (std::size_t i = 1; i < section.size(); i += 2) {
      low = std::min(low, section[i].get<int>());
      high = std::max(high, section[i].get<int>());
    }
    return high - low;
  };
  EXPECT_EQ(heights(picture_of("gaits/forward")["ground"][0]), 0);
  EXPECT_GT(heights(picture_of("obstacle/reflex")["ground"][0]), 20);
}

TEST(ScenarioPicture, IsSmallAlsoOfALongChain) {
  constexpr std::size_t most_bytes = 3'100;
  for (const char* name : {"robots/cubo/robot", "long_chain/twenty", "gaits/sidewinding", "adaptive_touch/reflex"}) {
    EXPECT_LT(picture_of(name).dump().size(), most_bytes) << name;
  }
  for (const char* name : {"long_chain/sixty", "robots/mesh_world/mesh_world"}) {
    EXPECT_LT(picture_of(name, std::chrono::milliseconds(0)).dump().size(), most_bytes) << name;
  }
}

}  // namespace
}  // namespace proleg::tools
