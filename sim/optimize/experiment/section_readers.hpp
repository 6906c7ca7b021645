#pragma once

// Read the sections of an experiment file: the method, and the search space.

#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/search_space.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// Reads the method that a section's tag names, with its settings from `properties`. The registered parameters there
/// are read elsewhere.
[[nodiscard]] MethodSettings read_method(const sim::XmlElement& section, const sim::XmlElement& properties,
                                         std::vector<std::string>& remarks);

/// Reads the search space: the <registeredParameters> of `properties`, each with its <genomeConfig> in `genome`
/// (thesis, figures 4.13 and 4.14, listing B.7). Dimensions are in the order of the parameters' numbers, and those of
/// single joints from head to tail.
[[nodiscard]] SearchSpace read_search_space(const sim::XmlElement& properties, const sim::XmlElement& genome,
                                            const sim::Scenario& scenario);

}  // namespace proleg::optimize
