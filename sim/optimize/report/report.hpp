#pragma once

// The figures, tables and scenario that an optimisation writes for people.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/gait_map.hpp"

namespace proleg::optimize {

/// Draws as SVG the score of each evaluation, the best so far and the mean of the last ones, against evaluations (first
/// objective), and the baseline as a horizontal line. The text has at most 1 MB for any number of evaluations.
[[nodiscard]] std::string draw_learning_curve(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// Draws as SVG the first two objectives against each other, and the Pareto front. With two objectives a line joins the
/// front.
[[nodiscard]] std::string draw_pareto_front(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// Positions, by ascending first score, of the evaluations that no other dominates (is better in one objective and
/// worse in none). Of equal candidates with equal scores only the first counts.
[[nodiscard]] std::vector<std::size_t> pareto_front(const Experiment& experiment,
                                                    std::span<const Evaluation> evaluations);

/// Draws as SVG the map of gaits of an experiment with axes: the score of each filled cell as a colour. Axes 1 and 2
/// are those of a plot; in a grid axes 3 and 4 repeat it in columns and rows. A map with centroids and more than two
/// axes has dots, seen along the others. Below are coverage and QD score (GaitMap) against evaluations.
[[nodiscard]] std::string draw_gait_map(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// Draws as SVG a map of gaits with other scores than those of a search, such as those that are expected after trials.
/// cells: filled cells with their scores. tried: the cell of each trial; the picture has its number, from 1, there.
/// best: position of the best trial in `tried`, which has a ring.
[[nodiscard]] std::string draw_map_with_trials(const Experiment& experiment, std::span<const GaitMap::Elite> cells,
                                               std::span<const std::size_t> tried, std::size_t best,
                                               std::string_view subtitle);

/// Table like evaluations_table(): the candidate of each filled cell of the map of gaits, by cell. The first columns
/// are the number of the cell on each axis, from 1 ("cell:height"), or that of its centroid ("cell:number").
[[nodiscard]] std::string gait_map_table(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// A line for each axis whose bounds do not fit what was measured: at least nine of ten runs are outside of it, or all
/// are in one of its cells. None for fewer than ten runs that have a score.
[[nodiscard]] std::vector<std::string> axis_remarks(const Experiment& experiment,
                                                    std::span<const Evaluation> evaluations);

/// Table with tabs and a header line: each evaluation with its values, scores and measures. Numbers are the shortest
/// that read back as the same; a measure that is not defined is an empty cell. Columns: run, evaluation, each dimension
/// ("amplitude:J5 (deg)"), each objective ("score:distance (m)"), each measure ("distance (m)"), simulated_s, wall_s,
/// given_up, reused, restored (0 or 1), failure.
[[nodiscard]] std::string evaluations_table(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// Table like evaluations_table() with a first column `rank`: the baseline, if it exists, with the rank `baseline`;
/// then the best `count` different candidates by the first objective, best first. Of equal scores, the earlier comes
/// first.
[[nodiscard]] std::string best_table(const Experiment& experiment, std::span<const Evaluation> evaluations,
                                     std::size_t count);

/// Table with tabs and a header line: the candidates that were rated again, best first. Columns: rank, evaluation, each
/// dimension, score (in the search), mean, standard_deviation, worst, and the fresh runs from 1. If the search is
/// judged, the heads of score and mean name their engines.
[[nodiscard]] std::string confirmation_table(const Experiment& experiment, std::span<const Confirmation> confirmations);

/// Writes the own_world() of an evaluation, complete for `proleg simulate`: the top-level file
/// `folder`/name.simulation.xml, its actuation file name.actuation.xml, and copies of the robot and environment files
/// below name.files. Existing files are replaced. Returns the path of the top-level file. Throws FileError if it cannot
/// be written.
std::filesystem::path write_scenario(const Experiment& experiment, const Evaluation& evaluation,
                                     const std::filesystem::path& folder, const std::string& name);
/// The same for a scenario that was read from files, with its start values, engine, seed, duration and step. What files
/// do not have (other overrides, changes and moves) is not written. remark: a comment in the files. files: name of the
/// folder below which the robot and environment files are, which scenarios of one robot and world may share; by default
/// name.files.
std::filesystem::path write_scenario(const sim::Scenario& scenario, const std::string& remark,
                                     const std::filesystem::path& folder, const std::string& name,
                                     const std::optional<std::string>& files = std::nullopt);

}  // namespace proleg::optimize
