#include "tools/proleg/ui/recent_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

class RecentFilesTest : public ::testing::Test {
 protected:
  fs::path make(const std::string& name) {
    std::ofstream(folder_ / name) << "x";
    return folder_ / name;
  }
  TemporaryFolder folder_;
  fs::path list_ = folder_ / "state/proleg/recent.json";
  RecentFiles recent_{list_};
};

TEST_F(RecentFilesTest, TheNewestComesFirstAndNothingTwice) {
  EXPECT_TRUE(recent_.read().empty());
  const fs::path a = make("a.simulation.xml");
  const fs::path b = make("b.simulation.xml");
  recent_.note(a);
  recent_.note(b);
  recent_.note(folder_.path());
  recent_.note(folder_ / "." / "a.simulation.xml");
  EXPECT_EQ(recent_.read(), (std::vector<fs::path>{a, folder_.path(), b}));
}

TEST_F(RecentFilesTest, OnlyAFewAreKept) {
  for (std::size_t i = 0; i <= RecentFiles::max_entries; ++i) {
    recent_.note(make(std::to_string(i)));
  }
  const std::vector<fs::path> files = recent_.read();
  ASSERT_EQ(files.size(), RecentFiles::max_entries);
  EXPECT_EQ(files.back(), folder_ / "1");
}

TEST_F(RecentFilesTest, WhatDoesNotExistIsNotShownAndComesBack) {
  const fs::path a = make("a.simulation.xml");
  recent_.note(a);
  fs::remove(a);
  EXPECT_TRUE(recent_.read().empty());
  recent_.note(make("b.simulation.xml"));
  make("a.simulation.xml");
  EXPECT_EQ(recent_.read(), (std::vector<fs::path>{folder_ / "b.simulation.xml", a}));
}

TEST_F(RecentFilesTest, ADamagedListIsAnEmptyOne) {
  const fs::path a = make("a.simulation.xml");
  recent_.note(a);
  for (const char* text : {"", "{", "[]", "7", R"({"format":1})", R"({"format":1,"paths":7})", R"({"format":"2"})",
                           R"({"format":1,"paths":[1,null,"relative","http://example.org/x",{}]})", "\xff\xfe"}) {
    std::ofstream(list_) << text;
    EXPECT_TRUE(recent_.read().empty()) << text;
    recent_.note(a);
    EXPECT_EQ(recent_.read(), std::vector<fs::path>{a}) << text;
  }
}

TEST_F(RecentFilesTest, TheListOfALaterVersionStaysAsItIs) {
  const fs::path a = make("a.simulation.xml");
  recent_.note(a);
  const std::string later = R"({"format":2,"paths":["/later"],"more":{}})";
  std::ofstream(list_) << later;
  EXPECT_TRUE(recent_.read().empty());
  const std::string error = message_of<InputError>([&] { recent_.note(a); });
  EXPECT_EQ(error, list_.string() + ": found format 2, expected 1; a later version of Proleg has written it");
  std::ostringstream text;
  text << std::ifstream(list_).rdbuf();
  EXPECT_EQ(text.str(), later);
}

TEST_F(RecentFilesTest, AListThatCannotBeWrittenIsAnError) {
  std::ofstream(folder_ / "state") << "a file in the place of the folder";
  EXPECT_THROW(recent_.note(make("a.simulation.xml")), std::exception);
  EXPECT_TRUE(recent_.read().empty());
}

TEST_F(RecentFilesTest, SomebodyWithoutAHomeHasNoList) {
  const RecentFiles none(std::nullopt);
  none.note(make("a.simulation.xml"));
  EXPECT_TRUE(none.read().empty());
}

TEST_F(RecentFilesTest, ProgramsAtTheSameTimeLoseNothing) {
  std::vector<std::thread> programs;
  for (int i = 0; i < 8; ++i) {
    programs.emplace_back([this, i] { RecentFiles(list_).note(make("file" + std::to_string(i))); });
  }
  for (std::thread& program : programs) {
    program.join();
  }
  EXPECT_EQ(recent_.read().size(), 8U);
}

TEST(RecentListPath, IsInTheFolderForTheStateOfPrograms) {
  const char* home = std::getenv("HOME");
  const char* state = std::getenv("XDG_STATE_HOME");
  const std::string old_home = home == nullptr ? "" : home;
  const std::string old_state = state == nullptr ? "" : state;
  ::setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(recent_list_path(), "/state/proleg/recent.json");
  ::setenv("HOME", "/home/somebody", 1);
  ::setenv("XDG_STATE_HOME", "relative", 1);
  EXPECT_EQ(recent_list_path(), "/home/somebody/.local/state/proleg/recent.json");
  ::unsetenv("XDG_STATE_HOME");
  ::unsetenv("HOME");
  EXPECT_EQ(recent_list_path(), std::nullopt);
  if (home != nullptr) {
    ::setenv("HOME", old_home.c_str(), 1);
  }
  if (state != nullptr) {
    ::setenv("XDG_STATE_HOME", old_state.c_str(), 1);
  }
}

}  // namespace
}  // namespace proleg::tools
