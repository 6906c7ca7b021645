#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <vector>

#include "host/transport/event_loop.hpp"
#include "host/transport/open_transport.hpp"

namespace proleg::host {
namespace {

constexpr int child_descriptor = 3;
constexpr Microseconds end_timeout = 2'000'000;
constexpr useconds_t end_poll = 5'000;

/// The settings of a child for posix_spawn().
class SpawnSettings {
 public:
  SpawnSettings(int descriptor) {
    posix_spawn_file_actions_init(&actions_);
    // The child inherits the copy, also if it has the same number.
    posix_spawn_file_actions_adddup2(&actions_, descriptor, child_descriptor);
    posix_spawnattr_init(&attributes_);
    // The child has a process group of its own, so that Ctrl-C ends only this program, which ends the child when the
    // robot has stopped.
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes_, 0);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  /// Starts the program. Returns the error of the system, or 0.
  int start(std::vector<std::string> arguments, pid_t& process) {
    std::vector<char*> pointers;
    pointers.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) {
      pointers.push_back(argument.data());
    }
    pointers.push_back(nullptr);
    return posix_spawn(&process, pointers.front(), &actions_, &attributes_, pointers.data(), environ);
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

class ProgramLink final : public Link {
 public:
  ProgramLink(std::string program, std::vector<std::string> arguments)
      : program_(std::move(program)), arguments_(std::move(arguments)) {}
  ~ProgramLink() override {
    if (process_ > 0) {
      kill(process_, SIGTERM);
      static_cast<void>(wait_for_end());
    }
  }
  ProgramLink(const ProgramLink&) = delete;
  ProgramLink& operator=(const ProgramLink&) = delete;

  [[nodiscard]] Opened open() override {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw TransportError(std::string("no socket pair: ") + system_text(errno));
    }
    Descriptor own(ends[0]);
    const Descriptor other(ends[1]);
    static_cast<void>(make_private(own));
    pid_t process = 0;
    std::vector<std::string> words{program_};
    words.insert(words.end(), arguments_.begin(), arguments_.end());
    words.insert(words.end(), {"--fd", "3"});
    const int error = SpawnSettings(other.number()).start(std::move(words), process);
    if (error != 0) {
      throw TransportError(program_ + " cannot be started: " + system_text(error));
    }
    process_ = process;
    return {std::move(own), false};
  }
  [[nodiscard]] std::string end_text(int /*error*/) override {
    // The socket closes a moment before the process ends.
    const std::string text = process_ > 0 ? wait_for_end() : std::string();
    return program_ + " has ended" + text;
  }
  [[nodiscard]] std::string silence_hint() const override { return program_ + " runs but serves no bus"; }
  [[nodiscard]] bool can_reopen() const override { return false; }
  [[nodiscard]] SlcanClient::Settings client_settings() const override {
    // Virtual chips take a while to start.
    SlcanClient::Settings settings;
    settings.start_timeout = 30'000'000;
    settings.frame_timeout = 5'000'000;
    return settings;
  }

 private:
  /// Waits for the end of the program, which is forced after the timeout. Returns the way it ended: " with status 2",
  /// " by signal 9".
  std::string wait_for_end() {
    const Microseconds deadline = steady_now() + end_timeout;
    int status = 0;
    pid_t ended = waitpid(process_, &status, WNOHANG);
    while (ended == 0 || (ended < 0 && errno == EINTR)) {
      if (steady_now() >= deadline) {
        kill(process_, SIGKILL);
        ended = waitpid(process_, &status, 0);
      } else {
        usleep(end_poll);
        ended = waitpid(process_, &status, WNOHANG);
      }
    }
    process_ = 0;
    if (ended < 0) {
      return {};
    }
    return WIFSIGNALED(status) ? " by signal " + std::to_string(WTERMSIG(status))
                               : " with status " + std::to_string(WEXITSTATUS(status));
  }

  const std::string program_;
  const std::vector<std::string> arguments_;
  pid_t process_ = 0;
};

}  // namespace

std::unique_ptr<Link> make_program_link(const std::string& program, std::vector<std::string> arguments) {
  return std::make_unique<ProgramLink>(program, std::move(arguments));
}

}  // namespace proleg::host
