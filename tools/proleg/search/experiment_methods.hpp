#pragma once

// The methods that take part in an experiment of the thesis, the experiment that each of them searches, and its
// repetitions.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/report/method_runs.hpp"
#include "sim/optimize/report/thesis_experiment.hpp"
#include "tools/proleg/search/optimisation.hpp"

namespace proleg::tools {

/// A method, and the names of its files.
struct ExperimentMethod {
  std::string name;
  std::string file;
  std::string table;
  std::string runs_figure;
  std::string spread_figure;
  bool shipped = true;  ///< the file is for this method; else another algorithm of pagmo searches the file's space
};

struct ChosenMethod {
  ExperimentMethod method;
  optimize::Experiment experiment;
};

struct MethodChoice {
  ExperimentOptions options;
  std::vector<std::string> names;  ///< methods that the user named; empty: those of the thesis, and CMA-ES
  std::uint32_t repetitions = 0;
  std::filesystem::path scenarios;  ///< folder of the experiment's files
  std::filesystem::path folder;     ///< folder of the results
};

/// Finds an experiment by its name; throws InputError if none has it.
[[nodiscard]] const optimize::ThesisExperiment& find_experiment(const std::string& name);

/// The folder of an experiment's files: the given one, or one below the working directory or a folder above this
/// program. Throws InputError.
[[nodiscard]] std::filesystem::path find_experiment_files(const optimize::ThesisExperiment& thesis,
                                                          const std::optional<std::string>& given);

/// The methods that the user named, and those of which the folder has all repetitions; at least one. Throws InputError,
/// and BadInput if a search would write over its own files.
[[nodiscard]] std::vector<ChosenMethod> choose_methods(const optimize::ThesisExperiment& thesis,
                                                       const MethodChoice& choice);

inline constexpr std::uint32_t max_repetitions = 1000;

struct MethodResult {
  optimize::MethodRuns runs;
  std::vector<std::string> endings;
  std::optional<optimize::Evaluation> best;
  double wall_s = 0.0;
};

/// Runs the repetitions side by side, with shared workers; evaluations in the folder's store are not simulated again.
/// The result has fewer repetitions if the user interrupts. It does not depend on the number of workers. repetitions:
/// at most max_repetitions. Throws BadInput, and std::runtime_error if no evaluation of a repetition has a score.
[[nodiscard]] MethodResult run_repetitions(const std::string& name, const optimize::Experiment& experiment,
                                           std::uint32_t repetitions, std::uint32_t workers,
                                           const std::filesystem::path& folder);

}  // namespace proleg::tools
