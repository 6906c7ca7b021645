#pragma once

#include "sim/optimize/experiment/search_space.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// Reads the search space: the <registeredParameters> of `properties`, each with its <genomeConfig> in `genome`
/// (thesis, figures 4.13 and 4.14, listing B.7). Dimensions are in the order of the parameters' numbers, and those of
/// single joints from head to tail.
[[nodiscard]] SearchSpace read_search_space(const sim::XmlElement& properties, const sim::XmlElement& genome,
                                            const sim::Scenario& scenario);

}  // namespace proleg::optimize
