#include "tools/proleg/common/child_program.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

struct Ended {
  int status;
  std::string output;
};

Ended wait_for(ChildProgram& child) {
  std::string output;
  while (true) {
    const std::optional<int> status = child.status();
    output += child.read();
    if (status) {
      return {*status, output};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

Ended run(const std::vector<std::string>& command, const std::string& folder = "/") {
  ChildProgram child(command, folder);
  return wait_for(child);
}

TEST(ChildProgram, GivesTheOutputAndTheStatusOfItsEnd) {
  const Ended ended = run({"sh", "-c", "echo out; echo err >&2; exit 3"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_EQ(ended.output, "out\nerr\n");
  EXPECT_EQ(run({"sh", "-c", "kill -9 $$"}).status, 128 + SIGKILL);
}

TEST(ChildProgram, GivesStandardErrorApartIfThatIsAskedFor) {
  ChildProgram child({"sh", "-c", "echo out; echo err >&2"}, "/", ChildProgram::Errors::apart);
  EXPECT_EQ(wait_for(child).output, "out\n");
  EXPECT_EQ(child.read_errors(), "err\n");
  EXPECT_EQ(child.read_errors(), "");
}

TEST(ChildProgram, PassesArgumentsAsTheyAre) {
  EXPECT_EQ(run({"printf", "%s|", "a b", "$HOME", "; exit 1", "*"}).output, "a b|$HOME|; exit 1|*|");
}

TEST(ChildProgram, RunsInItsFolderWithoutInputAndInEnglish) {
  EXPECT_EQ(run({"pwd"}, "/usr").output, "/usr\n");
  EXPECT_EQ(run({"cat"}).output, "");
  setenv("LC_ALL", "de_DE.UTF-8", 1);
  EXPECT_EQ(run({"sh", "-c", "echo $LC_ALL"}).output, "C\n");
}

TEST(ChildProgram, AProgramThatIsMissingIsNamed) {
  try {
    const ChildProgram child({"no-such-compiler"}, "/");
    ADD_FAILURE() << "started";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "found no program no-such-compiler, expected it in a folder of PATH");
  }
}

TEST(ChildProgram, AMissingFileIsNoProgramOfPath) {
  try {
    const ChildProgram child({"./no-such-compiler"}, "/");
    ADD_FAILURE() << "started";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "found no program ./no-such-compiler, expected an executable file");
  }
}

TEST(ChildProgram, OneThatWritesWithoutAnEndDoesNotKeepItsReader) {
  ChildProgram child({"sh", "-c", "exec yes >&2"}, "/", ChildProgram::Errors::apart);
  while (child.read_errors().empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_LE(child.read_errors().size(), ChildProgram::most_at_once + 4096);
  child.end();
  EXPECT_EQ(wait_for(child).status, 128 + SIGTERM);
}

TEST(ChildProgram, EndsWithAllThatItHasStarted) {
  ChildProgram child({"sh", "-c", "sleep 1000 & echo $!; wait"}, "/");
  std::string output;
  while (output.find('\n') == std::string::npos) {
    output += child.read();
  }
  const auto other = parse_whole<pid_t>(trimmed(output));
  ASSERT_TRUE(other.has_value()) << output;
  child.end();
  EXPECT_EQ(wait_for(child).status, 128 + SIGTERM);
  // Its new parent may not have waited for it yet: a signal still finds it then.
  for (int i = 0; i < 1000 && kill(*other, 0) == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_NE(kill(*other, 0), 0);
}

TEST(ChildProgram, EndsAlsoIfItIgnoresTheRequest) {
  ChildProgram child({"sh", "-c", "trap '' TERM; echo ready; while :; do sleep 1; done"}, "/");
  std::string output;
  while (output != "ready\n") {
    output += child.read();
  }
  child.end();
  EXPECT_EQ(wait_for(child).status, 128 + SIGKILL);
}

TEST(ChildProgram, TakesLinesAndADescriptor) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const auto child = ChildProgram::with_input({"sh", "-c", "read word; echo got $word; echo from 3 >&3"}, "/", ends[1]);
  close(ends[1]);
  EXPECT_TRUE(child->write_line("a b"));
  const Ended ended = wait_for(*child);
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.output, "got a b\n");
  std::array<char, 16> text{};
  EXPECT_EQ(::read(ends[0], text.data(), text.size()), 7);
  EXPECT_EQ(std::string(text.data()), "from 3\n");
  close(ends[0]);
  EXPECT_FALSE(child->write_line("more")) << "it has ended: this program gets no signal";
}

}  // namespace
}  // namespace proleg::tools
