#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "sim/optimize/evaluation/worker_process.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

/// How long a task may take before its worker counts as hung; a batch, as long as its tasks one after the other. Of the
/// time between two calls of wait() a second counts at most: a program that was stopped (Ctrl-Z) and continued keeps
/// its workers.
struct TaskLimit {
  std::chrono::milliseconds fixed{60'000};
  double per_simulated_second = 50.0;  ///< s; a simulation runs about a hundred times faster than this robot crawls
  /// A worker that uses no processor time for so long is named, and after three times as long counts as hung: it is
  /// stopped, or waits for something that does not come. One that computes is named after so long, too, if its task
  /// takes ten times as long as any before: it may be in an endless loop.
  std::chrono::milliseconds resting{20'000};
};

/// Processes of this computer, forked from this one. The engine's iterative solver has one random generator in each
/// process, so results of threads would not repeat (docs/physics.md).
class LocalWorkers final : public Workers {
 public:
  /// count: at least 1. experiment: must outlive this. The process must have one thread here and in wait(), which may
  /// replace a worker. Throws std::runtime_error if the system cannot start any process. run: what a worker does with
  /// its tasks.
  LocalWorkers(const Experiment& experiment, std::uint32_t count, RunTasks run = run_trials, TaskLimit limit = {});
  ~LocalWorkers() override;  ///< ends the processes, also in the middle of a task
  LocalWorkers(const LocalWorkers&) = delete;
  LocalWorkers& operator=(const LocalWorkers&) = delete;

  /// Workers that are left; fewer than `count` if the system could not start more.
  [[nodiscard]] std::uint32_t count() const override;
  [[nodiscard]] std::uint32_t idle() const override;
  void start(std::span<const TicketedTask> batch) override;
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::optimize
