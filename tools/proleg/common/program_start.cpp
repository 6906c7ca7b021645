#include "tools/proleg/common/program_start.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr int lower_priority = 10;
/// A variable of the environment, which a program hands on to those that it starts.
constexpr std::string_view mark_variable = "PROLEG_STARTED_AS=";

/// This program's environment, with English messages: other programs read them.
std::vector<std::string> english_environment(const std::string& mark) {
  std::vector<std::string> words;
  for (char** word = environ; *word != nullptr; ++word) {
    const std::string_view text(*word);
    if (!text.starts_with("LC_") && !text.starts_with("LANG=") && !text.starts_with("LANGUAGE=") &&
        !text.starts_with("NINJA_STATUS=") && !text.starts_with(mark_variable)) {
      words.emplace_back(text);
    }
  }
  words.emplace_back("LC_ALL=C");
  words.emplace_back("NINJA_STATUS=[%f/%t] ");
  if (!mark.empty()) {
    words.push_back(std::string(mark_variable) + mark);
  }
  return words;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  return pointers;
}

/// How the child differs from its parent.
class Setup {
 public:
  explicit Setup(const ProgramStart& start) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, start.folder.c_str());
    if (start.input >= 0) {
      posix_spawn_file_actions_adddup2(&actions_, start.input, STDIN_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&actions_, start.output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, start.errors, STDERR_FILENO);
    if (start.inherited >= 0) {
      posix_spawn_file_actions_adddup2(&actions_, start.inherited, inherited_number);
    }
    posix_spawn_file_actions_addclosefrom_np(&actions_, start.inherited >= 0 ? inherited_number + 1 : inherited_number);
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    // With a group of its own all that it starts can be ended.
    posix_spawnattr_setpgroup(&attributes_, 0);
    const int way = start.life == ProgramStart::Life::its_own ? POSIX_SPAWN_SETSID : POSIX_SPAWN_SETPGROUP;
    posix_spawnattr_setflags(&attributes_, static_cast<short>(way | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
  }
  ~Setup() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* actions() const { return &actions_; }
  [[nodiscard]] const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

pid_t start_program(const std::vector<std::string>& command, const ProgramStart& start) {
  std::vector<std::string> words = command;
  const std::vector<char*> arguments = pointers_to(words);
  std::vector<std::string> environment = english_environment(start.mark);
  const std::vector<char*> variables = pointers_to(environment);
  const Setup setup(start);
  pid_t process = -1;
  const int error = posix_spawnp(&process, arguments.front(), setup.actions(), setup.attributes(), arguments.data(),
                                 variables.data());
  if (error != 0) {
    const bool is_path = command.front().find('/') != std::string::npos;
    throw std::runtime_error(error == ENOENT ? "found no program " + command.front() + ", expected " +
                                                   (is_path ? "an executable file" : "it in a folder of PATH")
                                             : "cannot start " + command.front() + ": " + std::strerror(error));
  }
  if (start.gives_way) {
    setpriority(PRIO_PROCESS, static_cast<id_t>(process), lower_priority);
  }
  return process;
}

void end_marked(const std::string& mark) {
  const std::string word = '\0' + std::string(mark_variable) + mark + '\0';
  constexpr int most_looks = 10;  // a program may start another one meanwhile
  bool is_any = true;
  for (int look = 0; look < most_looks && is_any; ++look) {
    is_any = false;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
      const std::optional<pid_t> process = parse_whole<pid_t>(entry.path().filename().string());
      std::ifstream file(process ? entry.path() / "environ" : "");
      const std::string environment = '\0' + std::string(std::istreambuf_iterator<char>(file), {});
      if (environment.find(word) != std::string::npos && kill(*process, SIGKILL) == 0) {
        is_any = true;
      }
    }
  }
}

int exit_status_of(int wait_status) {
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
}

}  // namespace proleg::tools
