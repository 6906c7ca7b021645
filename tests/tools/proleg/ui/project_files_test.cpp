#include "tools/proleg/ui/project_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

class ProjectFilesTest : public ::testing::Test {
 protected:
  /// seconds: how much later than the others it was changed.
  std::string make(const std::string& name, int seconds = 0) {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << "x";
    fs::last_write_time(path, time_ + std::chrono::seconds(seconds));
    return path.string();
  }
  [[nodiscard]] ProjectFiles files(const std::string& project = "mine") const {
    return {folder_ / project, std::nullopt, RecentFiles(folder_ / "state/recent.json")};
  }
  static std::vector<std::string> titles(const ProjectFiles& files) {
    std::vector<std::string> titles;
    for (const ProjectFile& file : files.list()) {
      titles.push_back(file.group + ": " + file.title);
    }
    return titles;
  }

  TemporaryFolder folder_;
  fs::file_time_type time_ = fs::file_time_type::clock::now() - std::chrono::hours(1);
};

TEST_F(ProjectFilesTest, TheScenariosOfTheProjectComeTheNewestFirst) {
  make("mine/wave.simulation.xml");
  make("mine/gaits/slow.simulation.xml", 20);
  make("mine/gaits/slow.robot.xml", 30);
  make("mine/run.proleg", 30);
  EXPECT_EQ(titles(files()), (std::vector<std::string>{"My project: gaits/slow", "My project: wave"}));
  EXPECT_TRUE(files("none").list().empty());
}

TEST_F(ProjectFilesTest, HiddenFoldersBuildFoldersAndDeepOnesAreLeftOut) {
  const std::string deepest = make("mine/1/2/3/4/in.simulation.xml");
  const std::vector<std::string> out{make("mine/.git/a.simulation.xml"), make("mine/build/a.simulation.xml"),
                                     make("mine/sub/build/a.simulation.xml"),
                                     make("mine/1/2/3/4/5/out.simulation.xml")};
  const ProjectFiles project = files();
  EXPECT_EQ(titles(project), std::vector<std::string>{"My project: 1/2/3/4/in"});
  EXPECT_TRUE(project.has(deepest));
  for (const std::string& file : out) {
    EXPECT_FALSE(project.has(file)) << file;
  }
}

TEST_F(ProjectFilesTest, LinksThatLeadOutOfTheProjectAreNotInIt) {
  const std::string inside = make("mine/a.simulation.xml");
  const std::string outside = make("other/b.simulation.xml");
  fs::create_symlink(outside, folder_ / "mine/link.simulation.xml");
  fs::create_directory_symlink(folder_ / "other", folder_ / "mine/other");
  fs::create_directory_symlink(folder_ / "mine", folder_ / "project");
  const ProjectFiles project = files();
  EXPECT_EQ(titles(project), std::vector<std::string>{"My project: a"});
  EXPECT_FALSE(project.has((folder_ / "mine/link.simulation.xml").string()));
  EXPECT_FALSE(project.has((folder_ / "mine/other/b.simulation.xml").string()));
  EXPECT_FALSE(project.has((folder_ / "mine/../other/b.simulation.xml").string()));
  EXPECT_TRUE(project.has((folder_ / "mine/../mine/./a.simulation.xml").string()));
  EXPECT_TRUE(files("project").has(inside)) << "the project itself may be a link";
}

TEST_F(ProjectFilesTest, OnlyScenariosThatExistCanBeOpened) {
  make("mine/a.robot.xml");
  fs::create_directories(folder_ / "mine/folder.simulation.xml");
  const ProjectFiles project = files();
  for (const std::string& file :
       {std::string(), std::string("/"), (folder_ / "mine").string(), (folder_ / "mine/a.robot.xml").string(),
        (folder_ / "mine/none.simulation.xml").string(), (folder_ / "mine/folder.simulation.xml").string(),
        std::string("/dev/stdin"), std::string("a\0.simulation.xml", 17), std::string("\xff.simulation.xml")}) {
    EXPECT_FALSE(project.has(file)) << file;
  }
}

TEST_F(ProjectFilesTest, WhatWasOpenedBeforeCanBeOpenedAgain) {
  const RecentFiles recent(folder_ / "state/recent.json");
  const std::string file = make("elsewhere/a.simulation.xml");
  const std::string beside = make("elsewhere/b.simulation.xml");
  const std::string other = make("school/gaits/c.simulation.xml");
  make("mine/own.simulation.xml");
  recent.note(folder_ / "school");
  recent.note(file);
  recent.note(folder_ / "mine/own.simulation.xml");
  const ProjectFiles project = files();
  EXPECT_EQ(titles(project), (std::vector<std::string>{"My project: own", "Last: a", "Last: school: gaits/c"}));
  EXPECT_TRUE(project.has(file));
  EXPECT_TRUE(project.has(other));
  EXPECT_FALSE(project.has(beside));
}

TEST_F(ProjectFilesTest, OfVeryManySomeAreListed) {
  for (std::size_t i = 0; i < ProjectFiles::max_files + 3; ++i) {
    make("mine/" + std::to_string(i) + ".simulation.xml");
  }
  EXPECT_EQ(files().list().size(), ProjectFiles::max_files);
}

TEST(ShippedScenarios, AllHaveTheirPlaceInTheGallery) {
  const std::string shipped = source_path("/sim/scenarios");
  const TemporaryFolder folder;
  const ProjectFiles files(folder.path(), shipped, RecentFiles(std::nullopt));
  std::vector<std::string> listed;
  for (const ProjectFile& file : files.list()) {
    EXPECT_TRUE(file.is_shipped && files.has(file.file)) << file.file;
    EXPECT_FALSE(file.title.empty());
    listed.push_back(file.file);
  }
  std::ranges::sort(listed);
  EXPECT_EQ(listed, ProjectFiles::scenarios_in(shipped));
  EXPECT_EQ(listed.size(), shipped_scenarios().size());
  EXPECT_EQ(shipped_folder(), shipped);
}

TEST(ShippedScenarios, AreListedOnceWhereTheyArePartOfTheProject) {
  const std::string shipped = source_path("/sim/scenarios");
  const ProjectFiles files(source_path("/sim"), shipped, RecentFiles(std::nullopt));
  EXPECT_EQ(files.list().size(), shipped_scenarios().size());
}

}  // namespace
}  // namespace proleg::tools
