#include "tools/proleg/common/program_run.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "shared/computer/algorithm_library/algorithm_library.hpp"

namespace proleg::tools {
namespace {

/// Actions of a child before it becomes the program.
class SpawnActions {
 public:
  SpawnActions(const std::string& folder, int output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDERR_FILENO);
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// Copies a pipe up to its end to standard error, and returns its text.
std::string pass_through(int pipe) {
  std::string output;
  std::array<char, 4096> bytes{};
  while (true) {
    const ssize_t length = read(pipe, bytes.data(), bytes.size());
    if (length < 0 && errno == EINTR) {
      continue;
    }
    if (length <= 0) {
      return output;
    }
    std::cerr.write(bytes.data(), length).flush();
    output.append(bytes.data(), static_cast<std::size_t>(length));
  }
}

int wait_for_end(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string shell_argument(const std::string& argument) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,@%+";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
    return argument;
  }
  std::string quoted = "'";
  for (const char character : argument) {
    quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return quoted + "'";
}

std::string algorithm_options() {
  std::string options;
  for (const std::string& library : loaded_libraries()) {
    options += " --algorithms " + shell_argument(library);
  }
  return options;
}

bool is_installed(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    if (!folder.empty() && access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) {
      return true;
    }
  }
  return false;
}

std::string installing_command(const std::vector<std::string>& programs) {
  static const std::map<std::string_view, std::string_view> packages{
      {"arm-none-eabi-g++", "gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib"},
      {"clang++", "clang"},
      {"ninja", "ninja-build"}};
  std::string command = "sudo apt install";
  for (const std::string& program : programs) {
    const auto package = packages.find(program);
    command.append(" ").append(package == packages.end() ? program : package->second);
  }
  return command;
}

ProgramResult run_program(const std::vector<std::string>& command, const std::string& folder) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  pid_t process = 0;
  const SpawnActions actions(folder, ends[1]);
  const int error = posix_spawnp(&process, arguments.front(), actions.get(), nullptr, arguments.data(), environ);
  close(ends[1]);
  ProgramResult result;
  if (error == 0) {
    result.output = pass_through(ends[0]);
    result.status = wait_for_end(process);
  }
  close(ends[0]);
  if (error == ENOENT) {
    result.was_found = false;
  } else if (error != 0) {
    throw std::runtime_error("cannot start " + command.front() + ": " + std::strerror(error));
  }
  return result;
}

}  // namespace proleg::tools
