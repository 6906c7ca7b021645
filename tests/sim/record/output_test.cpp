#include "sim/record/output.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "sim/record/record_error.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

std::string file_contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

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

TEST(Output, ReportsADeviceThatIsFull) {
  Output output("/dev/full");
  output.write("text");
  const std::string message = message_of<RecordError>([&] { output.finish(); });
  EXPECT_EQ(message, "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(Output, ReportsAFolderThatIsNotThere) {
  const TemporaryFolder folder;
  const std::string message = message_of<RecordError>([&] { Output(folder / "none" / "table.tsv"); });
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

}  // namespace
}  // namespace proleg::sim
