#pragma once

// Common parts of `proleg optimise` and `proleg experiment`: a store in a folder, workers, a run of a search, and its
// display.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/workers.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace proleg::tools {

/// Options that replace values of the experiment's files: --engine, --trials, --evaluations, --seed.
struct ExperimentOptions {
  std::optional<std::string> engine;
  std::optional<std::string> trials;
  std::optional<std::string> evaluations;
  std::optional<std::string> seed;
};

void add_engine_option(CommandLine& command_line, ExperimentOptions& options);

/// Applies the options to an experiment. Throws InputError, also if the method or the engine rejects the experiment.
void apply_options(const ExperimentOptions& options, optimize::Experiment& experiment);

/// Path of the store in the folder of an experiment.
[[nodiscard]] std::filesystem::path store_path(const std::filesystem::path& folder);
/// Throws InputError unless the folder that an option names has a store, of which the map of gaits is read.
void require_map_store(const std::string& option, const std::filesystem::path& folder);
/// Opens the store in a folder, which is made if it does not exist. Throws BadInput.
[[nodiscard]] std::unique_ptr<optimize::Store> open_store(const std::filesystem::path& folder,
                                                          const optimize::Experiment& experiment,
                                                          optimize::Store::Opening opening);

/// The result of a run of a search.
struct SearchOutcome {
  std::vector<optimize::Evaluation> evaluations;
  optimize::SearchProgress progress;
  std::string ending;   ///< reason of its end; empty if it was interrupted or failed
  std::string failure;  ///< why it could not go on; empty: it could
  double wall_s = 0.0;
  double confirmation_wall_s = 0.0;  ///< wall time of the fresh runs after the search
  double own_cpu_s = 0.0;            ///< processor time of optimiser, store and scheduling
};

/// Why a search has ended: "interrupted" by the user, "failed", or what the method says.
[[nodiscard]] std::string ending_text(const SearchOutcome& outcome);

/// Runs a search until its method ends, its evaluations are used up, or the user interrupts it. Shows progress on the
/// terminal, with a label. The store says that the run has ended, unless confirm_best() has to follow.
[[nodiscard]] SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run,
                                       optimize::Workers& workers, optimize::Store& store, const std::string& label);

/// What sees a search while it runs, and may end it.
struct SearchWatch {
  std::function<void(const optimize::Evaluation&, const optimize::SearchProgress&)> observe;  ///< each evaluation
  std::function<bool()> stop;  ///< called often, also while no evaluation ends; true ends the search
};

/// The same without a display, until its method ends, its evaluations are used up, or the watch stops it.
[[nodiscard]] SearchOutcome run_search(const optimize::Experiment& experiment, std::uint32_t run,
                                       optimize::Workers& workers, optimize::Store& store, const SearchWatch& watch);

/// Tells a store how many evaluations its search makes: a resumed search keeps all that the store has. trials: of each
/// candidate, if not the files said so. Returns a remark for the user; empty: none.
[[nodiscard]] std::string keep_stored_evaluations(optimize::Store& store, optimize::Experiment& experiment,
                                                  std::optional<std::uint32_t> trials);

/// Whether a run has ended. A run that has used up its evaluations goes on if the experiment now has more of them.
[[nodiscard]] bool has_ended(optimize::Store& store, const optimize::Experiment& experiment, std::uint32_t run);

/// Rates the best candidates of a search again, if it has ended and needs_confirmation(), and returns them best first;
/// otherwise returns none. Then the store says that the run has ended. If the user interrupts, the result is empty, and
/// the search counts as interrupted. others: candidates of the search that are rated with them.
[[nodiscard]] std::vector<optimize::Confirmation> confirm_best(const optimize::Experiment& experiment,
                                                               optimize::Workers& workers, optimize::Store& store,
                                                               SearchOutcome& outcome,
                                                               std::span<const optimize::Evaluation> others = {});

/// Share of optimiser, store and scheduling in all processor time.
[[nodiscard]] double overhead(const SearchOutcome& outcome);

/// The values of a candidate by the names of their dimensions.
[[nodiscard]] Json values_object(const optimize::SearchSpace& space, const optimize::Candidate& candidate);

/// Shows the progress of a search on standard error: evaluations, best and mean score, simulated seconds per second,
/// remaining time. On a terminal it is one line that is drawn repeatedly, with a spark line of the best score.
/// Elsewhere a line is printed every ten seconds.
class SearchDisplay {
 public:
  /// label: name of the search, with the repetition if it has several. unit: unit of the score. budget: most
  /// evaluations; 0: unknown.
  SearchDisplay(std::string label, std::string unit, std::uint64_t budget);

  /// Redraws at most ten times a second, or prints a line every ten seconds. map: of a search that fills one.
  void show(const optimize::SearchProgress& progress, const optimize::GaitMap* map = nullptr);
  /// Prints a line above the display, also if standard error is not a terminal.
  void print(const std::string& line);

 private:
  std::string label_;
  std::string unit_;
  std::uint64_t budget_;
  TerminalLine terminal_line_;
  LogInterval log_interval_;
  std::vector<double> best_so_far_;
};

/// Evaluations, scores, map, speed and remaining time of a search in one line. elapsed_s: time since its start; above
/// 0. map: null for a search without one.
[[nodiscard]] std::string progress_text(const std::string& label, const std::string& unit, std::uint64_t budget,
                                        const optimize::SearchProgress& progress, double elapsed_s,
                                        const optimize::GaitMap* map = nullptr);

/// The values as block characters, at most `width`; empty without values.
[[nodiscard]] std::string spark_line(const std::vector<double>& values, std::size_t width);

}  // namespace proleg::tools
