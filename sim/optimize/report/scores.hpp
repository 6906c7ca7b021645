#pragma once

// Scores of evaluations, as text and in figures.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/record/plot_frame.hpp"

namespace proleg::optimize {

/// The map of an experiment with axes. Its candidates are positions in `evaluations`.
[[nodiscard]] GaitMap gait_map(const Experiment& experiment, std::span<const Evaluation> evaluations);

/// Name and unit as text: "distance (m)".
[[nodiscard]] std::string with_unit(std::string_view name, std::string_view unit);

/// A number with a few digits, for titles: "1.958".
[[nodiscard]] std::string rounded_text(double value);
/// The same with a unit, if it has one: "1.958 m".
[[nodiscard]] std::string rounded_text(double value, std::string_view unit);

/// The score that is the whole word; nothing for what is no number, or beyond +-10^100: its square could overflow. (The
/// cost of transport of a robot that hardly moves is large, too, but far below that.)
[[nodiscard]] std::optional<double> parse_score(std::string_view word);

/// The cells of a line of a table with so many columns, as a person's program saves it: empty cells at its end may be
/// missing, because editors remove blanks there, and there may be more, because spreadsheets add them.
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, std::size_t columns);

/// The score, limited to +-10^9, so that sums and coordinates stay finite.
[[nodiscard]] double drawable(double score);

/// An axis for scores. If few scores are far off (the cost of transport of robots that hardly move), the axis covers
/// the others and `always`.
[[nodiscard]] sim::Axis score_axis(std::vector<double> scores, std::span<const double> always, double pixel_low,
                                   double pixel_high);

/// A number with a fixed number of decimals, including zeros.
[[nodiscard]] std::string fixed_text(double value, int decimals);

}  // namespace proleg::optimize
