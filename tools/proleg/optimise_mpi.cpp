// proleg optimise over Open MPI: mpirun starts this program many times; rank 0 searches and all simulate.

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <thread>

#include "sim/optimize/mpi/mpi_workers.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/optimise.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

int search(int argc, char** argv) {
  return optimise_command(argc, argv, [](const optimize::Experiment& experiment, const OptimiseOptions& options) {
    if (options.workers) {
      throw BadInput("found --workers under mpirun, expected mpirun's -n: each of its processes is one worker");
    }
    return std::make_unique<optimize::MpiWorkers>(experiment, build_id);
  });
}

/// What ranks above 0 do.
int serve(int argc, char** argv, int rank) {
  CLI::App app("", "proleg optimise, rank " + std::to_string(rank));
  OptimiseOptions options;
  add_optimise_options(app, options);
  optimize::Experiment experiment;
  const int read = run_command(argc, argv, app, [&] {
    try {
      experiment = read_experiment(options);
    } catch (const std::exception&) {
      // What is wrong here is most probably wrong on rank 0, too: it speaks first, and its end is the end of all.
      std::this_thread::sleep_for(std::chrono::seconds(2));
      throw;
    }
    return exit_success;
  });
  if (read != exit_success || app.get_help_ptr()->count() > 0) {
    return read;
  }
  return optimize::serve_mpi(experiment, build_id) ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<optimize::MpiPlace> place = optimize::mpi_place();
  if (!place) {
    std::cerr << "proleg optimise: found no process number of Open MPI's mpirun, expected to be started by it\n";
    return exit_bad_input;
  }
  return place->rank == 0 ? search(argc, argv) : serve(argc, argv, place->rank);
}
