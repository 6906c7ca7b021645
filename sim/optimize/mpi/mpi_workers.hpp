#pragma once

// The optimiser on a cluster: `mpirun -n 64 proleg optimise ...` starts the same program 64 times. Rank 0 searches, all
// ranks simulate. Every rank forks a process for its simulations before it initialises MPI. So a simulation can be
// ended at any time, and the rank can always receive messages. (A process that replaces a dead one is forked later. It
// calls nothing of MPI and ends with its rank.)

#include <memory>
#include <optional>
#include <string>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

struct MpiRank {
  int rank = 0;
  int size = 1;
};

/// This process's rank among those that mpirun started; nothing if it was started in another way. The rank comes from
/// Open MPI's environment variables, so MPI need not be initialised.
[[nodiscard]] std::optional<MpiRank> mpi_rank();

/// The processes that mpirun started, as rank 0 sees them; worker k is rank k. The object initialises and ends MPI, so
/// a process may make only one.
class MpiWorkers final : public Workers {
 public:
  /// The process must have one thread. experiment must outlive this object. Throws std::runtime_error if another rank
  /// has another experiment or build; then all ranks end. run and limit have the meaning that they have for
  /// LocalWorkers.
  MpiWorkers(const Experiment& experiment, const std::string& build_id, RunTasks run = run_trials,
             TaskLimit limit = {});
  /// Ends the other ranks, even in the middle of a task. If one does not answer within seconds, calls MPI_Abort, which
  /// ends this process, too.
  ~MpiWorkers() override;
  MpiWorkers(const MpiWorkers&) = delete;
  MpiWorkers& operator=(const MpiWorkers&) = delete;

  [[nodiscard]] std::uint32_t count() const override;
  [[nodiscard]] std::uint32_t idle() const override;
  void start(std::span<const TicketedTask> batch) override;
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The work of ranks above 0: simulates the tasks of rank 0 until it sends stop. Ignores the signals that ask a program
/// to end: rank 0 handles them. Returns whether all ranks had the same experiment and build; if not, rank 0 reports it.
/// The arguments are those of MpiWorkers.
[[nodiscard]] bool serve_mpi(const Experiment& experiment, const std::string& build_id, RunTasks run = run_trials,
                             TaskLimit limit = {});

}  // namespace proleg::optimize
