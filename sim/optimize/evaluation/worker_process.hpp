#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

/// What a worker does with a task: run_trial, or what a test puts in its place.
using RunTask = std::function<TrialResult(const Experiment&, const Task&)>;

/// A child of this process that simulates one task after the other. It ends when this object does, or this process,
/// however that ends. Signals that ask a program to end (SIGINT, SIGTERM, SIGHUP) mean the parent, which decides; a
/// terminal and a batch system send them to both.
class WorkerProcess {
 public:
  /// Forks. Call it while the process has one thread: a child has no other, and what they held stays locked in it.
  /// Throws std::system_error if the system refuses.
  WorkerProcess(const Experiment& experiment, const RunTask& run);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  [[nodiscard]] pid_t id() const { return process_; }
  /// Becomes readable when there is a reply, or the process has ended.
  [[nodiscard]] int socket() const { return socket_; }

  /// To a process that has ended it is lost; receive() will tell.
  void send(const Task& task) const;

  /// It threw an exception.
  struct Failed {
    std::string what;
  };
  struct Gone {};
  using Reply = std::variant<Gone, Failed, TrialResult>;
  /// The reply to the task that was sent last; waits for it if it is not there yet.
  [[nodiscard]] Reply receive() const;

  /// Kills it if it still runs, and says how it ended: "was killed by signal 9", "ended with exit status 1".
  std::string end();

 private:
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace proleg::optimize
