#include "tools/proleg/ui/command_sequence.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

using Commands = std::vector<std::vector<std::string>>;

CommandSequence::End end_of(CommandSequence& programs) {
  while (true) {
    if (const auto end = programs.look()) {
      return *end;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(CommandSequence, RunsOneAfterTheOtherAndKeepsWhatTheyWrite) {
  CommandSequence programs(Commands{{"echo", "a b"}, {"sh", "-c", "echo c; echo d >&2"}}, "/", std::chrono::minutes(5));
  const CommandSequence::End end = end_of(programs);
  EXPECT_EQ(end.status, 0);
  EXPECT_FALSE(end.is_cancelled);
  EXPECT_EQ(programs.output(), "a b\nc\nd\n");
  EXPECT_EQ(programs.errors(), "");
}

TEST(CommandSequence, StopsAtTheFirstThatFails) {
  CommandSequence programs(Commands{{"sh", "-c", "exit 3"}, {"echo", "never"}}, "/", std::chrono::minutes(5));
  EXPECT_EQ(end_of(programs).status, 3);
  EXPECT_EQ(programs.output(), "");
}

TEST(CommandSequence, KeepsErrorsApartIfThatIsAskedFor) {
  CommandSequence programs(Commands{{"sh", "-c", "echo out; echo err >&2"}}, "/", std::chrono::minutes(5),
                           ChildProgram::Errors::apart);
  end_of(programs);
  EXPECT_EQ(programs.output(), "out\n");
  EXPECT_EQ(programs.errors(), "err\n");
}

TEST(CommandSequence, OfManyErrorsTheLastAreKept) {
  CommandSequence programs(Commands{{"sh", "-c", "yes | head -c 1000000 >&2; echo last >&2"}}, "/",
                           std::chrono::minutes(5), ChildProgram::Errors::apart);
  end_of(programs);
  EXPECT_LE(programs.errors().size(), CommandSequence::most_errors);
  EXPECT_TRUE(programs.errors().ends_with("\nlast\n"));
}

TEST(CommandSequence, CanBeCancelledAndStartsNoOther) {
  const TemporaryFolder folder;
  const std::string file = (folder / "second").string();
  CommandSequence programs(
      Commands{{"sh", "-c", "trap 'exit 0' TERM; echo ready; while :; do sleep 0.01; done"}, {"touch", file}}, "/",
      std::chrono::minutes(5));
  while (programs.output().empty()) {
    ASSERT_FALSE(programs.look().has_value());
  }
  programs.cancel();
  EXPECT_TRUE(end_of(programs).is_cancelled);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(CommandSequence, IsEndedWhenItsTimeIsOver) {
  CommandSequence programs(Commands{{"sleep", "1000"}}, "/", std::chrono::seconds(0));
  const CommandSequence::End end = end_of(programs);
  EXPECT_TRUE(end.is_late);
  EXPECT_FALSE(end.is_cancelled);
}

TEST(CommandSequence, AProgramThatIsMissingIsNamed) {
  EXPECT_THROW(CommandSequence(Commands{{"no-such-compiler"}}, "/", std::chrono::minutes(5)), std::runtime_error);
}

}  // namespace
}  // namespace proleg::tools
