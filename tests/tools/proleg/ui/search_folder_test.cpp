// What searches leave in folders; searches themselves are in searches_test.py.

#include "tools/proleg/ui/search_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

using std::chrono::seconds;

TEST(SearchSpeed, IsThatOfTheLastMinute) {
  const SearchSpeed::Clock::time_point start{};
  SearchSpeed speed;
  EXPECT_FALSE(speed.time_of(1));
  speed.note(100, start);
  EXPECT_FALSE(speed.time_of(1)) << "one number has no speed";
  speed.note(120, start + seconds(10));
  EXPECT_DOUBLE_EQ(speed.time_of(10).value(), 5.0);
  for (int i = 2; i < 40; ++i) {
    speed.note(static_cast<std::uint64_t>(120 + 100 * (i - 1)), start + seconds(10 * i));
  }
  EXPECT_DOUBLE_EQ(speed.time_of(10).value(), 1.0) << "ten a second since more than a minute";
  speed.note(5, start + seconds(500));
  EXPECT_FALSE(speed.time_of(1)) << "another search has begun";
}

class SearchFolderTest : public ::testing::Test {
 protected:
  std::string failure(const std::string& log) {
    std::ofstream(SearchFolder::log_of(folder_.path())) << log;
    return SearchFolder::failure_of(folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(SearchFolderTest, TheLastLineSaysWhyASearchFailed) {
  EXPECT_EQ(SearchFolder::failure_of(folder_.path()), "") << "no log";
  EXPECT_EQ(failure(""), "");
  EXPECT_EQ(failure("cmaes: 20 of 40\nproleg optimise: a.xml:3: found x, expected y\n\n"),
            "a.xml:3: found x, expected y");
  EXPECT_EQ(failure("proleg optimise: interrupted after 5 evaluations; continue with: ...\n"), "") << "no failure";
  EXPECT_EQ(failure("proleg optimise: ended after 2 evaluations, because evaluation_2 has no score\n"),
            "ended after 2 evaluations, because evaluation_2 has no score");
  EXPECT_EQ(failure("cmaes: 20 of 40\n"), "");
}

TEST_F(SearchFolderTest, WhatIsNoStoreIsListedAsUnreadable) {
  std::filesystem::create_directories(folder_ / "a/b");
  std::filesystem::create_directories(folder_ / ".hidden");
  for (const char* path : {"store.sqlite", "a/b/store.sqlite", ".hidden/store.sqlite"}) {
    std::ofstream(folder_ / path) << "no store";
  }
  std::filesystem::create_directory_symlink("/", folder_ / "link");
  SearchFolder searches(folder_.path());
  const nlohmann::json list = searches.list();
  ASSERT_EQ(list.size(), 1U) << list;
  EXPECT_EQ(list[0]["name"], "a/b");
  EXPECT_EQ(list[0]["state"], "unreadable");
  EXPECT_NE(list[0]["problem"].get<std::string>().find("is not the store of an experiment"), std::string::npos);
  EXPECT_EQ(searches.find("a/b"), std::filesystem::canonical(folder_ / "a/b"));
  for (const char* name : {"", "..", "a", "a/b/..", "link", "/tmp", "none"}) {
    EXPECT_THROW(static_cast<void>(searches.find(name)), InputError) << name;
  }
}

}  // namespace
}  // namespace proleg::tools
