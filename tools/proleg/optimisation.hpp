#pragma once

// What `proleg optimise` and `proleg experiment` have in common: a store in a folder, workers, and a run of a search.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tools/proleg/json_output.hpp"

namespace proleg::tools {

/// --workers; one for each processor if it is not given. Throws InputError.
[[nodiscard]] std::uint32_t parse_workers(const std::optional<std::string>& word);

/// What the command line says instead of the experiment's file: --evaluations, --seed.
struct ExperimentOptions {
  std::optional<std::string> evaluations;
  std::optional<std::string> seed;
};

/// Sets an experiment to what the options want. Throws InputError, also if its method cannot deal with the experiment.
void apply_options(const ExperimentOptions& options, optimize::Experiment& experiment);

/// A folder with the store of an experiment.
[[nodiscard]] std::filesystem::path store_path(const std::filesystem::path& folder);
/// Makes the folder if it is not there, and opens the store in it. Throws BadInput if that is not possible: nothing has
/// run yet.
[[nodiscard]] std::unique_ptr<optimize::Store> open_store(const std::filesystem::path& folder,
                                                          const optimize::Experiment& experiment,
                                                          optimize::Store::Opening opening);

/// How a run of a search came out.
struct SearchOutcome {
  std::vector<optimize::Evaluation> evaluations;
  optimize::Progress progress;
  std::string ending;  ///< why it ended; empty if it was interrupted
  double wall_s = 0.0;
  double own_cpu_s = 0.0;  ///< processor time of optimiser, store and scheduling
};

/// Runs a search with progress on the terminal until its method ends, its evaluations are used up, or somebody
/// interrupts. label: what to call it there.
[[nodiscard]] SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run,
                                       optimize::Workers& workers, optimize::Store& store, const std::string& label);

/// Share of all processor time that went into optimiser, store and scheduling.
[[nodiscard]] double overhead(const SearchOutcome& outcome);

/// The values of a candidate by the names of their dimensions.
[[nodiscard]] Json values_object(const optimize::SearchSpace& space, const optimize::Candidate& candidate);

}  // namespace proleg::tools
