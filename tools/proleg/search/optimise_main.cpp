// proleg optimise on this computer, and the commands that are the same program: proleg atlas, proleg adapt, proleg
// learn-selector. Under mpirun it starts the program beside it with the same name and -mpi, which needs Open MPI.

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>

#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/search/optimise.hpp"
#include "tools/proleg/search/robot_trials.hpp"

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
  const std::string_view command = argc > 0 ? argv[0] : "";  // of the dispatcher
  if (command == "adapt") {
    return proleg::tools::adapt_command(argc, argv);
  }
  if (command == "atlas") {
    return proleg::tools::atlas_command(argc, argv);
  }
  if (command == "learn-selector") {
    return proleg::tools::learn_selector_command(argc, argv);
  }
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) {  // set by Open MPI's mpirun
    run_over_mpi(argv);
    return proleg::tools::exit_failed;
  }
  using namespace proleg;
  return tools::optimise_command(
      argc, argv,
      [](const optimize::Experiment& experiment,
         const tools::OptimiseOptions& options) -> std::unique_ptr<optimize::Workers> {
        if (!options.robot.bus) {
          return std::make_unique<optimize::LocalWorkers>(experiment, tools::parse_workers(options.workers));
        }
        const std::filesystem::path folder = tools::search_folder(options, experiment);
        const auto stop = [store = tools::store_path(folder)] {
          return tools::interrupted() || optimize::is_stop_requested(store);
        };
        return std::make_unique<tools::RobotWorker>(
            experiment, tools::RobotTrials(options.robot, experiment.scenario, experiment.objectives, folder, stop));
      });
}
