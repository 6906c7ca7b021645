#include "shared/computer/output/output.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg {
namespace {

namespace fs = std::filesystem;

class OutputCheck : public testing::Test {
 protected:
  [[nodiscard]] fs::path written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  [[nodiscard]] static PlannedOutput output(const fs::path& path, const std::string& option = "--out") {
    return {option, path, "note", starts_with("note")};
  }
  /// The message of the check for these outputs; empty if they are accepted.
  [[nodiscard]] static std::string refusal(const std::vector<PlannedOutput>& outputs) {
    return message_of<InputError>([&] { check_outputs(outputs); });
  }
  static void expect_part(const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is missing in: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  TemporaryFolder folder_;
};

TEST_F(OutputCheck, AcceptsANewFileAnEmptyOneAndOneOfItsKind) {
  EXPECT_EQ(refusal({output(folder_ / "new")}), "");
  EXPECT_EQ(refusal({output(written("empty", ""))}), "");
  EXPECT_EQ(refusal({output(written("earlier", "note 1"))}), "");
  EXPECT_EQ(refusal({output("/dev/null"), output("/dev/null")}), "");
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"earlier", "empty"})) << "nothing was created";
}

TEST_F(OutputCheck, RefusesAFileOfAnotherKindAndDoesNotChangeIt) {
  const fs::path path = written("letter", "dear");
  expect_part(
      refusal({output(path)}),
      path.string() + ": found a file that is no note, expected no file, or an earlier note to replace (--out)");
  fs::create_symlink("letter", folder_ / "link");
  expect_part(refusal({output(folder_ / "link")}), "a file that is no note");
  EXPECT_EQ(file_contents(path), "dear");
}

TEST_F(OutputCheck, RefusesNamesThatCannotBeWritten) {
  expect_part(refusal({output("")}), "--out: found an empty name");
  expect_part(refusal({output(folder_.path())}), "found a folder");
  expect_part(refusal({output(folder_ / "none" / "x")}), "No such file or directory");
  PlannedOutput database = output("/dev/null");
  database.must_be_file = true;
  expect_part(refusal({database}), "not a file");
}

TEST_F(OutputCheck, RefusesTwoNamesOfOneFile) {
  const fs::path path = written("note", "note");
  fs::create_symlink("note", folder_ / "link");
  fs::create_hard_link(path, folder_ / "hard_link");
  fs::create_symlink("later", folder_ / "dangling");
  fs::create_directory(folder_ / "sub");
  const auto expect_twice = [&](const fs::path& a, const fs::path& b) {
    expect_part(refusal({output(a, "--a"), output(b, "--b")}), "found twice, for --a and --b");
  };
  expect_twice(path, path);
  expect_twice(path, folder_ / "." / "note");
  expect_twice(path, folder_ / "sub" / ".." / "note");
  expect_twice(path, fs::relative(path));
  expect_twice(path, folder_ / "link");
  expect_twice(path, folder_ / "hard_link");
  expect_twice(folder_ / "later", folder_ / "." / "later");
  expect_twice(folder_ / "later", folder_ / "dangling");
  EXPECT_EQ(refusal({output(path, "--a"), output(folder_ / "other", "--b")}), "");
}

TEST_F(OutputCheck, RefusesAFileThatAnotherOutputWritesBesideItself) {
  PlannedOutput database = output(folder_ / "run", "--record");
  database.companions = {"-wal"};
  expect_part(refusal({database, output(folder_ / "run-wal", "--log")}), "found twice");
  EXPECT_EQ(refusal({database, output(folder_ / "run-log", "--log")}), "");
}

}  // namespace
}  // namespace proleg
