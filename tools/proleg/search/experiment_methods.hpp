#pragma once

// The methods that take part in an experiment of the thesis, and the experiment that each of them searches.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
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

}  // namespace proleg::tools
