// proleg optimise over Open MPI: mpirun starts this program many times; rank 0 searches and all simulate.

#include <chrono>
#include <iostream>
#include <thread>

#include "sim/optimize/mpi/mpi_workers.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/search/optimise.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

int search(int argc, char** argv) {
  return optimise_command(argc, argv, [](const optimize::Experiment& experiment, const OptimiseOptions& options) {
    if (options.workers) {
      throw BadInput("found --workers under mpirun, expected mpirun's -n: each of its processes is one worker");
    }
    if (options.robot.bus) {
      throw BadInput("found --bus under mpirun, expected no mpirun: a robot makes one trial after the other");
    }
    return std::make_unique<optimize::MpiWorkers>(experiment, build_id);
  });
}

/// Waits until rank 0 has reported an error: an error on this rank is most probably one on rank 0, too. Then mpirun
/// ends all ranks.
void let_rank_0_report() { std::this_thread::sleep_for(std::chrono::seconds(2)); }

/// Does the work of ranks above 0.
int serve(int argc, char** argv, int rank) {
  CommandLine command_line("proleg optimise, rank " + std::to_string(rank), "");
  OptimiseOptions options;
  add_optimise_options(command_line, options);
  optimize::Experiment experiment;
  // Rank 0 has the same arguments and reports errors in them.
  bool understood = false;
  std::cout.setstate(std::ios::failbit);
  std::cerr.setstate(std::ios::failbit);
  command_line.add_algorithms_option();
  const int read = command_line.run(argc, argv, [&] {
    understood = true;
    std::cout.clear();
    std::cerr.clear();
    try {
      experiment = read_experiment(options);
    } catch (const std::exception&) {
      let_rank_0_report();
      throw;
    }
    return exit_success;
  });
  if (!understood) {
    let_rank_0_report();
    return read;
  }
  if (read != exit_success) {
    return read;
  }
  return optimize::serve_mpi(experiment, build_id) ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<optimize::MpiRank> place = optimize::mpi_rank();
  if (!place) {
    std::cerr << "proleg optimise: found no process number of Open MPI, expected to be started by its mpirun\n";
    return exit_bad_input;
  }
  return place->rank == 0 ? search(argc, argv) : serve(argc, argv, place->rank);
}
