#include "sim/optimize/evaluation/worker_process.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <exception>
#include <system_error>

#include "shared/computer/child_process/leave_parent.hpp"
#include "sim/optimize/evaluation/message.hpp"

namespace proleg::optimize {
namespace {

// First byte of a reply.
constexpr std::byte is_result{0};
constexpr std::byte is_failure{1};

/// False if the parent has ended.
bool reply_to(std::span<const Task> tasks, int socket, const Experiment& experiment, const RunTasks& run) {
  try {
    Bytes reply = to_bytes(run(experiment, tasks));
    reply.insert(reply.begin(), is_result);
    return send_message(socket, reply);
  } catch (const std::exception& error) {
    constexpr std::size_t longest = 10'000;  // characters
    const std::string what = std::string(error.what()).substr(0, longest);
    Bytes reply{is_failure};
    for (const char character : what) {
      reply.push_back(static_cast<std::byte>(character));
    }
    return send_message(socket, reply);
  }
}

[[noreturn]] void work(int socket, const Experiment& experiment, const RunTasks& run) {
  for (Bytes message = receive_message(socket); !message.empty(); message = receive_message(socket)) {
    const std::optional<std::vector<Task>> tasks = tasks_from(message);
    if (!tasks || !reply_to(*tasks, socket, experiment, run)) {
      break;
    }
  }
  // Not exit(): the child must not flush or close what the parent has open, buffered or registered.
  _exit(0);
}

}  // namespace

WorkerProcess::WorkerProcess(const Experiment& experiment, const RunTasks& run) {
  const auto [own_end, its_end] = make_message_sockets();
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    leave_parent(std::array{its_end}, parent);
    work(its_end, experiment, run);
  }
  const int error = errno;
  close(its_end);
  socket_ = own_end;
  if (process_ < 0) {
    close(socket_);
    throw std::system_error(error, std::generic_category());
  }
}

WorkerProcess::~WorkerProcess() { end(); }

void WorkerProcess::send(std::span<const Task> tasks) const {
  // receive() returns Gone if the process has ended.
  static_cast<void>(send_message(socket_, to_bytes(tasks)));
}

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

std::chrono::nanoseconds WorkerProcess::processor_time() const {
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(process_, &clock) != 0 || clock_gettime(clock, &time) != 0) {
    return {};
  }
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
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
