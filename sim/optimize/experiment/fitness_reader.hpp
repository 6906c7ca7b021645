#pragma once

#include <vector>

#include "sim/optimize/experiment/fitness.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// Reads the <objective>s of a <fitness>: 1 to 8, each of one measure (`measure`) or a weighted sum (<term>s).
[[nodiscard]] std::vector<Objective> read_objectives(const sim::XmlElement& fitness);

/// Without a <fitness>: the distance, as in the thesis.
[[nodiscard]] std::vector<Objective> default_objectives();

}  // namespace proleg::optimize
