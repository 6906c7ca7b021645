#include "tools/proleg/common/detached_program.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

class DetachedProgramTest : public ::testing::Test {
 protected:
  int run(const std::string& shell) {
    DetachedProgram program({"sh", "-c", shell}, folder_.path().string(), log_);
    while (true) {
      if (const std::optional<int> status = program.status()) {
        return *status;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path log_ = folder_ / "program.log";
};

TEST_F(DetachedProgramTest, AddsItsOutputToAFileAndHasAStatus) {
  EXPECT_EQ(run("echo out; echo err >&2; exit 3"), 3);
  EXPECT_EQ(run("pwd; kill -9 $$"), 128 + SIGKILL);
  EXPECT_EQ(file_contents(log_), "out\nerr\n" + std::filesystem::canonical(folder_.path()).string() + "\n");
}

TEST_F(DetachedProgramTest, HasASessionOfItsOwnAndNoInput) {
  EXPECT_EQ(run("cat; ps -o sid= -p $$; echo $$"), 0);
  const std::string text = file_contents(log_);
  EXPECT_EQ(std::stol(text), std::stol(text.substr(text.find('\n'))));
}

TEST_F(DetachedProgramTest, GoesOnWhenThisProgramIsKilled) {
  const std::filesystem::path end = folder_ / "end";
  const pid_t parent = fork();
  if (parent == 0) {
    const DetachedProgram program({"sh", "-c", "echo begun; while ! test -e end; do sleep 0.02; done; echo done"},
                                  folder_.path().string(), log_);
    while (file_contents(log_) != "begun\n") {
      usleep(1000);
    }
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(parent, &status, 0), parent);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(file_contents(log_), "begun\n");
  std::ofstream(end).close();
  while (file_contents(log_) != "begun\ndone\n") {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST_F(DetachedProgramTest, ThatCannotStartIsRefused) {
  const auto start = [&](const std::string& program, const std::filesystem::path& log) {
    const DetachedProgram ignored({program}, folder_.path().string(), log);
  };
  EXPECT_THROW(start("no-such-program", log_), std::runtime_error);
  EXPECT_THROW(start("sh", folder_ / "none/program.log"), std::runtime_error);
}

}  // namespace
}  // namespace proleg::tools
