// proleg optimise on this computer. Under mpirun it starts the program beside it with the same name and -mpi, which
// needs Open MPI.

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/search/optimise.hpp"

namespace {

/// Becomes the program for MPI; returns only if it cannot be started.
void run_over_mpi(char** argv) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = self.string() + "-mpi";
  execv(program.c_str(), argv);
  std::cerr << "proleg optimise: cannot start " << program << " (" << std::strerror(errno)
            << "); install libopenmpi-dev and libboost-mpi-dev, and build again\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {  // set by Open MPI's mpirun
    run_over_mpi(argv);
    return proleg::tools::exit_failed;
  }
  using namespace proleg;
  return tools::optimise_command(
      argc, argv, [](const optimize::Experiment& experiment, const tools::OptimiseOptions& options) {
        return std::make_unique<optimize::LocalWorkers>(experiment, tools::parse_workers(options.workers));
      });
}
