#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// The tags of the method sections: an experiment file has one as its outermost tag.
inline constexpr std::array<std::string_view, 6> method_tags{"geneticAlgorithm",      "greatDeluge", "cmaEs",
                                                             "differentialEvolution", "nsga2",       "pagmo"};

/// Reads the method that a section's tag names, with its settings from `properties`. The registered parameters there
/// are read elsewhere.
[[nodiscard]] MethodSettings read_method(const sim::XmlElement& section, const sim::XmlElement& properties,
                                         std::vector<std::string>& remarks);

}  // namespace proleg::optimize
