#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// What a worker does with its tasks: run_trials, or another function that gives each task its result.
using RunTasks = std::function<std::vector<TrialResult>(const Experiment&, std::span<const Task>)>;

/// A child of this process that simulates one batch of tasks after the other. It ends with this object, and with this
/// process in any case. It ignores the signals that ask a program to end (SIGINT, SIGTERM, SIGHUP): a terminal and a
/// batch system send them to both, and the parent decides.
class WorkerProcess {
 public:
  /// Forks. The process must have one thread: the child would have no others, and their locks would stay locked. Throws
  /// std::system_error if the system cannot start a process.
  WorkerProcess(const Experiment& experiment, const RunTasks& run);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  [[nodiscard]] pid_t id() const { return process_; }
  /// Becomes readable when there is a reply or the process has ended.
  [[nodiscard]] int socket() const { return socket_; }

  /// If the process has ended, the tasks are lost and receive() returns Gone. Throws std::system_error for more tasks
  /// than a message takes.
  void send(std::span<const Task> tasks) const;

  /// A task threw an exception.
  struct Failed {
    std::string what;
  };
  struct Gone {};
  using Reply = std::variant<Gone, Failed, std::vector<TrialResult>>;
  /// The reply to the tasks that were sent last; waits for it if it is not there yet.
  [[nodiscard]] Reply receive() const;

  /// Processor time that the process has used; 0 if it has ended.
  [[nodiscard]] std::chrono::nanoseconds processor_time() const;

  /// Kills the process if it still runs. Returns how it ended: "was killed by signal 9", "ended with exit status 1".
  std::string end();

 private:
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace proleg::optimize
