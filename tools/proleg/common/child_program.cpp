#include "tools/proleg/common/child_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <thread>

namespace proleg::tools {
namespace {

constexpr std::chrono::seconds time_to_end{3};
constexpr int lower_priority = 10;

/// This program's environment, with English messages: other programs read them.
std::vector<std::string> english_environment() {
  std::vector<std::string> words;
  for (char** word = environ; *word != nullptr; ++word) {
    const std::string_view text(*word);
    if (!text.starts_with("LC_") && !text.starts_with("LANG=") && !text.starts_with("LANGUAGE=") &&
        !text.starts_with("NINJA_STATUS=")) {
      words.emplace_back(text);
    }
  }
  words.emplace_back("LC_ALL=C");
  words.emplace_back("NINJA_STATUS=[%f/%t] ");
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
  Setup(const std::string& folder, int output, int errors) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, errors, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    // A group of its own: all that it starts can be ended, and Ctrl-C at the terminal goes to this program alone.
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
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

ChildProgram::Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  end = ends[0];
  other_end = ends[1];
  fcntl(end, F_SETFL, O_NONBLOCK);
}

ChildProgram::Pipe::~Pipe() {
  close(end);
  close_other_end();
}

void ChildProgram::Pipe::close_other_end() {
  if (other_end >= 0) {
    close(other_end);
    other_end = -1;
  }
}

ChildProgram::ChildProgram(const std::vector<std::string>& command, const std::string& folder, Errors errors) {
  std::vector<std::string> words = command;
  const std::vector<char*> arguments = pointers_to(words);
  std::vector<std::string> environment = english_environment();
  const std::vector<char*> variables = pointers_to(environment);
  if (errors == Errors::apart) {
    errors_.emplace();
  }
  const Setup setup(folder, output_.other_end, errors_ ? errors_->other_end : output_.other_end);
  const int error = posix_spawnp(&process_, arguments.front(), setup.actions(), setup.attributes(), arguments.data(),
                                 variables.data());
  if (error != 0) {
    throw std::runtime_error(error == ENOENT
                                 ? "found no program " + command.front() + ", expected it in a folder of PATH"
                                 : "cannot start " + command.front() + ": " + std::strerror(error));
  }
  setpriority(PRIO_PROCESS, static_cast<id_t>(process_), lower_priority);
  output_.close_other_end();
  if (errors_) {
    errors_->close_other_end();
  }
}

ChildProgram::~ChildProgram() {
  constexpr std::chrono::milliseconds period{10};
  if (!status()) {
    end();
    while (!status()) {
      std::this_thread::sleep_for(period);
    }
  }
}

std::string ChildProgram::read_from(int pipe) {
  std::string text;
  std::array<char, 4096> bytes{};
  while (true) {
    const ssize_t length = ::read(pipe, bytes.data(), bytes.size());
    if (length > 0) {
      text.append(bytes.data(), static_cast<std::size_t>(length));
    } else if (length == 0 || errno != EINTR) {
      return text;
    }
  }
}

std::optional<int> ChildProgram::status() {
  if (status_) {
    return status_;
  }
  if (killed_at_ && Clock::now() >= *killed_at_) {
    kill(-process_, SIGKILL);
  }
  siginfo_t info{};
  if (waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == 0) {
    return std::nullopt;
  }
  // Until the program is waited for, no other group can have its number.
  kill(-process_, SIGKILL);
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return status_;
}

void ChildProgram::end() {
  if (!status_ && !killed_at_) {
    kill(-process_, SIGTERM);
    killed_at_ = Clock::now() + time_to_end;
  }
}

}  // namespace proleg::tools
