#include "tools/proleg/ui/page_access.hpp"

#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// Whether this process has a child, running or ended, whose status was not taken.
bool has_child() {
  siginfo_t ended{};
  return waitid(P_ALL, 0, &ended, WEXITED | WNOHANG | WNOWAIT) == 0 || errno != ECHILD;
}

TEST(PageAddress, LeavesNoProcessThatHasEnded) {
  const TemporaryFolder folder;
  const fs::path opened = folder / "opened";
  const fs::path program = folder / "xdg-open";
  std::ofstream(program) << "#!/bin/sh\necho \"$1\" > " << opened << '\n';
  fs::permissions(program, fs::perms::owner_all);
  const std::string path = folder.path().string() + ':' + std::getenv("PATH");
  ::setenv("PATH", path.c_str(), 1);
  ::setenv("DISPLAY", ":0", 1);
  const PageAddress address("http://127.0.0.1:1", 1, "token");
  address.open();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (has_child() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_FALSE(has_child());
  EXPECT_TRUE(fs::exists(opened)) << "the program has run to its end";
}

}  // namespace
}  // namespace proleg::tools
