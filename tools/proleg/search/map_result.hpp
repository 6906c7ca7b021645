#pragma once

// A map of gaits in what a search prints, for people and as JSON.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {

/// Prints a line of a result: a name in its column, and the text.
void print_line(const std::string& name, const std::string& text);

/// Filled cells and QD score as text.
[[nodiscard]] std::string map_text(const optimize::GaitMap& map);
[[nodiscard]] Json map_object(const optimize::GaitMap& map);

/// The place of a cell, with numbers from 1.
[[nodiscard]] Json place_object(const optimize::GaitMap& map, std::size_t cell);

/// Those of the confirmations that belong to the candidates of some cells, in the order of the cells.
[[nodiscard]] std::vector<optimize::Confirmation> confirmations_of(
    std::span<const optimize::Evaluation> cells, std::span<const optimize::Confirmation> confirmations);

/// How the map agrees with the judging engine on a sample of its cells. best: the best candidate of the search.
void print_agreement(const optimize::Experiment& experiment, std::span<const optimize::Confirmation> sample,
                     const optimize::Evaluation& best);
[[nodiscard]] Json agreement_object(const optimize::Experiment& experiment,
                                    std::span<const optimize::Confirmation> sample, const optimize::Evaluation& best);

}  // namespace proleg::tools
