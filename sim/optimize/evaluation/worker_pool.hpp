#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

/// Workers that several searches share, each search in a process of its own. A search that needs one result after the
/// other fills no batch of an engine that simulates many worlds at once; the pool fills it with the tasks of all.
class WorkerPool {
 public:
  /// Forks the process of the pool, which forks the workers. It ends with this object, and with this process in any
  /// case. searches: number of processes that will use it; all must be forked from this one, after this. experiment:
  /// must outlive this. run, limit: as those of LocalWorkers. The process must have one thread. Throws
  /// std::system_error if the system cannot start a process.
  WorkerPool(const Experiment& experiment, std::uint32_t workers, std::uint32_t searches,
             const RunTasks& run = run_trials, TaskLimit limit = {});
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Tasks that a worker gets at once, at most: what the widest vectors hold, or 1 if the engine has no batches. With
  /// more, some searches would wait longer for theirs, and nothing would be faster.
  [[nodiscard]] static std::size_t tasks_of_worker(const Experiment& experiment);
  /// More searches than this at the same time use the workers no better.
  [[nodiscard]] static std::size_t useful_searches(const Experiment& experiment, std::uint32_t workers);

  /// In the process of a search: what simulates its tasks, as one worker. It may be used once. search: number of the
  /// process, from 0. Its wait() throws std::runtime_error if the pool has ended, because a task cannot be simulated;
  /// the pool then has said why on standard error.
  [[nodiscard]] std::unique_ptr<Workers> workers_of(std::uint32_t search) const;
  /// In this process, when all searches are forked. From then on the pool sees the end of a search that is killed, and
  /// gives its share to the others.
  void leave_to_searches();

 private:
  pid_t process_ = -1;
  std::vector<int> sockets_;  ///< by search; none after leave_to_searches()
  std::size_t first_share_;
};

}  // namespace proleg::optimize
