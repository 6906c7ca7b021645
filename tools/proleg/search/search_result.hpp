#pragma once

// The result of a search, for people and as JSON.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/space_remarks.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/search/optimisation.hpp"
#include "tools/proleg/search/trial_score.hpp"

namespace proleg::tools {

struct SearchResult {
  optimize::Evaluation best;  ///< the best in fresh runs, if these were made; otherwise the best of the search
  /// Measures and scores of the best scenario, which has no variations of trials and the judging engine: `proleg
  /// simulate` repeats them.
  sim::MeasureValues own_measures;
  std::vector<double> own_scores;
  std::optional<optimize::Evaluation> baseline;
  std::vector<optimize::MovedValue> moved;  ///< values of the scenario that the baseline does not have
  std::vector<optimize::Confirmation> confirmations;
  /// Whether a candidate was better than the baseline; nothing if the baseline has no score.
  std::optional<bool> better_than_baseline;
  std::vector<optimize::ValueAtBound> at_bounds;  ///< values at bounds of the best, if it is better than the baseline

  /// The fresh runs of an evaluation; null if it has none.
  [[nodiscard]] const optimize::Confirmation* confirmation_of(const optimize::Evaluation& evaluation) const;
};

/// The result of a search with at least one score. confirmations: best first; may be empty. The best scenario is
/// simulated if no trial has simulated it.
[[nodiscard]] SearchResult result_of(const optimize::Experiment& experiment, const SearchOutcome& outcome,
                                     std::vector<optimize::Confirmation> confirmations);

/// The files that a search writes into its folder, beside its store.
inline constexpr std::array<std::string_view, 14> search_result_files{
    trials_folder,        "evaluations.tsv",  "best.tsv",
    "learning_curve.svg", "confirmation.tsv", "pareto.tsv",
    "pareto.svg",         "map.tsv",          "map.svg",
    "judged.tsv",         "result.json",      "best.simulation.xml",
    "best.actuation.xml", "best.files"};

/// Throws BadInput if these files in the folder, or a store there, would replace a file of the experiment.
void refuse_overwriting(const optimize::Experiment& experiment, const std::filesystem::path& folder,
                        std::span<const std::string_view> files = search_result_files);

/// Writes tables, figures and the best scenario for people. result: null if no evaluation has a score; then no scenario
/// is written.
std::vector<std::filesystem::path> write_results(const optimize::Experiment& experiment, const SearchOutcome& outcome,
                                                 const SearchResult* result, const std::filesystem::path& folder);

void print_result(const optimize::Experiment& experiment, const SearchOutcome& outcome, const SearchResult& result);

/// Adds the result to a JSON object.
void add_result(const optimize::Experiment& experiment, const SearchOutcome& outcome, const SearchResult& result,
                Json& object);

}  // namespace proleg::tools
