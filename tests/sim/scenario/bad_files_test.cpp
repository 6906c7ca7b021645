// What lies on a disk besides readable files.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

/// A folder of its own for a test, removed at the end.
class DiskFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("proleg_") + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] static std::string message_for(const std::filesystem::path& path) {
    DiskFiles files;
    try {
      static_cast<void>(read_scenario(path, files));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

TEST_F(DiskFilesTest, AMissingFileIsRefused) {
  const std::filesystem::path path = folder_ / "nobody.simulation.xml";
  EXPECT_EQ(message_for(path), path.string() +
                                   ": found no such file, or not a readable one, expected a readable file of at most "
                                   "16 MiB");
}

TEST_F(DiskFilesTest, AFolderIsRefused) {
  EXPECT_NE(message_for(folder_).find("found no such file, or not a readable one"), std::string::npos);
}

TEST_F(DiskFilesTest, APathLongerThanTheSystemTakesIsRefused) {
  EXPECT_NE(message_for(std::string(100'000, 'x')).find("found no such file"), std::string::npos);
  EXPECT_NE(message_for("").find("found no such file"), std::string::npos);
}

TEST_F(DiskFilesTest, APipeIsRefusedWithoutWaitingForIt) {
  const std::filesystem::path path = folder_ / "pipe.simulation.xml";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(message_for(path).find("found no such file, or not a readable one"), std::string::npos);
}

TEST_F(DiskFilesTest, AnEmptyFileIsMalformed) {
  const std::filesystem::path path = folder_ / "empty.simulation.xml";
  std::ofstream(path).flush();
  EXPECT_EQ(message_for(path).substr(path.string().size(), 23), ":1: found malformed XML");
}

TEST_F(DiskFilesTest, AFileOf16MiBIsReadAndALargerOneIsRefused) {
  const std::filesystem::path path = folder_ / "large.simulation.xml";
  std::ofstream(path).flush();
  std::filesystem::resize_file(path, 16U << 20U);
  DiskFiles files;
  ASSERT_TRUE(files.read(path).has_value());
  EXPECT_EQ(files.read(path)->size(), 16U << 20U);
  std::filesystem::resize_file(path, (16U << 20U) + 1);
  EXPECT_FALSE(files.read(path).has_value());
}

TEST_F(DiskFilesTest, ANameWithALineEndMakesAMessageOfOneLine) {
  EXPECT_EQ(message_for("no\nbody\x1b[31m.xml").find_first_of("\n\x1b"), std::string::npos);
}

}  // namespace
}  // namespace proleg::sim
