#include "shared/computer/child_process/trial.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace proleg {
namespace {

TEST(Trial, GivesTheTextOfTheFunctionAndKeepsNothingElseOfIt) {
  int count = 0;
  const Trial trial = try_in_child([&] {
    ++count;
    return std::string(100'000, 'x');
  });
  EXPECT_TRUE(trial.has_returned);
  EXPECT_EQ(trial.text, std::string(100'000, 'x'));
  EXPECT_EQ(count, 0);
  EXPECT_EQ(try_in_child([] { return std::string(); }).text, "");
}

TEST(Trial, SaysHowTheFunctionEndedTheProgram) {
  const auto end_of = [](const std::function<void()>& function) {
    const Trial trial = try_in_child([&] {
      function();
      return std::string();
    });
    EXPECT_FALSE(trial.has_returned);
    return trial.text;
  };
  EXPECT_EQ(end_of([] { std::raise(SIGBUS); }), "ends the program with SIGBUS");
  EXPECT_EQ(end_of([] { std::raise(SIGKILL); }), "ends the program with SIGKILL");
  EXPECT_EQ(end_of([] { _exit(127); }), "ends the program with exit status 127");
  EXPECT_EQ(end_of([] { _exit(0); }), "ends the program with exit status 0");
}

TEST(Trial, EndsAFunctionThatBlocksAllSignalsAndDoesNotReturn) {
  const Trial trial = try_in_child(
      []() -> std::string {
        sigset_t all;
        sigfillset(&all);
        sigprocmask(SIG_SETMASK, &all, nullptr);
        while (true) {
          pause();
        }
      },
      std::chrono::seconds(1));
  EXPECT_FALSE(trial.has_returned);
  EXPECT_EQ(trial.text, "does not end within 1 s");
}

TEST(Trial, DoesNotWaitForAProcessThatTheFunctionLeavesBehind) {
  const Trial trial = try_in_child(
      [] {
        if (fork() == 0) {
          sleep(60);
          _exit(0);
        }
        return std::string("left");
      },
      std::chrono::seconds(30));
  EXPECT_EQ(trial.text, "left");
}

}  // namespace
}  // namespace proleg
