// Missing files, folders, pipes and large files.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {
namespace {

std::string message_for(const std::filesystem::path& path) {
  DiskFiles files;
  return message_of<InputError>([&] { static_cast<void>(read_scenario(path, files)); });
}

class DiskFilesTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(DiskFilesTest, AMissingFileIsRefused) {
  const std::filesystem::path path = folder_ / "missing.simulation.xml";
  EXPECT_EQ(message_for(path),
            path.string() + ": found no file that can be read, expected a readable file of at most 16 MiB");
}

TEST_F(DiskFilesTest, AFolderIsRefused) {
  EXPECT_NE(message_for(folder_.path()).find("found a folder"), std::string::npos);
}

TEST_F(DiskFilesTest, APathThatIsTooLongOrEmptyIsRefused) {
  EXPECT_NE(message_for(std::string(100'000, 'x')).find("found no file that can be read"), std::string::npos);
  EXPECT_NE(message_for("").find("found no file that can be read"), std::string::npos);
}

TEST_F(DiskFilesTest, APipeIsRefusedWithoutWaitingForIt) {
  const std::filesystem::path path = folder_ / "pipe.simulation.xml";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(message_for(path).find("found a device, a pipe or a socket"), std::string::npos);
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
  const std::string message = message_for("two\nlines\x1b[31m.xml");
  EXPECT_NE(message.find("two lines"), std::string::npos) << message;
  EXPECT_EQ(message.find_first_of("\n\x1b"), std::string::npos) << message;
}

}  // namespace
}  // namespace proleg::sim
