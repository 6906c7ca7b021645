#pragma once

// The optimiser on a cluster: `mpirun -n 64 proleg optimise ...` starts the same program 64 times. Rank 0 searches, all
// ranks simulate. Every rank has a process of its own for its simulations, forked before MPI is initialised, so that a
// simulation can be ended at any time and a rank stays able to hear. (Only one that replaces a process which died is
// forked later. It calls nothing of MPI, and ends with its rank.)

#include <memory>
#include <optional>
#include <string>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

struct MpiPlace {
  int rank = 0;
  int size = 1;
};

/// This process's place among those that mpirun started; nothing if it was started in another way. Known before MPI is
/// initialised: Open MPI says it in the environment.
[[nodiscard]] std::optional<MpiPlace> mpi_place();

/// The processes that mpirun started, seen from rank 0; worker k is rank k. One object in the life of a process:
/// it initialises MPI and ends it.
class MpiWorkers final : public Workers {
 public:
  /// To be made while the process has one thread. experiment: must outlive this. Throws std::runtime_error if another
  /// rank has another experiment or another build; all ranks end then. run, limit: as of LocalWorkers.
  MpiWorkers(const Experiment& experiment, const std::string& build_id, RunTask run = run_trial, TaskLimit limit = {});
  /// Ends the other ranks, also in the middle of a task; those that do not answer within seconds by MPI_Abort, which
  /// ends this process, too.
  ~MpiWorkers() override;
  MpiWorkers(const MpiWorkers&) = delete;
  MpiWorkers& operator=(const MpiWorkers&) = delete;

  [[nodiscard]] std::uint32_t count() const override;
  [[nodiscard]] std::uint32_t idle() const override;
  void start(std::uint64_t ticket, const Task& task) override;
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::vector<std::string> messages() override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// What ranks above 0 do: simulate what rank 0 asks for until it says that it is over. Signals that ask a program to
/// end are rank 0's to hear. Returns whether all ranks had the same experiment and build; if not, rank 0 says so.
/// Arguments as of MpiWorkers.
[[nodiscard]] bool serve_mpi(const Experiment& experiment, const std::string& build_id, RunTask run = run_trial,
                             TaskLimit limit = {});

}  // namespace proleg::optimize
