#include "shared/computer/output/output.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg {
namespace {

TEST(Output, AppearsWhenItIsComplete) {
  const TemporaryFolder folder;
  const std::string text(200'000, 'x');
  Output output(folder / "table.tsv");
  output.write(text);
  output.write("end");
  EXPECT_FALSE(std::filesystem::exists(folder / "table.tsv"));
  output.finish();
  EXPECT_EQ(file_contents(folder / "table.tsv"), text + "end");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"table.tsv"}));
}

TEST(Output, LeavesNothingIfItIsNotFinished) {
  const TemporaryFolder folder;
  std::ofstream(folder / "table.tsv") << "earlier";
  { Output(folder / "table.tsv").write(std::string(200'000, 'x')); }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"table.tsv"}));
  EXPECT_EQ(file_contents(folder / "table.tsv"), "earlier");
}

TEST(Output, KeepsThePermissionsOfTheFileThatItReplaces) {
  const TemporaryFolder folder;
  std::ofstream(folder / "table.tsv") << "earlier";
  const auto secret = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  std::filesystem::permissions(folder / "table.tsv", secret);
  write_file(folder / "table.tsv", "later");
  EXPECT_EQ(std::filesystem::status(folder / "table.tsv").permissions(), secret);
}

TEST(Output, LeavesNothingIfTheProcessIsKilled) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Output output(folder / "table.tsv");
    output.write(std::string(200'000, 'x'));
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(folder.names().empty());
}

TEST(Output, TakesTheLongestName) {
  const TemporaryFolder folder;
  const std::string name(255, 'x');
  write_file(folder / name, "text");
  EXPECT_EQ(file_contents(folder / name), "text");
}

TEST(Output, ReportsADeviceThatIsFull) {
  Output output("/dev/full");
  output.write("text");
  const std::string message = message_of<FileError>([&] { output.finish(); });
  EXPECT_EQ(message, "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(Output, ReportsAFolderThatIsNotThere) {
  const TemporaryFolder folder;
  const std::string message = message_of<FileError>([&] { Output(folder / "none" / "table.tsv"); });
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

TEST(Output, ReplacesTheFileThatALinkNames) {
  const TemporaryFolder folder;
  std::ofstream(folder / "table.tsv") << "earlier";
  std::filesystem::create_symlink("table.tsv", folder / "link.tsv");
  Output output(folder / "link.tsv");
  output.write("later");
  output.finish();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.tsv"));
  EXPECT_EQ(file_contents(folder / "table.tsv"), "later");
}

TEST(Output, CreatesTheFileThatALinkNames) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("table.tsv", folder / "link.tsv");
  write_file(folder / "link.tsv", "text");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.tsv"));
  EXPECT_EQ(file_contents(folder / "table.tsv"), "text");
}

TEST(ReadWholeFile, HasEachByte) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int i = 0; i < 200'000; ++i) {
    bytes += static_cast<char>(i * 7 % 256);
  }
  write_file(folder / "bytes", bytes);
  EXPECT_TRUE(read_whole_file(folder / "bytes") == bytes);
  write_file(folder / "empty", "");
  EXPECT_EQ(read_whole_file(folder / "empty"), "");
}

TEST(ReadWholeFile, RefusesWhatTheSystemDoesNotRead) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    return message_of<FileError>([&] { static_cast<void>(read_whole_file(path)); });
  };
  EXPECT_EQ(message(folder / "none"), (folder / "none").string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(message(folder.path()), folder.path().string() + ": cannot be read: Is a directory");
}

}  // namespace
}  // namespace proleg
