#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/optimisation.hpp"

namespace proleg::tools {

struct OptimiseOptions : ExperimentOptions {
  std::string file;
  std::optional<std::string> simulation;
  std::optional<std::string> workers;
  std::optional<std::string> out;
  std::optional<std::string> resume;
  bool verbose = false;
  bool json = false;
};

void add_optimise_options(CommandLine& command_line, OptimiseOptions& options);

/// The experiment as the options want it. Throws InputError.
[[nodiscard]] optimize::Experiment read_experiment(const OptimiseOptions& options);

/// Who simulates: processes of this computer, or of a cluster.
using WorkersMaker =
    std::function<std::unique_ptr<optimize::Workers>(const optimize::Experiment&, const OptimiseOptions& options)>;

/// The whole subcommand but for its workers.
int optimise_command(int argc, char** argv, const WorkersMaker& make_workers);

}  // namespace proleg::tools
