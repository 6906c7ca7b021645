#include "shared/computer/child_process/trial.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <system_error>

#include "shared/computer/child_process/leave_parent.hpp"

namespace proleg {
namespace {

using Clock = std::chrono::steady_clock;

/// Ends the line that the child sends: without it the function has not returned.
constexpr char has_returned = '\n';

[[noreturn]] void run(const std::function<std::string()>& function, int pipe, pid_t parent) {
  for (int signal = 1; signal < NSIG; ++signal) {
    std::signal(signal, SIG_DFL);
  }
  leave_parent(std::array{pipe}, parent);
  dup2(STDOUT_FILENO, STDERR_FILENO);  // to nowhere: the loader prints lines of its own
  prctl(PR_SET_DUMPABLE, 0);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const std::string text = function() + has_returned;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = write(pipe, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) {
      break;
    }
    sent += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  _exit(0);  // not exit(): the child must not flush or close what the parent has open
}

/// What is sent until the line or the child ends; nothing after the deadline.
std::optional<std::string> read_all(int pipe, Clock::time_point deadline) {
  std::string text;
  std::array<char, 4096> bytes{};
  while (!text.ends_with(has_returned)) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd ready{pipe, POLLIN, 0};
    if (left.count() <= 0) {
      return std::nullopt;
    }
    if (poll(&ready, 1, static_cast<int>(left.count())) <= 0) {
      continue;
    }
    const ssize_t count = read(pipe, bytes.data(), bytes.size());
    if (count == 0 || (count < 0 && errno != EINTR)) {
      return text;
    }
    text.append(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
  return text;
}

std::string end_text(int status) {
  if (!WIFSIGNALED(status)) {
    return "ends the program with exit status " + std::to_string(WEXITSTATUS(status));
  }
  const char* const name = sigabbrev_np(WTERMSIG(status));
  return "ends the program with " +
         (name == nullptr ? "signal " + std::to_string(WTERMSIG(status)) : std::string("SIG") + name);
}

}  // namespace

Trial try_in_child(const std::function<std::string()>& function, std::chrono::seconds limit) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "starting a process");
  }
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    run(function, ends[1], parent);
  }
  const int error = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw std::system_error(error, std::generic_category(), "starting a process");
  }
  std::optional<std::string> text = read_all(ends[0], Clock::now() + limit);
  close(ends[0]);
  if (!text || text->ends_with(has_returned)) {
    kill(child, SIGKILL);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!text) {
    return {false, "does not end within " + std::to_string(limit.count()) + " s"};
  }
  if (!text->ends_with(has_returned)) {
    return {false, end_text(status)};
  }
  text->pop_back();
  return {true, *text};
}

}  // namespace proleg
