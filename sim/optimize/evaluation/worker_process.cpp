#include "sim/optimize/evaluation/worker_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <system_error>

#include "sim/optimize/evaluation/message.hpp"

namespace proleg::optimize {
namespace {

// First byte of a reply.
constexpr std::byte is_result{0};
constexpr std::byte is_failure{1};

/// Bytes. The largest batch of candidates with the most dimensions takes a quarter of a million; the system's default
/// is less.
constexpr int max_message = 400'000;

/// The next message; empty if the other end is closed. The sockets keep messages separate (SOCK_SEQPACKET), and no
/// message is empty.
Bytes receive_message(int socket) {
  while (true) {
    std::byte none{};
    const ssize_t size = recv(socket, &none, 1, MSG_PEEK | MSG_TRUNC);
    if (size > 0) {
      Bytes message(static_cast<std::size_t>(size));
      const ssize_t received = recv(socket, message.data(), message.size(), 0);
      if (received == size) {
        return message;
      }
    } else if (size == 0 || errno != EINTR) {
      return {};
    }
  }
}

bool send_message(int socket, const Bytes& message) {
  ssize_t sent = -1;
  do {
    sent = ::send(socket, message.data(), message.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(message.size());
}

Bytes reply_to(std::span<const Task> tasks, const Experiment& experiment, const RunTasks& run) {
  try {
    Bytes reply = to_bytes(run(experiment, tasks));
    reply.insert(reply.begin(), is_result);
    return reply;
  } catch (const std::exception& error) {
    const std::string what = error.what();
    Bytes reply{is_failure};
    for (const char character : what) {
      reply.push_back(static_cast<std::byte>(character));
    }
    return reply;
  }
}

/// Separates this process from its parent: it shares no signals, files, database connections or terminal.
void leave_parent(int socket, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(0);  // the parent ended before prctl()
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    std::signal(signal, SIG_IGN);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // Above all the other workers' sockets: while this process held them, those workers would not see the parent's end.
  const auto kept = static_cast<unsigned>(socket);
  close_range(3, kept - 1, 0);
  close_range(kept + 1, ~0U, 0);
  if (const int nothing = open("/dev/null", O_RDWR); nothing >= 0) {
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    close(nothing);
  }
}

[[noreturn]] void work(int socket, const Experiment& experiment, const RunTasks& run) {
  for (Bytes message = receive_message(socket); !message.empty(); message = receive_message(socket)) {
    const std::optional<std::vector<Task>> tasks = tasks_from(message);
    if (!tasks || !send_message(socket, reply_to(*tasks, experiment, run))) {
      break;
    }
  }
  // Not exit(): the child must not flush or close what the parent has open, buffered or registered.
  _exit(0);
}

}  // namespace

WorkerProcess::WorkerProcess(const Experiment& experiment, const RunTasks& run) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category());
  }
  for (const int end : ends) {
    setsockopt(end, SOL_SOCKET, SO_SNDBUF, &max_message, sizeof max_message);
  }
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    leave_parent(ends[1], parent);
    work(ends[1], experiment, run);
  }
  const int error = errno;
  close(ends[1]);
  socket_ = ends[0];
  if (process_ < 0) {
    close(socket_);
    throw std::system_error(error, std::generic_category());
  }
}

WorkerProcess::~WorkerProcess() { end(); }

void WorkerProcess::send(std::span<const Task> tasks) const { send_message(socket_, to_bytes(tasks)); }

WorkerProcess::Reply WorkerProcess::receive() const {
  const Bytes reply = receive_message(socket_);
  if (reply.empty()) {
    return Gone{};
  }
  const std::span<const std::byte> content = std::span(reply).subspan(1);
  if (reply.front() == is_result) {
    if (std::optional<std::vector<TrialResult>> results = results_from(content)) {
      return std::move(*results);
    }
    return Failed{"sent an invalid result"};
  }
  std::string what;
  for (const std::byte byte : content) {
    what.push_back(std::to_integer<char>(byte));
  }
  return Failed{what};
}

std::string WorkerProcess::end() {
  if (process_ < 0) {
    return "ended";
  }
  // A process that has already ended keeps its own status.
  kill(process_, SIGKILL);
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  close(socket_);
  process_ = -1;
  return WIFSIGNALED(status) ? "was killed by signal " + std::to_string(WTERMSIG(status))
                             : "ended with exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace proleg::optimize
