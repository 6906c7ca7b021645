#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "shared/gait/declaration.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// Makes the raw values of a joint, in ascending order of the numbers in the file. Throws InputError.
using ValuesOfJoint = std::function<std::vector<std::int32_t>(std::size_t joint)>;

/// Reads which values a <genomeConfig> allows a parameter: a range with a step (valueSpace 1) or a list (0). The file
/// holds the same for all joints, or something else for each of so many, in its order. What comes out is in the
/// parameter's declared range and not empty. `config` must outlive the result.
[[nodiscard]] ValuesOfJoint read_values(const sim::XmlElement& config, const Parameter& parameter, std::size_t joints);

}  // namespace proleg::optimize
