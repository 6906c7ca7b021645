#include "tools/proleg/search/watched_child.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace proleg::tools {
namespace {

struct Watched {
  ChildEnd end;
  std::vector<std::string> messages;  ///< that were passed on
};

Watched watch(const std::string& script, double longest_s) {
  ChildProgram child({"sh", "-c", script}, "/", ChildProgram::Errors::apart);
  std::vector<std::string> messages;
  ChildEnd end = wait_for_end(
      child, std::chrono::duration<double>(longest_s), [] { return false; },
      [&](const std::string& line) { messages.push_back(line); });
  return {std::move(end), std::move(messages)};
}

TEST(WatchedChild, PassesOnAllMessagesButTheLast) {
  const Watched watched = watch("echo 1; echo a >&2; echo >&2; printf 'b\\nc' >&2; exit 3", 60.0);
  EXPECT_EQ(watched.end.reason, ChildEnd::Reason::itself);
  EXPECT_EQ(watched.end.status, 3);
  EXPECT_EQ(watched.end.output, "1\n");
  EXPECT_EQ(watched.messages, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(watched.end.last_message, "c");
}

TEST(WatchedChild, ThatFloodsAStreamIsEndedAtItsTime) {
  for (const char* script : {"exec yes >&2", "exec yes", "exec tr '\\0' x < /dev/zero >&2"}) {
    const Watched watched = watch(script, 0.2);
    EXPECT_EQ(watched.end.reason, ChildEnd::Reason::late) << script;
    EXPECT_LE(watched.messages.size(), 1'001U) << script;
    EXPECT_LE(watched.end.last_message.size(), 1'000U) << script;
  }
}

TEST(WatchedChild, ThatIsEndedTakesAlongWhatItHasStartedInAnotherSession) {
  ChildProgram child({"sh", "-c", "setsid sh -c 'echo $$ >&2; echo runs >&2; exec sleep 600' & wait"}, "/",
                     ChildProgram::Errors::apart);
  std::string message;
  const ChildEnd end = wait_for_end(
      child, std::chrono::hours(1), [&] { return !message.empty(); }, [&](const std::string& line) { message = line; });
  EXPECT_EQ(end.reason, ChildEnd::Reason::stopped);
  const int process = std::stoi(message);
  while (std::filesystem::exists("/proc/" + std::to_string(process) + "/exe")) {  // until its parent, init, has seen it
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

TEST(WatchedChild, ThatEndsByItselfLeavesWhatItHasStartedInAnotherSession) {
  const Watched watched =
      watch("(setsid sh -c 'echo $$ >&2; echo runs; exec sleep 600 >/dev/null 2>&1' &) | read line", 60.0);
  EXPECT_EQ(watched.end.reason, ChildEnd::Reason::itself);
  EXPECT_EQ(kill(std::stoi(watched.end.last_message), SIGKILL), 0);
}

TEST(WatchedChild, OfTooManyMessagesTheFirstOnesAndTheLastAreKept) {
  const Watched watched = watch("seq 3000 >&2", 60.0);
  ASSERT_EQ(watched.messages.size(), 1'001U);
  EXPECT_EQ(watched.messages[999], "1000");
  EXPECT_EQ(watched.messages[1'000], "its further messages are not shown");
  EXPECT_EQ(watched.end.last_message, "3000");
}

TEST(WatchedChild, ALongLineIsCut) {
  const Watched watched = watch("head -c 5000 /dev/zero | tr '\\0' x >&2; echo >&2; echo b >&2", 60.0);
  EXPECT_EQ(watched.messages, std::vector<std::string>{std::string(1'000, 'x')});
  EXPECT_EQ(watched.end.last_message, "b");
}

}  // namespace
}  // namespace proleg::tools
