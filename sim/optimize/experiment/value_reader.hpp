#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "shared/gait/declaration.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::optimize {

/// Returns the raw values of a joint, in ascending order of the numbers in the file. Throws InputError.
using ValuesOfJoint = std::function<std::vector<std::int32_t>(std::size_t joint)>;

/// Reads the values that a <genomeConfig> allows a parameter: a range with a step (valueSpace 1) or a list (0). The
/// file has one set for all joints, or one for each of `joints`, in its order. The sets are not empty and within the
/// parameter's declared range. `config` must outlive the result.
[[nodiscard]] ValuesOfJoint read_values(const sim::XmlElement& config, const Parameter& parameter, std::size_t joints);

}  // namespace proleg::optimize
