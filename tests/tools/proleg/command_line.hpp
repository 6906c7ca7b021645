#pragma once

// Runs the programs as a user does: arguments in; standard output, standard error and exit status out.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/files.hpp"

extern char** environ;

namespace proleg::test {

namespace fs = std::filesystem;

struct Finished {
  int status;
  std::string out;
  std::string err;  ///< without_progress()
};

inline std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The text without the lines that programs print every ten seconds while they work, as they do on a busy computer.
inline std::string without_progress(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (!line.ends_with(" left") && !line.ends_with(" x real time")) {
      rest += line + '\n';
    }
  }
  return rest;
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "proleg-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

  [[nodiscard]] static std::string scenario(const std::string& name) {
    return source_path("/sim/scenarios/travelling_wave/") + name + ".simulation.xml";
  }

  /// Runs proleg with these arguments and returns its standard output, unless that goes to `out_file`.
  [[nodiscard]] Finished proleg(const std::vector<std::string>& words, const std::string& out_file = "") const {
    std::vector<std::string> command{PROLEG_PROGRAM};
    command.insert(command.end(), words.begin(), words.end());
    return finish(start(command, out_file), out_file);
  }

  /// Starts a program; the first word is its path, or a name that is in a folder of PATH.
  [[nodiscard]] pid_t start(const std::vector<std::string>& command, const std::string& out_file = "") const {
    const fs::path out = out_file.empty() ? folder_ / "stdout" : fs::path(out_file);
    const fs::path err = folder_ / "stderr";
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    std::vector<std::string> storage = command;
    std::vector<char*> arguments;
    for (std::string& word : storage) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    pid_t child = -1;
    const int error = posix_spawnp(&child, storage.front().c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
      ADD_FAILURE() << "cannot start " << command.front();
      return -1;
    }
    return child;
  }

  [[nodiscard]] Finished finish(pid_t child, const std::string& out_file = "") const {
    if (child < 0) {
      return {-1, "", ""};
    }
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            out_file.empty() ? read_file(folder_ / "stdout") : "", without_progress(read_file(folder_ / "stderr"))};
  }

  /// Bad input: exit status 2, one line on standard error that contains the words, nothing on standard output.
  void expect_refused(const std::vector<std::string>& words, const std::vector<std::string>& message) const {
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_TRUE(finished.out.empty()) << finished.out;
    for (const std::string& part : message) {
      EXPECT_NE(finished.err.find(part), std::string::npos) << "'" << part << "' is missing in: " << finished.err;
    }
  }

  [[nodiscard]] std::vector<std::string> left_behind() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != "stdout" && name != "stderr") {
        names.push_back(name);
      }
    }
    return names;
  }

 private:
  fs::path folder_;
};

}  // namespace proleg::test
