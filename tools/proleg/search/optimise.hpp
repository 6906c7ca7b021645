#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/search/optimisation.hpp"
#include "tools/proleg/search/trial_score.hpp"

namespace proleg::tools {

struct OptimiseOptions : ExperimentOptions {
  std::string program = "proleg optimise";  ///< for messages
  /// Whether this is `proleg atlas`: the experiment must have a map, the reduced engine is the default of a file, and
  /// the judging engine simulates cells of the map (`judge`).
  bool fills_atlas = false;
  std::optional<std::string> file;  ///< required unless a search is resumed
  std::optional<std::string> simulation;
  std::optional<std::string> workers;
  std::optional<std::string> out;
  std::optional<std::string> resume;
  std::optional<std::string> stop;
  std::optional<std::string> judge;  ///< number of cells; nothing: usual_judged_cells
  TrialOptions robot;
  bool estimate = false;
  bool verbose = false;
  bool json = false;
};

void add_optimise_options(CommandLine& command_line, OptimiseOptions& options);

/// Reads the experiment from its file, or without a file from the store that is resumed, and applies the options.
/// Throws InputError or BadInput.
[[nodiscard]] optimize::Experiment read_experiment(const OptimiseOptions& options);

/// Throws InputError unless the experiment's method fills a map of gaits.
void require_map(const optimize::Experiment& experiment);

/// The folder of a search.
[[nodiscard]] std::filesystem::path search_folder(const OptimiseOptions& options,
                                                  const optimize::Experiment& experiment);

/// Makes the workers: processes of this computer or of a cluster, or a robot.
using WorkersMaker =
    std::function<std::unique_ptr<optimize::Workers>(const optimize::Experiment&, const OptimiseOptions& options)>;

inline constexpr std::uint32_t usual_judged_cells = 20;

/// Searches, estimates a search, or stops one, as the options say. Returns the exit status.
int optimise(const OptimiseOptions& options, const WorkersMaker& make_workers);

/// Runs `proleg optimise` with the workers that `make_workers` makes.
int optimise_command(int argc, char** argv, const WorkersMaker& make_workers);

/// Runs `proleg atlas`.
int atlas_command(int argc, char** argv);

/// Runs `proleg adapt`.
int adapt_command(int argc, char** argv);

/// Runs `proleg learn-selector`.
int learn_selector_command(int argc, char** argv);

}  // namespace proleg::tools
