#pragma once

// How the pictures and tables see evaluations.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/record/axis.hpp"

namespace proleg::optimize {

/// Whether the score of an objective comes from measures, and not from a failure or a measure that is not defined.
[[nodiscard]] bool has_own_score(const Experiment& experiment, const Evaluation& evaluation, std::size_t objective);

/// Unit of an objective's score: that of its measure, or nothing for a sum.
[[nodiscard]] std::string_view unit_of(const Objective& objective);

/// "distance (m)".
[[nodiscard]] std::string with_unit(std::string_view name, std::string_view unit);

/// Shortest text that reads back as the same double; nothing if it is not finite.
[[nodiscard]] std::string exact_text(double value);

/// A few digits, for titles: "1.958".
[[nodiscard]] std::string rounded_text(double value);

/// A score within +-10^9, so that sums and coordinates of what is drawn stay sound.
[[nodiscard]] double drawable(double score);

/// An axis over scores. Where few lie far off (the cost of transport of robots that hardly move), it is that of the
/// others, but `always` is on it.
[[nodiscard]] sim::Axis score_axis(std::vector<double> scores, std::span<const double> always, double pixel_low,
                                   double pixel_high);

/// With that number of decimals, zeros included.
[[nodiscard]] std::string fixed_text(double value, int decimals);

/// "great_deluge" of "travelling_wave/great_deluge.optimise.xml".
[[nodiscard]] std::string experiment_title(const Experiment& experiment);

}  // namespace proleg::optimize
